"""Disturbance profiles: what stands between the true state and what an agent sees, and how the plant differs from its model.

A profile is a YAML file: one of the package's (`ideal`, `server`, `harsh`) or a user's. Judging never reads a disturbed value.
"""

import os
import pathlib
from functools import cache
from importlib import resources
from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from airhockey.errors import ConfigurationError, unknown
from airhockey.inputs.plain_yaml import load_yaml

# The upper bounds are far above anything sensible: they keep out infinity, which YAML can write (.inf).
Deviation = Annotated[float, Meta(ge=0.0, le=1e6)]
Factor = Annotated[float, Meta(gt=0.0, le=1e6)]
Factors = tuple[Factor, Factor]
Steps = Annotated[int, Meta(ge=1, le=1_000_000)]


class PuckNoise(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Standard deviations of the observed puck: [m], [m] per episode, [rad], [m/s], [rad/s]."""

    position: Deviation = 0.0
    position_bias: Deviation = 0.0
    yaw: Deviation = 0.0
    velocity: Deviation = 0.0
    yaw_rate: Deviation = 0.0


class JointNoise(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Standard deviations of the observed joints: [rad], [rad] per episode, [rad/s]."""

    position: Deviation = 0.0
    position_bias: Deviation = 0.0
    velocity: Deviation = 0.0


class OpponentNoise(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Standard deviation of the observed opponent's rod tip, in [m]."""

    position: Deviation = 0.0


class TrackLoss(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Losses of the puck's track: chance per step that one begins, its length in [steps] and what it shows."""

    probability: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.0
    length: tuple[Steps, Steps] = (1, 1)
    shows: Literal["hold", "zero_velocity"] = "hold"


class Mismatch(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Per episode: ranges of uniform factors on the plant, and the standard deviation of the rod's length in [m]."""

    mass: Factors = (1.0, 1.0)
    joint_friction: Factors = (1.0, 1.0)
    rod_length: Deviation = 0.0
    rim_damping: Factors = (1.0, 1.0)
    puck_damping: Factors = (1.0, 1.0)


class Disturbances(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A whole profile.

    Attributes:
        profile, version: Its name and version, which records carry.
        torque: Standard deviation of the noise on each motor, as a share of its limit.
        delay: How many steps old an observation is.
    """

    profile: str
    version: int = 1
    puck: PuckNoise = PuckNoise()
    joints: JointNoise = JointNoise()
    opponent: OpponentNoise = OpponentNoise()
    track_loss: TrackLoss = TrackLoss()
    torque: Deviation = 0.0
    delay: Annotated[int, Meta(ge=0, le=100)] = 0
    mismatch: Mismatch = Mismatch()

    def __post_init__(self) -> None:
        for name, (low, high) in {
            "track_loss.length": self.track_loss.length,
            "mismatch.mass": self.mismatch.mass,
            "mismatch.joint_friction": self.mismatch.joint_friction,
            "mismatch.rim_damping": self.mismatch.rim_damping,
            "mismatch.puck_damping": self.mismatch.puck_damping,
        }.items():
            if low > high:
                raise ValueError(f"{name} is [{low}, {high}], but a range goes from the smaller to the larger value")

    @property
    def blurs_observations(self) -> bool:
        """Whether an observation can differ from the true state at all."""
        clear = Disturbances(profile="")
        parts = ("puck", "joints", "opponent", "track_loss", "delay")
        return any(getattr(self, part) != getattr(clear, part) for part in parts)


def available() -> tuple[str, ...]:
    """The names of the profiles in this package."""
    folder = resources.files("airhockey.envs").joinpath("assets/disturbances")
    return tuple(sorted(entry.name.removesuffix(".yaml") for entry in folder.iterdir() if entry.name.endswith(".yaml")))


def load_disturbances(profile: "str | pathlib.Path | Disturbances") -> Disturbances:
    """A profile by its name, or from a YAML file.

    Raises:
        ConfigurationError: No such profile or file, or its content is not valid; the message names the key.
    """
    if isinstance(profile, Disturbances):
        return profile
    if isinstance(profile, str) and profile in available():
        return _load_from_package(profile)
    if not isinstance(profile, (str, os.PathLike)):
        raise unknown("disturbance profile (or path of a YAML file)", profile, available())
    path = pathlib.Path(profile)
    try:
        if path.is_file():
            return _parse(path.read_bytes(), str(path))
        if path.suffix in (".yaml", ".yml"):
            trouble = "that is not a file" if path.exists() else "there is no such file"
            raise ConfigurationError(f"no disturbance profile at {str(path)!r}: {trouble}")
        raise unknown("disturbance profile (or path of a YAML file)", str(profile), available())
    except (OSError, ValueError) as error:
        if isinstance(error, ConfigurationError):
            raise
        raise ConfigurationError(f"cannot read the disturbance profile {str(path)!r}: {error}") from error


@cache
def _load_from_package(name: str) -> Disturbances:
    text = resources.files("airhockey.envs").joinpath(f"assets/disturbances/{name}.yaml").read_text(encoding="utf-8")
    return _parse(text, f"{name}.yaml")


def _parse(text: str | bytes, source: str) -> Disturbances:
    try:
        return msgspec.convert(load_yaml(text, source), Disturbances)
    except msgspec.ValidationError as error:
        raise ConfigurationError(
            f"{source!r} is not a valid disturbance profile: {error}; the package's server.yaml shows every key"
        ) from error

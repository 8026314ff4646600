"""The manifest: what a run is, written when it begins; whoever takes it up again must mean the same run.

run.json  match.json  tournament.json  sweep.json  train.json  reproduction.json
"""

import datetime
import hashlib
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Generic, TypeVar

import msgspec

from airhockey.envs.disturbances import Disturbances, load_disturbances
from airhockey.errors import ConfigurationError

Options = TypeVar("Options")
Kind = TypeVar("Kind", bound="Manifest[Any]")
RUN, MATCH, TOURNAMENT, TRAINING = "run.json", "match.json", "tournament.json", "train.json"
REPRODUCTION, SWEEP = "reproduction.json", "sweep.json"
KINDS = {
    RUN: "run", MATCH: "match", TOURNAMENT: "tournament", TRAINING: "training run", REPRODUCTION: "reproduction", SWEEP: "sweep"
}  # fmt: skip
"""A manifest's file name -> what it is the manifest of."""
SEALED_SINCE = (0, 1)
"""The version of airhockey since which manifests are sealed, as far as it decides."""


class Manifest(msgspec.Struct, Generic[Options], frozen=True, kw_only=True):
    """What a run is.

    Attributes:
        options: What was asked for.
        profile: The disturbances themselves; a file of them may change while the run waits.
        versions: Of the software that results depend on.
        created: Local time, ISO 8601.
        format: Of the run's folder.
        inputs: Path of an agent or a file -> SHA-256 of its content.
        seal: SHA-256 of everything else but the time; "" in manifests that are older than `SEALED_SINCE`.
    """

    options: Options
    profile: Disturbances
    versions: dict[str, str]
    created: str
    format: int = 1
    inputs: dict[str, str] = {}
    seal: str = ""


class TrainingManifest(Manifest[Options], Generic[Options], frozen=True, kw_only=True):
    """`train.json`, in which the options go by the name of settings."""

    options: Options = msgspec.field(name="settings")


def now() -> str:
    """Local time, ISO 8601."""
    return datetime.datetime.now().astimezone().isoformat(timespec="seconds")


def sealed(manifest: Kind) -> Kind:
    """The manifest as it is written: it shows when somebody edits it afterwards."""
    bare = msgspec.structs.replace(manifest, seal="", created="")
    return msgspec.structs.replace(manifest, seal=hashlib.sha256(msgspec.json.encode(bare)).hexdigest())


def what_became_of(manifest: Manifest[Any]) -> str | None:
    """What happened to a manifest since it was written, to be put behind its name; None where it is what was written."""
    if not manifest.seal:
        return "was made before there were seals" if _is_older(manifest) else "has lost its seal"
    return "was edited since it was written" if sealed(manifest).seal != manifest.seal else None


def _is_older(manifest: Manifest[Any]) -> bool:
    """Whether the software that wrote a manifest knew no seals; what names no version is taken for the newest."""
    numbers = re.match(r"(\d{1,9})\.(\d{1,9})", manifest.versions.get("airhockey", ""))
    return numbers is not None and (int(numbers[1]), int(numbers[2])) < SEALED_SINCE


def check_seal(path: Path, name: str, manifest: Manifest[Any]) -> None:
    """What goes on must be what was begun; raises `ConfigurationError` for a manifest that is not what was written."""
    what = what_became_of(manifest)
    if what is not None:
        raise ConfigurationError(
            f"{str(path / name)!r} {what}: one result would come from two runs; put its content back, "
            "or begin a new run with another --out"
        )


def note_on_profile(path: Path, manifest: Manifest[Any]) -> str | None:
    """What to tell about a disturbance file that is another than when the run began; None where it is the same."""
    name = option_of(manifest.options, "disturbances")
    try:
        if load_disturbances(name) == manifest.profile:
            return None
        what = "was edited"
    except ConfigurationError:
        what = "cannot be read any more"
    return (
        f"{name!r} {what} since the run in {str(path)!r} began, which goes on with the disturbances that it began with"
    )


def read_manifest(
    path: Path, name: str, options_type: type[Options], manifest_type: Any = Manifest
) -> Manifest[Options]:
    """The manifest in a run's folder.

    Args:
        path: The folder.
        name: The manifest's file name.
        options_type: What its options are.
        manifest_type: `Manifest`, or a kind of it.

    Raises:
        ConfigurationError: There is none, or it cannot be read.
    """
    try:
        manifest: Manifest[Options] = msgspec.json.decode((path / name).read_bytes(), type=manifest_type[options_type])
    except OSError:
        raise ConfigurationError(f"there is no {KINDS[name]} in {str(path)!r}: it has no {name}") from None
    except (msgspec.MsgspecError, ValueError) as error:
        raise ConfigurationError(f"cannot read {str(path / name)!r}: {error}") from error
    return manifest


def has_option(options: Any, name: str) -> bool:
    """Whether there is such an option."""
    return hasattr(options, name) or hasattr(_inner(options), name)


def option_of(options: Any, name: str) -> Any:
    """An option by its name; those of a game are in the field `game`, those of a sweep in its first run."""
    return getattr(options if hasattr(options, name) else _inner(options), name)


def _inner(options: Any) -> Any:
    return options.game if hasattr(options, "game") else next(iter(getattr(options, "runs", ())), None)


def check_same_run(path: Path, manifest: Manifest[Any], asked: Mapping[str, Any]) -> None:
    """Options that are given again for what goes on must be those that it began with.

    Args:
        path: Of the folder, for the message.
        manifest: What it began with.
        asked: Options that the user repeated, by name.

    Raises:
        ConfigurationError: One of them is another, or names a disturbance file that was edited since.
    """
    for name, value in asked.items():
        began_with = option_of(manifest.options, name)
        same = load_disturbances(value) == manifest.profile if name == "disturbances" else value == began_with
        if not same and value == began_with:
            raise ConfigurationError(
                f"the run in {str(path)!r} began with {name} {value!r} when their content was another; leave the option out "
                "to go on with that content, or begin a new run with another --out"
            )
        if not same:
            raise ConfigurationError(f"the run in {str(path)!r} has {name} {began_with!r}, not {value!r}")


def check_versions(path: Path, began_with: Mapping[str, str], versions: Mapping[str, str]) -> None:
    """What was begun with other software cannot go on with this one; raises `ConfigurationError`."""
    for name, version in versions.items():
        if began_with.get(name) != version:
            raise ConfigurationError(
                f"the run in {str(path)!r} began with {name} {began_with.get(name)}, but this is {version}: "
                "results would differ"
            )

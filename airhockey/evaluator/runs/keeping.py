"""What is kept of a trajectory: all of it, the actions that it follows from, or the computation times alone.

An episode is what its seed and the agent's actions make of it, to the bit. So the actions are enough: the rest is computed again
when it is read, and a checksum tells whether it came out as it was played. Another version of the simulator, or another
processor, may round otherwise; then reading fails, and nothing false is shown.
"""

import functools
import hashlib
from typing import Any, Literal, get_args

import msgspec

from airhockey.envs.disturbances import Disturbances
from airhockey.errors import ConfigurationError
from airhockey.evaluator.runs.records import EpisodeRecord, Trajectory

Keep = Literal["full", "actions", "none"]
FULL, ACTIONS, NONE = get_args(Keep)
KEPT: dict[str, tuple[str, ...]] = {ACTIONS: ("actions", "computation_time"), NONE: ("computation_time",)}
"""Names of the arrays that are written, where not all are."""
CHECKSUM = 16  # bytes


class Recipe(msgspec.Struct, frozen=True, kw_only=True):
    """What episodes are computed again from, besides their actions.

    Attributes:
        seed: The run's.
        edition: The year whose rules apply.
        profile: The disturbances.
        versions: Of the software that played them.
    """

    seed: int
    edition: str
    profile: Disturbances
    versions: dict[str, str] = {}


def checksum(trajectory: Trajectory) -> bytes:
    """Of everything that follows from actions and seed."""
    digest = hashlib.blake2b(digest_size=CHECKSUM)
    for name in sorted(trajectory.keys() - set(KEPT[ACTIONS])):
        digest.update(name.encode())
        digest.update(trajectory[name].tobytes())
    return digest.digest()


def replayed(recipe: Recipe, record: EpisodeRecord, kept: Trajectory, expected: bytes) -> Trajectory:
    """An episode's arrays, computed again from its actions.

    Args:
        recipe: Of its run.
        record: Its own.
        kept: Its `actions` and `computation_time`.
        expected: Its checksum.

    Raises:
        ConfigurationError: It comes out as another.
    """
    from airhockey.evaluator.play.seeding import ENVIRONMENT, seed_of

    if not record.steps:
        return {}
    order = 3 if record.interpolation_order is None else record.interpolation_order
    env, recorder = _table(record.env, order, msgspec.json.encode(recipe))
    recorder.start(env.reset(seed=seed_of(recipe.seed, record.env, record.index, ENVIRONMENT)))
    for action, seconds in zip(kept["actions"], kept["computation_time"], strict=True):
        observation, reward, _, _ = env.step(action)
        recorder.add(action, reward, seconds, observation)
    trajectory: Trajectory = recorder.trajectory()
    if checksum(trajectory) != expected:
        from airhockey import envs

        then, now = (
            ", ".join(f"{name} {version}" for name, version in each.items())
            for each in (recipe.versions, envs.versions())
        )
        raise ConfigurationError(
            f"episode {record.index} of {record.env} was kept as its actions alone, and on this machine they lead to another "
            f"episode; it was played with {then or 'unknown versions'}, and this is {now}"
        )
    return trajectory


@functools.lru_cache(maxsize=2)
def _table(name: str, order: Any, recipe: bytes) -> tuple[Any, Any]:
    """An environment and buffers for its episodes."""
    from airhockey import envs
    from airhockey.evaluator.play.recorder import Recorder

    made_of = msgspec.json.decode(recipe, type=Recipe)
    orders = None if order == "none" else order
    env = envs.make(name, orders, disturbances=made_of.profile, edition=made_of.edition)
    return env, Recorder(env, env.reset(seed=0).size, made_of.profile.blurs_observations)

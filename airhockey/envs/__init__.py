"""The challenge environments: scene, control step, tasks, rules, disturbances, and the official wrapper.

    from airhockey import envs

    env = envs.make("7dof-prepare", disturbances="server")
    observation = env.reset(seed=0)
    observation, reward, absorbing, info = env.step(action)

Heavy modules (MuJoCo, numba, MushroomRL) are imported when a name is first used.
"""

import importlib.metadata
import platform
from typing import TYPE_CHECKING, Any

from airhockey.envs.rendering.mujoco_gl import put_aside_what_does_not_work
from airhockey.lazy import attribute

if TYPE_CHECKING:
    from airhockey.envs.disturbances import Disturbances, load_disturbances
    from airhockey.envs.editions import Edition, edition
    from airhockey.envs.environment import Environment
    from airhockey.envs.mushroom import AirHockeyChallengeWrapper
    from airhockey.envs.vector.environment import VectorEnvironment

put_aside_what_does_not_work()

ENVIRONMENTS = ("3dof-hit", "3dof-defend", "7dof-hit", "7dof-defend", "7dof-prepare", "tournament")
"""The names that `make` accepts."""

__all__ = [
    "ENVIRONMENTS",
    "AirHockeyChallengeWrapper",
    "Disturbances",
    "Edition",
    "Environment",
    "VectorEnvironment",
    "edition",
    "load_disturbances",
    "make",
    "make_vec",
    "versions",
]

_HOMES = {
    "AirHockeyChallengeWrapper": "mushroom",
    "Disturbances": "disturbances",
    "load_disturbances": "disturbances",
    "Edition": "editions",
    "edition": "editions",
    "Environment": "environment",
    "VectorEnvironment": "vector.environment",
}


def make(
    name: str,
    interpolation_order: Any = 3,
    disturbances: "str | Any" = "ideal",
    edition: str = "2023",
    visual: bool = False,
) -> "Environment":
    """Make an environment; see `Environment` for the arguments.

    Raises:
        ConfigurationError: An unknown name, order, profile or edition.
    """
    from airhockey.envs.environment import Environment

    return Environment(name, interpolation_order, disturbances, edition, visual)


def make_vec(
    name: str,
    num_envs: int,
    threads: int = 1,
    seed: Any = None,
    interpolation_order: Any = 3,
    disturbances: "str | Any" = "ideal",
    edition: str = "2023",
) -> "VectorEnvironment":
    """Make many environments, stepped by threads in one compiled call; see `VectorEnvironment` for the arguments.

    Raises:
        ConfigurationError: An unknown name, order, profile or edition; no environments, or no threads.
    """
    from airhockey.envs.vector.environment import VectorEnvironment

    return VectorEnvironment(name, num_envs, interpolation_order, disturbances, edition, threads, seed)


def versions() -> dict[str, str]:
    """Versions that a record must name: results of contacts differ between MuJoCo's."""
    packages = {name: importlib.metadata.version(name) for name in ("airhockey", "mujoco", "numpy", "numba")}
    return {**packages, "python": platform.python_version()}


def __getattr__(name: str) -> Any:
    """Import what the layer offers when it is first asked for (PEP 562)."""
    return attribute(__name__, name, {one: f"{__name__}.{home}" for one, home in _HOMES.items()})

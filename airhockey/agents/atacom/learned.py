"""A learned skill at play: its network decides, ATACOM moves; trained skills come with the package."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.atacom.controller import AtacomController
from airhockey.agents.atacom.network import Network
from airhockey.agents.atacom.skill import REPEAT, SKILLS, LearnedTask
from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.skill import Situation
from airhockey.agents.table import HOME
from airhockey.errors import ConfigurationError, unknown

Array = NDArray[np.float64]

FOLDER = Path(__file__).parent / "trained"
"""The package's networks, `<task>_<robot>.npz`, each with a card of the same name in YAML."""


def trained(task: str, robot: str, source: str | Path | None = None) -> Network:
    """A network for a skill.

    Args:
        task: "defend" or "home".
        robot: "3dof" or "7dof".
        source: A file as `hockey train sac` writes it, instead of the package's.

    Raises:
        ConfigurationError: There is none, or it does not fit the skill.
    """
    path = Path(source).expanduser() if source is not None else FOLDER / f"{task}_{robot}.npz"
    if not path.exists():
        raise unknown("trained skill", path.stem, [file.stem for file in sorted(FOLDER.glob("*.npz"))])
    network, expected = Network.load(path), (len(SKILLS[task].mirror), 2)
    if (network.inputs, network.outputs) != expected:
        raise ConfigurationError(
            f"the network {str(path)!r} maps {network.inputs} numbers to {network.outputs}; "
            f"{task} needs {expected[0]} to {expected[1]}"
        )
    return network


class LearnedSkill:
    """Plays a task: an action every `REPEAT` control steps, and rest once there is nothing left to do.

    Attributes:
        name, phase, finished: See `Skill`.
    """

    def __init__(self, task: LearnedTask, network: Network, controller: AtacomController) -> None:
        """Put together.

        Args:
            task: What the network sees and when it is finished.
            network: Trained for it.
            controller: Its command is moved.
        """
        self.name, self.task, self.network, self.controller = task.name, task, network, controller
        nothing = Situation(PuckEstimate(np.zeros(5), np.eye(5), 0), HOME, np.zeros(2))
        self.network(task.observe(nothing))  # the first call loads and compiles
        self.begin(nothing)

    @property
    def phase(self) -> str:
        """Whether it is at rest."""
        return "rest" if self.finished else "learned"

    def begin(self, now: Situation) -> None:
        """See `Skill.begin`."""
        self.finished = False
        self._age = 0

    def act(self, now: Situation) -> Array:
        """See `Skill.act`."""
        self.finished = self.finished or self.task.finished(now)
        if self.finished:
            return self.controller.step(np.zeros(2))
        if self._age % REPEAT == 0:
            self._action = self.network(self.task.observe(now)).astype(np.float64)
        self._age += 1
        return self.controller.step(self._action)

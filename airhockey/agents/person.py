"""`person`: somebody who plays by pointing. The mallet follows the place pointed at, within the arm's limits."""

import threading
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from airhockey.agents.base import AgentBase, Array
from airhockey.agents.control.joint_controller import JointController
from airhockey.agents.control.kinematics import ArmKinematics, spec_of
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.estimation.watch import TableWatch
from airhockey.agents.table import HALF_LENGTH, HALF_WIDTH, HOME, to_table
from airhockey.agents.thesis.polar import limited_step, stoppable_step
from airhockey.envs.copying import NotCopyable

FASTEST, ACCELERATION = 0.036, 14.0
"""Longest step of the mallet in a control step, in [m], and how fast it can brake, in [m]/[s²]."""


class Seen(NamedTuple):
    """What the person is shown, from the side that is played, in the table frame, in [m].

    Attributes:
        step: Control steps since the serve.
        puck, mallet, opponent: Where they are. Shapes (2,); None without an opponent.
        target: Where the mallet is led. Shape (2,).
    """

    step: int
    puck: Array
    mallet: Array
    opponent: Array | None
    target: Array


class Hand(NotCopyable):
    """What a page and the player share: where the person points, and what there is to see."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._target: Array | None = None
        self._seen: Seen | None = None
        self._number = 0

    def point(self, x: float, y: float) -> None:
        """Point at a place in the table frame, in [m]; beyond the table it is taken at the rim."""
        self._target = np.clip(np.array([x, y]), (-HALF_LENGTH, -HALF_WIDTH), (HALF_LENGTH, HALF_WIDTH))

    def release(self) -> None:
        """Point nowhere: the mallet goes home."""
        self._target = None

    @property
    def target(self) -> Array:
        """Where the person points, or home. Shape (2,)."""
        target = self._target
        return HOME if target is None else target

    def show(self, seen: Seen) -> None:
        """Tell who waits what there is to see."""
        with self._changed:
            self._seen, self._number = seen, self._number + 1
            self._changed.notify_all()

    def wait(self, after: int, timeout: float) -> tuple[int, Seen | None]:
        """The latest to see, with its number, once that is above `after` or the timeout in [s] is over."""
        with self._changed:
            self._changed.wait_for(lambda: self._number > after, timeout)
            return self._number, self._seen


HAND = Hand()
"""Of the one who sits at this process's page."""


class PersonAgent(AgentBase):
    """Leads the mallet to where the person points; where nobody does, it goes home and stays there."""

    def __init__(self, env_info: Mapping[str, Any], agent_id: int = 1, **kwargs: Any) -> None:
        """Build the player.

        Args:
            env_info: Description of the environment.
            agent_id: 1 or 2.
            kwargs: Ignored.
        """
        super().__init__(env_info, agent_id, **kwargs)
        self._dt = float(env_info["dt"])
        self._controller = JointController(ArmKinematics(spec_of(env_info)), Workspace.of(env_info), self._dt)
        self._watch = TableWatch(env_info)
        self.reset()

    def reset(self) -> None:
        """See `AgentBase.reset`."""
        self._watch.reset()
        self._step = 0

    @property
    def target(self) -> Array:
        """Where the mallet is led, in the table frame seen from its own side, in [m]. Shape (2,)."""
        return HAND.target

    def draw_action(self, observation: Array) -> Array:
        """See `AgentBase.draw_action`."""
        controller = self._controller
        if self._step == 0:  # joints are observed once; afterwards the commands are the joints
            controller.reset(self.get_joint_pos(observation))
        puck, tip, opponent = self._watch.see(observation, controller.tip_position())
        target = HAND.target
        longest = min(FASTEST, stoppable_step(tip, target, ACCELERATION, self._dt))
        action = controller.move(limited_step(tip, target, longest))
        HAND.show(Seen(self._step, puck.position, to_table(controller.tip_position()), opponent, target))
        self._step += 1
        return action

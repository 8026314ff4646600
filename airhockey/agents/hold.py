"""`hold`: the player that stands still, for every environment and every interpolation order."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from airhockey.agents.base import AgentBase, Array


class HoldAgent(AgentBase):
    """Repeats the first joint position it observed, with zero velocity.

    It is the cheapest agent there is: the simulator's own cost, and what a game looks like without a player.
    """

    def __init__(
        self,
        env_info: Mapping[str, Any],
        agent_id: int = 1,
        interpolation_order: int | None = 3,
        **kwargs: Any,
    ) -> None:
        """Stand still.

        Args:
            env_info: Description of the environment.
            agent_id: 1 or 2.
            interpolation_order: Order whose action shape is returned: 1, 2, 3, 4, 5, -1 or None.
            kwargs: Ignored.
        """
        super().__init__(env_info, agent_id, **kwargs)
        self.interpolation_order = interpolation_order
        self._action: Array | None = None
        self.phase = "hold"

    def reset(self) -> None:
        """Hold the position of the next observation."""
        self._action = None

    def draw_action(self, observation: Array) -> Array:
        """The first observed joint position, as a fresh array of the order's shape."""
        if self._action is None:
            self._action = standing_still(self.get_joint_pos(observation), self.interpolation_order)
        return self._action.copy()


def standing_still(joint_position: Array, interpolation_order: int | None) -> Array:
    """The action that keeps a robot where it is.

    Args:
        joint_position: In [rad]. Shape (n,).
        interpolation_order: 1, 2, 3, 4, 5, -1 or None.

    Returns:
        Position with zero derivatives. Shape (n,), (2, n), (3, n) or (20, 3, n), as the order asks.
    """
    derivatives = np.zeros((3, joint_position.size))
    derivatives[0] = joint_position
    if interpolation_order is None:
        return np.repeat(derivatives[None], 20, axis=0)
    if interpolation_order in (1, 2):
        return joint_position.copy()
    rows = 3 if interpolation_order == 5 else 2
    return derivatives[:rows]

"""Two agents as one that gives pairs of actions, as the tournament's environment takes them."""

import time
from typing import Any

import numpy as np

from ..framework.agent_base import AgentBase
from .tournament_agent_server import connect


class SimpleTournamentAgentWrapper(AgentBase):
    """Two agents in this process.

    Args:
        env_info: Of the tournament.
        agent_1, agent_2: Each with `episode_start` and `draw_action`; a second one is needed.

    Attributes:
        computation_time: Of the latest `draw_action` of each, in [s].
    """

    def __init__(self, env_info: dict[str, Any], agent_1: Any, agent_2: Any, **kwargs: Any) -> None:
        super().__init__(env_info, **kwargs)
        self.agent_1, self.agent_2 = agent_1, agent_2
        self.computation_time = [0.0, 0.0]

    def reset(self) -> None:
        """Nothing of its own."""

    def episode_start(self) -> None:
        """A serve begins for both."""
        self.agent_1.episode_start()
        self.agent_2.episode_start()

    def draw_action(self, observation: Any) -> tuple[Any, Any]:
        """Both agents' commands, each for its half of the observation."""
        actions = []
        for player, (agent, seen) in enumerate(
            zip((self.agent_1, self.agent_2), np.split(observation, 2), strict=True)
        ):
            for preprocessor in getattr(agent, "preprocessors", ()):
                seen = preprocessor(seen)
            started = time.perf_counter()
            actions.append(agent.draw_action(seen))
            self.computation_time[player] = time.perf_counter() - started
        return actions[0], actions[1]


class RemoteTournamentAgentWrapper(SimpleTournamentAgentWrapper):
    """Two agents behind TCP ports, as `tournament_agent_server` offers them.

    Args:
        env_info: Of the tournament.
        address_1, address_2: (host, port) of each.
        shapes: Of their actions.
    """

    def __init__(
        self,
        env_info: dict[str, Any],
        address_1: tuple[str, int],
        address_2: tuple[str, int],
        shapes: tuple[tuple[int, ...], tuple[int, ...]] = ((2, 7), (2, 7)),
        **kwargs: Any,
    ) -> None:
        super().__init__(env_info, connect(*address_1, shapes[0]), connect(*address_2, shapes[1]), **kwargs)

"""The run loop of the challenge: MushroomRL's, with the time of every `draw_action` in the step's info."""

import time
from typing import Any

import numpy as np
from mushroom_rl.core import Core
from numpy.typing import NDArray


class ChallengeCore(Core):
    """Lets an agent play in an environment.

    Args:
        is_tournament: The agent gives pairs of actions (`utils.tournament_agent_wrapper`), and an action that took more than a
            control step is replaced: its player holds the last position.
        init_state: A base observation from which every episode starts.
    """

    _state: Any
    _episode_steps: int

    def __init__(self, *args: Any, is_tournament: bool = False, init_state: Any = None, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.is_tournament, self.init_state = is_tournament, init_state
        self._held: list[Any] = [None, None]

    def reset(self, initial_states: Any = None) -> None:
        """Begin an episode: the agent's `episode_start`, then the environment's reset."""
        given = self.init_state is not None and initial_states is None
        super().reset([self.init_state] * (self._n_episodes or 1) if given else initial_states)
        self._held = [None, None]

    def _step(self, render: bool, *_: Any) -> tuple[tuple[Any, ...], dict[str, Any]]:
        state, started = self._state, time.perf_counter()
        action = self.agent.draw_action(state)
        seconds: Any = time.perf_counter() - started
        if self.is_tournament:
            seconds = list(getattr(self.agent, "computation_time", (seconds, seconds)))
            action = self._in_time(action, seconds)
        next_state, reward, absorbing, info = self.mdp.step(action)
        self._episode_steps += 1
        if render:
            self.mdp.render()
        last = not (self._episode_steps < self.mdp.info.horizon and not absorbing)
        self._state = self._preprocess(next_state.copy())
        info["computation_time"] = seconds
        return (state, action, reward, self._state, absorbing, last), info

    def _in_time(self, actions: Any, seconds: list[float]) -> tuple[NDArray[np.float64], ...]:
        """The actions, with that of a player who was late replaced by holding the previous position."""
        taken = []
        for player, (action, spent) in enumerate(zip(actions, seconds, strict=True)):
            if spent > self.mdp.info.dt and self._held[player] is not None:
                action = self._held[player]
            taken.append(action)
            held = np.array(action, dtype=np.float64)
            if held.ndim > 1:
                held[1:] = 0.0
            self._held[player] = held
        return tuple(taken)

"""A game of two as a PettingZoo environment: `airhockey/tournament-v0` or `airhockey2025/tournament-v0`, a parallel one.

import airhockey.envs.pettingzoo
import pettingzoo

game = pettingzoo.make("parallel", "airhockey/tournament-v0", disturbances="server")
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.inputs.packages import needs

with needs("this interface", "PettingZoo", "rl"):
    import pettingzoo
    from gymnasium import spaces

from airhockey.envs.actions import ActionFormat
from airhockey.envs.copying import Copyable
from airhockey.envs.environment import Environment, Order
from airhockey.envs.rendering.render import FRAMES_PER_SECOND, MODES, Rendered
from airhockey.envs.tasks.game import points_reward

Array = NDArray[np.float64]
IDS = {"2023": "airhockey/tournament-v0", "2025": "airhockey2025/tournament-v0"}
PLAYERS = ("home", "away")


class TournamentEnv(Copyable, Rendered, pettingzoo.ParallelEnv[str, Array, Array]):
    """A whole game, 45,000 control steps: every point, fault or stuck puck is followed by the next serve.

    Each player sees the table from its own side; see `airhockey.envs.Environment`. The reward is +1 for a point and −1 for
    the opponent's. A player's `info` holds `constraints_value`, its `score` and `faults`, and `serve`: whether the
    observation is the first of a new serve (where an agent's `episode_start` is due). The game is truncated at its end. It can
    be copied, pickled, saved and restored as `airhockey.envs.Environment` can.

    Args:
        interpolation_order: 1, 2, 3, 4, 5, -1 or None, or a pair of them.
        disturbances: A profile's name, the path of a YAML file, or a profile.
        max_cycles: Length of the game in control steps, if not the rules'.
        edition: The year whose rules apply.
        render_mode: "rgb_array", "human" (live: in a window, or on a page where there is no display) or None.
        width, height: Of the pictures, in pixels.

    Attributes:
        environment: The challenge environment behind it.
    """

    # PettingZoo's own way to say so
    metadata = {"name": IDS["2023"], "render_modes": list(MODES), "render_fps": FRAMES_PER_SECOND}  # noqa: RUF012

    def __init__(
        self,
        interpolation_order: Order | tuple[Order, Order] = 3,
        disturbances: Any = "ideal",
        max_cycles: int | None = None,
        edition: str = "2023",
        render_mode: str | None = None,
        width: int = 640,
        height: int = 360,
    ) -> None:
        self.environment = Environment("tournament", interpolation_order, disturbances, edition)
        self.possible_agents = list(PLAYERS)
        self.agents: list[str] = []
        self._can_be_looked_at("tournament", edition, render_mode, width, height)
        self._step, self._score = 0, [0, 0]
        self._steps = self.environment.horizon if max_cycles is None else max_cycles
        seen = self.environment.env_info["rl_info"].observation_space.shape
        robot = self.environment.simulation.robot
        self.state_space = spaces.Box(-np.inf, np.inf, self.environment.base_observation.shape, np.float64)
        self._boxes = {player: spaces.Box(-np.inf, np.inf, seen, np.float64) for player in PLAYERS}
        self._actions = {
            player: _box(form, robot) for player, form in zip(PLAYERS, self.environment.formats, strict=True)
        }

    def observation_space(self, agent: str) -> spaces.Box:
        """Unbounded: joints overshoot, and noise reaches beyond any limit."""
        return self._boxes[agent]

    def action_space(self, agent: str) -> spaces.Box:
        """Of the player's interpolation order."""
        return self._actions[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Array], dict[str, dict[str, Any]]]:
        """Begin a game; `options` are not looked at."""
        if seed is None:
            self.environment.new_game()
        observation = self.environment.reset(None if seed is None else int(seed) % 2**32)
        self.agents, self._step, self._score = list(PLAYERS), 0, self.environment.score
        self._show()
        return self._split(observation), {player: {"serve": True} for player in PLAYERS}

    def step(
        self, actions: dict[str, Array]
    ) -> tuple[dict[str, Array], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]:
        """Advance by one control step of 0.02 s; a serve that ended is followed by the next one at once."""
        env = self.environment
        observation, _, over, info = env.step((actions["home"], actions["away"]))
        constraints = [
            {name: values.copy() for name, values in by_name.items()} for by_name in info["constraints_value"]
        ]
        before, self._score, self._step = self._score, env.score, self._step + 1
        if over:
            observation = env.reset()
        ended = self._step >= self._steps
        infos = {
            player: {
                "constraints_value": constraints[k], "score": env.score[k], "faults": env.faults[k], "serve": over
            }
            for k, player in enumerate(PLAYERS)
        }  # fmt: skip
        rewards = dict(zip(PLAYERS, points_reward(before, self._score), strict=True))
        if ended:
            self.agents = []
        self._show()
        return self._split(observation), rewards, dict.fromkeys(PLAYERS, False), dict.fromkeys(PLAYERS, ended), infos

    def state(self) -> Array:
        """What is true of both players, without noise: the base observation, in world coordinates."""
        return self.environment.base_observation

    def get_state(self) -> tuple[Any, ...]:
        """The present moment; see `airhockey.envs.Environment.get_state`."""
        return self.environment.get_state(), tuple(self.agents), self._step, tuple(self._score)

    def set_state(self, state: tuple[Any, ...]) -> None:
        """Go to a moment that this environment, or one made with the same arguments, saved."""
        environment, agents, self._step, score = state
        self.environment.set_state(environment)
        self.agents, self._score = list(agents), list(score)

    def _split(self, observation: Array) -> dict[str, Array]:
        half = observation.size // 2
        return {"home": observation[:half], "away": observation[half:]}


def _box(form: ActionFormat, robot: Any) -> spaces.Box:
    low, high = form.limits(robot)
    return spaces.Box(low, high, dtype=np.float64)


def register() -> None:
    """Register the games with PettingZoo, once."""
    for edition, id_ in IDS.items():
        if id_ not in pettingzoo.parallel_registry:
            pettingzoo.register("parallel", id_, f"{__name__}:TournamentEnv", kwargs={"edition": edition})


register()

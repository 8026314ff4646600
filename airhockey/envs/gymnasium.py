"""The tasks as Gymnasium environments: `airhockey/3dof-hit-v0`, `airhockey/7dof-defend-v0`, `airhockey2025/hit-v0` and so on.

    import airhockey.envs.gymnasium
    import gymnasium

    env = gymnasium.make("airhockey/7dof-defend-v0", disturbances="server")
    vec = gymnasium.make_vec("airhockey/7dof-defend-v0", num_envs=64, threads=2)

Importing this module registers the ids (Gymnasium has no plug-ins any more); `gymnasium.make` imports it by itself where the
id says so: "airhockey.envs.gymnasium:airhockey/7dof-defend-v0".
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.inputs.packages import needs

with needs("this interface", "Gymnasium", "rl"):
    import gymnasium
    from gymnasium import spaces

from airhockey.envs.copying import Copyable
from airhockey.envs.editions import edition as rules
from airhockey.envs.environment import Environment, Order
from airhockey.envs.rendering.render import FRAMES_PER_SECOND, MODES, Rendered
from airhockey.envs.tasks.reward import RewardedState

Array = NDArray[np.float64]
Reward = Callable[[Any, Array, Any, Array, bool], float]

NAMESPACES = {"2023": "airhockey", "2025": "airhockey2025"}
"""First part of an id, by edition."""
TASKS = {
    "2023": ("3dof-hit", "3dof-defend", "7dof-hit", "7dof-defend", "7dof-prepare"),
    "2025": ("hit", "hit_single", "defend", "prepare"),
}


class AirHockeyEnv(Copyable, Rendered, gymnasium.Env[Array, Array]):
    """One of the challenge's tasks; `airhockey.envs.Environment` says what an observation and an action are.

    An observation's space is unbounded: joints overshoot and noise reaches beyond any limit. `info` holds `success`
    (and `is_success`, the same under the name that libraries look for), `constraints_value` and `jerk`. An episode is
    truncated at the task's horizon. It can be copied, pickled, saved and restored as `airhockey.envs.Environment` can.

    Args:
        name: "3dof-hit", "3dof-defend", "7dof-hit", "7dof-defend" or "7dof-prepare"; in the edition of 2025 "hit",
            "hit_single", "defend" or "prepare".
        interpolation_order: 1, 2, 3, 4, 5, -1 or None.
        disturbances: A profile's name, the path of a YAML file, or a profile.
        reward: Called with (environment, state, action, next state, absorbing) after each step; the states are base
            observations in world coordinates, as for the official wrapper's `custom_reward_function`. Without one the
            reward is `success` at the end of an episode and 0 before.
        edition: The year whose rules apply.
        render_mode: "rgb_array", "human" (live: in a window, or on a page where there is no display) or None.
        width, height: Of the pictures, in pixels.

    Attributes:
        environment: The challenge environment behind it.
    """

    metadata = {"render_modes": list(MODES), "render_fps": FRAMES_PER_SECOND}  # noqa: RUF012 - Gymnasium's own way to say so

    def __init__(
        self,
        name: str,
        interpolation_order: Order = 3,
        disturbances: Any = "ideal",
        reward: Reward | None = None,
        edition: str = "2023",
        render_mode: str | None = None,
        width: int = 640,
        height: int = 360,
    ) -> None:
        self.environment = Environment(name, interpolation_order, disturbances, edition)
        self._can_be_looked_at(name, edition, render_mode, width, height)
        seen = self.environment.env_info["rl_info"].observation_space.shape
        self.observation_space = spaces.Box(-np.inf, np.inf, seen, np.float64)
        low, high = self.environment.formats[0].limits(self.environment.simulation.robot)
        self.action_space = spaces.Box(low, high, dtype=np.float64)
        self._reward = reward

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """Begin an episode.

        Args:
            seed: Decides the start and every disturbance; an integer s gives the official start of `np.random.seed(s)`.
            options: "state": a base observation to start from; "seed": a `numpy.random.SeedSequence` instead of `seed`.
        """
        super().reset(seed=seed)
        given = options or {}
        start = given.get("seed", seed)
        if start is not None and not isinstance(start, np.random.SeedSequence):
            start = int(start) % 2**32
        observation = self.environment.reset(start, given.get("state"))
        self._show()
        return observation, {}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Advance by one control step of 0.02 s."""
        env = self.environment
        before = env.base_observation
        observation, _, absorbing, info = env.step(action)
        truncated = not absorbing and env.step_count >= env.horizon
        if self._reward is not None:
            reward = float(self._reward(env, before, action, env.base_observation, absorbing))
        else:
            reward = float(info["success"]) if absorbing or truncated else 0.0
        self._show()
        return observation, reward, absorbing, truncated, info | {"is_success": bool(info["success"])}

    def render(self) -> Any:
        """The present moment; see `airhockey.envs.rendering.render.Rendered.render`."""
        if self.render_mode is None:
            gymnasium.logger.warn(
                'render() shows nothing: make the environment with render_mode="rgb_array" or "human"'
            )
        return super().render()

    def get_state(self) -> RewardedState:
        """The present moment; see `airhockey.envs.Environment.get_state`. A reward of this package is part of it."""
        return RewardedState.of(self.environment, self._reward)

    def set_state(self, state: RewardedState) -> None:
        """Go to a moment that this environment, or one made with the same arguments, saved."""
        state.restore(self.environment, self._reward)

    state = property(get_state, set_state, doc="The present moment; see `get_state` and `set_state`.")


def register() -> None:
    """Register every task with Gymnasium, once."""
    for edition, names in TASKS.items():
        for name in names:
            id_ = f"{NAMESPACES[edition]}/{name}-v0"
            if id_ not in gymnasium.registry:
                made = {"name": name, "edition": edition}
                gymnasium.register(
                    id_,
                    entry_point=f"{__name__}:AirHockeyEnv",
                    vector_entry_point="airhockey.envs.vector.gymnasium:task_vector_env",
                    max_episode_steps=rules(edition).horizon.task,
                    kwargs=made,
                )


register()

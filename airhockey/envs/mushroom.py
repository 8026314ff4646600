"""The official interface: `AirHockeyChallengeWrapper`, a MushroomRL environment over the same simulation."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.copying import Copyable
from airhockey.envs.editions import DEFAULT, edition_of_names
from airhockey.envs.environment import Environment as ChallengeEnvironment
from airhockey.envs.info import RLInfo
from airhockey.envs.rendering.render import MODES, Renderer
from airhockey.envs.tasks.reward import RewardedState
from airhockey.errors import MissingDependencyError

try:
    from mushroom_rl.core import Environment, MDPInfo
    from mushroom_rl.utils.spaces import Box
except ImportError as error:
    raise MissingDependencyError(
        f"the official wrapper needs MushroomRL, and {error.name or 'a part of it'} cannot be imported ({error}); "
        "install it with: pip install 'airhockey[mushroom]' (cv2 also wants Debian's libgl1 and libglib2.0-0)"
    ) from error

Array = NDArray[np.float64]
Reward = Callable[["BaseEnvironment", Array, Any, Array, bool], float]


class BaseEnvironment(Copyable):
    """What the official package calls the base environment: the scene, with observations in world coordinates.

    Attributes:
        model, data: MuJoCo's. Moving something there moves it in the simulation.
        env_info: The same dictionary as the wrapper's.
        init_state: Joint positions at the start, in [rad]. Shape (n,).
    """

    def __init__(self, env: ChallengeEnvironment, env_info: dict[str, Any]) -> None:
        self._env = env
        self.env_info = env_info
        self.n_agents = env.n_agents
        self.init_state = np.array(env.simulation.robot.start)

    @property
    def model(self) -> Any:
        """MuJoCo's model of the scene."""
        return self._env.simulation.model

    @property
    def data(self) -> Any:
        """MuJoCo's data of the scene."""
        return self._env.simulation.data

    _model, _data = model, data

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "env_info"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.env_info = self._env.env_info

    @property
    def info(self) -> Any:
        """MushroomRL's `MDPInfo`."""
        return self.env_info["rl_info"]

    @property
    def dt(self) -> float:
        """Length of a control step, in [s]."""
        return self._env.dt

    def get_puck(self, observation: Array) -> tuple[Array, Array]:
        """Position (x, y, yaw) and velocity of the puck in a base observation, each of shape (3,)."""
        return observation[:3], observation[3:6]

    def get_joints(self, observation: Array, agent: int | None = None) -> tuple[Array, Array]:
        """Joint positions and velocities of a robot (1 or 2; default: 1) in a base observation, each of shape (n,)."""
        n = self._env.simulation.robot.n_joints
        first = 6 if agent in (None, 1) else 6 + observation.size // 2
        return observation[first : first + n], observation[first + n : first + 2 * n]

    def is_absorbing(self, observation: Array) -> bool:
        """Whether the latest step ended the episode."""
        return bool(self._env.verdict != 0)


class AirHockeyChallengeWrapper(Copyable, Environment):
    """The environment as agents of the challenge know it: `AirHockeyChallengeWrapper("7dof-hit")`, or of the edition of 2025
    `AirHockeyChallengeWrapper("hit")`, with `edition="2025"` where the name is that of several editions ("tournament").

    It can be copied, pickled, saved and restored as `airhockey.envs.Environment` can, with the same future. Starts come from
    NumPy's global generator, as in the official package; but a copy, and a wrapper that went back to a saved moment, must
    not rewind what others draw from: until `seed` is called, it goes on with a generator of its own, in the state that the
    global one was in when it was copied or saved.

    Args:
        env: An environment's name in its edition; see `airhockey.envs.Environment`.
        custom_reward_function: Called with (base environment, state, action, next state, absorbing) after each step; the
            states are base observations, in world coordinates.
        interpolation_order: 1, 2, 3, 4, 5, -1 or None; in the tournament also a pair of them.
        disturbances, visual: See `airhockey.envs.Environment`.
        edition: The year whose rules apply; by default the one that has an environment of this name, the first of them.

    Attributes:
        base_env: Has `model`, `data`, `env_info` and `init_state`.
        env_info: What agents are built with.
        env_name: The environment's name in its edition.
    """

    def __init__(
        self,
        env: str,
        custom_reward_function: Reward | None = None,
        interpolation_order: Any = 3,
        disturbances: Any = "ideal",
        edition: str | None = None,
        visual: bool = True,
        **kwargs: Any,
    ) -> None:
        if isinstance(interpolation_order, list):
            interpolation_order = tuple(interpolation_order)
        edition = edition or edition_of_names((env,)) or DEFAULT
        self._env = ChallengeEnvironment(env, interpolation_order, disturbances, edition, visual)
        self.env_name = self._env.name
        self.env_info = self._env.env_info
        self.env_info["rl_info"] = _mdp_info(self.env_info["rl_info"])
        self.base_env = BaseEnvironment(self._env, self.env_info)
        self._reward = custom_reward_function
        self._edition, self._renderers = edition, dict[str, Renderer]()
        self._draw_from_global()
        self._env.new_game()
        super().__init__(self.env_info["rl_info"])

    def seed(self, seed: int) -> None:
        """Seed the disturbances; starts are drawn from NumPy's global generator, as in the official package."""
        np.random.seed(seed)
        self._env._seed_streams(seed)
        self._draw_from_global()

    def reset(self, state: Array | None = None) -> Array:
        """Begin an episode or, in the tournament, the next serve.

        Args:
            state: A base observation to restore joints and puck from.
        """
        return self._env.reset(state=state)

    def step(self, action: Any) -> tuple[Array, float, bool, dict[str, Any]]:
        """Advance by one control step; `info` is that of `airhockey.envs.Environment.step`."""
        if self._reward is None:
            return self._env.step(action)
        before = self._env.base_observation
        observation, reward, absorbing, info = self._env.step(action)
        reward = self._reward(self.base_env, before, action, self._env.base_observation, absorbing)
        return observation, reward, absorbing, info

    def render(self, record: bool = False) -> Any:
        """Show the present moment, live.

        Args:
            record: Also give it as a picture.

        Returns:
            With `record` an array of shape (height, width, 3), else None.
        """
        if not self._renderers:
            self._renderers = {mode: Renderer(self.env_name, self._edition, mode) for mode in MODES}
        data = self._env.simulation.data
        if record:
            return self._renderers["rgb_array"].render(data)
        return self._renderers["human"].render(data)

    def stop(self) -> None:
        """Close what `render` opened."""
        for renderer in self._renderers.values():
            renderer.close()

    def get_state(self) -> RewardedState:
        """The present moment; see `airhockey.envs.Environment.get_state`. A reward of this package is part of it."""
        return RewardedState.of(self._env, self._reward)

    def set_state(self, state: RewardedState) -> None:
        """Go to a moment that this wrapper, or one made with the same arguments, saved."""
        state.restore(self._env, self._reward)

    state = property(get_state, set_state, doc="The present moment; see `get_state` and `set_state`.")

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name not in ("env_info", "_mdp_info")}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.env_info = self._env.env_info
        self._mdp_info = self.env_info["rl_info"]

    def _draw_from_global(self) -> None:
        """Agents seed their runs with `np.random.seed`."""
        self._env.draw_starts_from(np.random.mtrand._rand)


def _mdp_info(info: RLInfo) -> Any:
    observation, action = info.observation_space, info.action_space
    return MDPInfo(
        Box(observation.low, observation.high), Box(action.low, action.high), info.gamma, info.horizon, info.dt
    )

"""The player: features in, its network's action out, and a controller that keeps every constraint."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.atacom.network import Network
from airhockey.agents.base import AgentBase
from airhockey.agents.control.kinematics import spec_of
from airhockey.agents.learned import actions as learned_actions
from airhockey.agents.learned import features as learned_features
from airhockey.agents.learned.actions import ACTIONS, Controls, command, new_controls, take_position
from airhockey.agents.learned.features import Sights, new_sights, see, width_of, write
from airhockey.errors import ConfigurationError
from airhockey.inputs.broken import reading_errors
from airhockey.inputs.plain_yaml import read_yaml

Array = NDArray[np.float64]

NETWORK, POLICY = "network.npz", "policy.yaml"
"""The files of a player's folder: the weights, and what they were trained to see and to do."""


class LearnedPlayer(AgentBase):
    """Plays a task as a network was trained to, with NumPy alone.

    Args:
        env_info, agent_id: See `AgentBase`.
        network: Maps features to an action.
        actions: What that means (`ACTIONS`).
        repeat: Control steps that an action lasts.
        horizon: Control steps of an episode.
    """

    def __init__(
        self,
        env_info: Mapping[str, Any],
        network: Network,
        actions: str = "tip",
        repeat: int = 2,
        horizon: int = 500,
        agent_id: int = 1,
        **kwargs: Any,
    ) -> None:
        super().__init__(env_info, agent_id, **kwargs)
        if actions not in ACTIONS:
            raise ConfigurationError(f"unknown kind of actions {actions!r} in {POLICY}; allowed: {', '.join(ACTIONS)}")
        self._controls: Controls = new_controls(actions, spec_of(env_info), 1)
        self._sights: Sights = new_sights(env_info, actions == "joints", 1)
        width, size = width_of(self._sights.joints, self._controls.q.shape[1]), self._controls.wanted.shape[1]
        if (network.inputs, network.outputs) != (width, size):
            raise ConfigurationError(
                f"the network maps {network.inputs} numbers to {network.outputs}, but this robot with the actions "
                f"{actions!r} has {width} and {size}: play it in the environment that it was trained in"
            )
        self._network, self._repeat, self._horizon = network, repeat, horizon
        self._features = np.zeros(width, np.float32)
        learned_actions.warm_up(self._controls)
        learned_features.warm_up(self._sights)
        self.reset()
        self._compile()

    @classmethod
    def load(cls, folder: Path, env_info: Mapping[str, Any], **kwargs: Any) -> "LearnedPlayer":
        """The player in a folder, as `hockey train ppo` writes it.

        Raises:
            ConfigurationError: A file is missing or holds something else.
        """
        network, policy = Network.load(folder / NETWORK), read_yaml(folder / POLICY)
        with reading_errors(folder / POLICY):
            actions, repeat, horizon = str(policy["actions"]), int(policy["repeat"]), int(policy["horizon"])
            if repeat < 1 or horizon < 1:
                raise ConfigurationError(
                    f"{str(folder / POLICY)!r}: repeat is {repeat} and horizon {horizon}; give whole numbers from 1 up"
                )
        return cls(env_info, network, actions, repeat, horizon, **kwargs)

    def _compile(self) -> None:
        """Play a step, so that none has to wait for the compiler."""
        nothing = np.zeros(self.env_info["rl_info"].observation_space.shape)
        nothing[self.env_info["joint_pos_ids"]] = spec_of(self.env_info).start
        self.draw_action(nothing)
        self.reset()

    def reset(self) -> None:
        """The next observation is an episode's first."""
        self._step = 0
        self.phase = "learned"

    def draw_action(self, observation: Array) -> Array:
        """Position and velocity of the next command. Shape (2, n)."""
        controls, sights, first = self._controls, self._sights, self._step == 0
        if first:
            take_position(controls, 0, self.get_joint_pos(observation))
        see(sights, controls, 0, observation, first)
        if self._step % self._repeat == 0:
            write(sights, controls, 0, max(0.0, 1.0 - self._step / self._horizon), self._features)
            self._action = self._network(self._features).astype(np.float64)
        self._step += 1
        order = np.empty((2, controls.q.shape[1]))
        command(controls, 0, self._action, order)
        return order

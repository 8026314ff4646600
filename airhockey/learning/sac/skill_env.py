"""A skill as a Gymnasium environment: ATACOM as the wrapper of the action, the skill's features as the observation.

An action is the tip's velocity, held for `REPEAT` control steps. The learner's episode ends where the skill is finished; a
defence is then at rest, and the task goes on to its end to find out what that was worth.
"""

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from airhockey.agents.atacom.controller import AtacomController
from airhockey.agents.atacom.skill import REPEAT, LearnedTask, situation
from airhockey.agents.control.kinematics import spec_of
from airhockey.agents.estimation.kalman import PuckFilter
from airhockey.agents.skill import Situation
from airhockey.agents.table import CONTACT, to_table
from airhockey.envs.copying import Copyable
from airhockey.envs.gymnasium import AirHockeyEnv

Array = NDArray[np.float64]

AT_REST = 1e-3
"""Joint speed, in [rad]/[s], below which a command stands still."""
_NEAR = 0.012
"""Gap between puck and mallet, in [m], at which they may be touching within a step."""


class SkillEnv(Copyable, gymnasium.Wrapper[Any, Any, Array, Array]):
    """The wrapper; the environment's observations stay inside. Its copies are real ones, with an environment of their own.

    A skill's own rules are a subclass's: `begin`, `shaping`, `conclude`.

    Args:
        env: The task, with the thesis's reward.
        skill: What is trained.

    Attributes:
        violations, steps: How many control steps were played, and in how many of them a constraint was violated, since
            the environment was made.
    """

    REWARD_UNIT = 100.0
    """The thesis's rewards are divided by this."""
    LONGEST = 250
    """Actions after which an episode is truncated; the tasks themselves end before."""

    def __init__(self, env: AirHockeyEnv, skill: LearnedTask) -> None:
        super().__init__(env)
        self._environment = env.environment
        info = env.environment.env_info
        self._info, self._skill = info, skill
        self.controller = AtacomController(spec_of(info), info["dt"])
        self._filter = PuckFilter(info["dt"])
        self.observation_space = spaces.Box(-5.0, 5.0, skill.mirror.shape, np.float32)
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        self.violations = self.steps = 0

    def begin(self, observation: Array, seed: Any) -> Array:
        """Prepare the task's start; gives the observation to begin with, and sets the controller."""
        self.controller.reset(observation[self._info["joint_pos_ids"]])
        return observation

    def shaping(self, before: Situation, after: Situation) -> float:
        """What an action is rewarded with on the way."""
        raise NotImplementedError

    def conclude(self, seen: Situation) -> tuple[bool, float]:
        """Called where the learner's episode ends: whether it was a success, and what is added to the reward."""
        raise NotImplementedError

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begin an episode; see `AirHockeyEnv.reset`."""
        observation, info = self.env.reset(seed=seed, options=options)
        self._filter.reset()
        self._reward, self._over, self._success, self._actions = 0.0, False, False, 0
        observation = self.begin(observation, (options or {}).get("seed", seed))
        self._now = self._see(observation)
        return self._skill.observe(self._now), info

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Let an action last for `REPEAT` control steps, or less where the skill or the task ends."""
        before, finished, self._reward = self._now, False, 0.0
        for _ in range(REPEAT):
            self._now = self._see(self._command(self.controller.step(action)))
            finished = self._skill.finished(self._now)
            if self._over or finished:
                break
        self._actions += 1
        seen, ended = self._now, self._over or finished
        truncated = not ended and self._actions >= self.LONGEST
        reward, info = self.shaping(before, seen), {}
        if ended or truncated:
            success, bonus = self.conclude(seen)
            reward, info = reward + bonus, {"success": success}
        return self._skill.observe(seen), reward + self._reward / self.REWARD_UNIT, ended, truncated, info

    def rest(self) -> None:
        """Come to rest, and let the task go on to its end."""
        controller = self.controller
        while not self._over:
            still = float(np.abs(controller.velocity).max()) < AT_REST
            here = np.array([controller.q, np.zeros_like(controller.q)])
            self._command(here if still else controller.step(np.zeros(2)))

    def _command(self, command: Array) -> Array:
        """One control step; gives the observation."""
        observation, reward, terminated, truncated, info = self.env.step(command)
        self.steps += 1
        self.violations += bool(self._environment.constraint_values.max() > 0.0)
        self._reward += float(reward)
        self._over, self._success = terminated or truncated, bool(info["success"])
        return np.asarray(observation)

    def _see(self, observation: Array) -> Situation:
        """Filter the puck."""
        position, velocity = observation[self._info["puck_pos_ids"]], observation[self._info["puck_vel_ids"]]
        puck, tip = np.array([*to_table(position), position[2]]), to_table(self.controller.tip)
        touching = bool(np.hypot(*(puck[:2] - tip)) < CONTACT + _NEAR)
        return situation(self._filter.update(puck, velocity, touching), self.controller)

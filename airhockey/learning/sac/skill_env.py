"""A skill as a Gymnasium environment: ATACOM as the wrapper of the action, the skill's features as the observation.

An action is the tip's velocity, held for `REPEAT` control steps. The learner's episode ends where the skill is finished;
what the handover is worth is then found out by playing on, at rest, to the end of the task.
"""

from typing import Any, Protocol

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from airhockey.agents.atacom.controller import AtacomController
from airhockey.agents.atacom.skill import REPEAT, Situation, Skill, situation
from airhockey.agents.control.kinematics import spec_of
from airhockey.agents.estimation.kalman import PuckFilter
from airhockey.agents.table import CONTACT, to_table
from airhockey.envs.gymnasium import AirHockeyEnv

Array = NDArray[np.float64]

AT_REST = 1e-3
"""Joint speed, in [rad]/[s], below which a command stands still."""
_NEAR = 0.012
"""Gap between puck and mallet, in [m], at which they may be touching within a step."""


class Judge(Protocol):
    """What a skill's training is rewarded with."""

    def start(self, now: Situation) -> None:
        """The episode begins."""

    def step(self, now: Situation) -> float:
        """Reward of an action that led here."""

    def end(self, success: bool, now: Situation, violation: float) -> float:
        """Reward of the end.

        Args:
            success: What the task said in the end.
            now: Where the skill was finished.
            violation: Normalised penalty of the episode's violations, 0 … 1 (thesis 4.2).
        """


class SkillEnv(gymnasium.Wrapper[Any, Any, Array, Array]):
    """The wrapper; the environment's observations stay inside.

    Attributes:
        violations, steps: How many control steps were played, and in how many of them a constraint was violated, since
            the environment was made.
    """

    def __init__(self, env: AirHockeyEnv, skill: Skill, judge: Judge) -> None:
        super().__init__(env)
        self._environment = env.environment
        info = env.environment.env_info
        self._info, self._skill, self._judge = info, skill, judge
        self._controller = AtacomController(spec_of(info), info["dt"])
        self._filter = PuckFilter(info["dt"])
        self.observation_space = spaces.Box(-5.0, 5.0, skill.mirror.shape, np.float32)
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        self.violations = self.steps = 0

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begin an episode."""
        observation, info = self.env.reset(seed=seed, options=options)
        self._filter.reset()
        self._controller.reset(observation[self._info["joint_pos_ids"]])
        self._violated: set[str] = set()
        self._now = self._see(observation)
        self._judge.start(self._now)
        return self._skill.observe(self._now), info

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Let an action last for `REPEAT` control steps, and where it was the last, play the task to its end."""
        terminated = truncated = finished = False
        info: dict[str, Any] = {}
        for _ in range(REPEAT):
            terminated, truncated, info = self._move(action)
            finished = self._skill.finished(self._now)
            if terminated or truncated or finished:
                break
        reward, seen = self._judge.step(self._now), self._now
        over = terminated or truncated
        while finished and not over:
            terminated, truncated, info = self._rest()
            over = terminated or truncated
        if over:
            success = bool(info["success"])
            reward += self._judge.end(success, seen, self._penalty())
            info = {"success": success, "violated": sorted(self._violated)}
        return self._skill.observe(seen), reward, over and not truncated or finished, truncated and not finished, info

    def _move(self, action: Array) -> tuple[bool, bool, dict[str, Any]]:
        """One control step."""
        observation, terminated, truncated, info = self._command(self._controller.step(action))
        self._now = self._see(observation)
        return terminated, truncated, info

    def _rest(self) -> tuple[bool, bool, dict[str, Any]]:
        """One control step of standing still, or of coming to it."""
        controller = self._controller
        still = float(np.abs(controller.velocity).max()) < AT_REST
        command = np.array([controller.q, np.zeros_like(controller.q)]) if still else controller.step(np.zeros(2))
        return self._command(command)[1:]

    def _command(self, command: Array) -> tuple[Array, bool, bool, dict[str, Any]]:
        observation, _, terminated, truncated, info = self.env.step(command)
        self.steps += 1
        if self._environment.constraint_values.max() > 0.0:
            self.violations += 1
            self._violated |= {name for name, values in info["constraints_value"].items() if values.max() > 0.0}
        return observation, terminated, truncated, info

    def _see(self, observation: Array) -> Situation:
        """Filter the puck."""
        position, velocity = observation[self._info["puck_pos_ids"]], observation[self._info["puck_vel_ids"]]
        puck, tip = np.array([*to_table(position), position[2]]), to_table(self._controller.tip)
        touching = bool(np.hypot(*(puck[:2] - tip)) < CONTACT + _NEAR)
        return situation(self._filter.update(puck, velocity, touching).state, self._controller)

    def _penalty(self) -> float:
        points = self._environment.edition.penalty_points
        of_robot = {name: points[name] for name in self._info["constraints"].keys()}  # noqa: SIM118 - not a mapping
        return sum(of_robot[name] for name in self._violated) / sum(of_robot.values())

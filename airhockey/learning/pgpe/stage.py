"""Where a task is trained: its environments, how an episode begins, and what it is worth."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey import envs
from airhockey.agents.table import CONTACT, HOME
from airhockey.agents.thesis.agent import ThesisAgent
from airhockey.agents.thesis.parameters import ThesisParameters
from airhockey.envs.compiled import inverse_kinematics, work_space
from airhockey.envs.disturbances import Disturbances
from airhockey.envs.editions import edition
from airhockey.envs.tasks import Reward, TaskReward, reward_for
from airhockey.envs.tasks.hit import HitReward
from airhockey.envs.tasks.positions import puck_and_mallet
from airhockey.errors import ConfigurationError
from airhockey.evaluator.isolation.handle import LocalAgent
from airhockey.evaluator.play.seat import Care, Seat

Array = NDArray[np.float64]

POSITION, VELOCITY = slice(0, 3), slice(3, 6)
"""Of the puck, in a base observation."""
_FIXED: dict[str, tuple[slice, ...]] = {
    "none": (), "position": (POSITION,), "velocity": (VELOCITY,), "both": (POSITION, VELOCITY)
}  # fmt: skip
FIXED_STARTS = tuple(_FIXED)
_FIXED_START = 3
"""Key of the seed that the puck's fixed start is drawn with."""
HOME_STEPS = 150
"""Control steps that there are to reach home."""
_AT_HOME = 0.03
"""Distance from home at the end that counts as being there, in [m]."""
_AWAY = ((-0.8, -0.25), (-0.38, 0.38))
"""Where the mallet starts when the way home is trained: ranges of x and y in world coordinates, in [m]."""


def environments_of(task: str, robot: str) -> tuple[str, ...]:
    """The environments that a task is trained in; a switcher in all of the robot's, since it is to tell them apart.

    Raises:
        ConfigurationError: The robot does not have this task.
    """
    tasks = tuple(edition().score_weights[robot])
    if task == "switcher":
        return tasks
    name = f"{robot}-{'hit' if task == 'home' else task}"
    if name not in tasks:
        there = ", ".join([one.partition("-")[2] for one in tasks] + ["home", "switcher"])
        raise ConfigurationError(f"there is no task {task!r} for the {robot} robot; its tasks are {there}")
    return (name,)


@dataclass
class Stage:
    """One environment of a task.

    Attributes:
        task: What is trained in it.
        name: The environment's name.
        discount: γ, which the goal's reward depends on.
        profile: Disturbances.
        sparse: The reward says only at the end whether the task was accomplished (5.1).
        fixed: What of the puck's start is always the same: see `Settings.fixed_start`.
        seed: From which that start is drawn.
    """

    task: str
    name: str
    discount: float
    profile: Disturbances
    sparse: bool = False
    fixed: str = "none"
    seed: int = 0

    def __post_init__(self) -> None:
        self.env = envs.make(self.name, disturbances=self.profile)
        if self.task == "home":
            self.env.horizon = HOME_STEPS
        played = self.task if self.task != "switcher" else self.name.partition("-")[2]
        self.reward: Reward = reward_for(played)
        if self.task == "home":
            self.reward = TaskReward(accomplished=at_home)
        elif self.sparse:
            self.reward = TaskReward()
        elif isinstance(self.reward, HitReward):
            self.reward = HitReward(self.discount)
        if self.fixed != "none":
            self.env.reset(seed=np.random.SeedSequence(self.seed, spawn_key=(_FIXED_START,)))
            self._start = self.env.base_observation

    def seat(self, parameters: ThesisParameters) -> Seat:
        """The seat of the rule-based player; a switcher is offered every task, and on the way home there is none."""
        env_info = dict(self.env.env_info)
        if self.task in ("switcher", "home"):
            env_info["env_name"] = "tournament" if self.task == "switcher" else f"{self.name.partition('-')[0]}-home"
        agent = ThesisAgent(env_info, parameters=parameters)
        return Seat(LocalAgent(agent), self.env.formats[0], Care())

    def place(self, observation: Array, seed: np.random.SeedSequence) -> Array:
        """Put the mallet where the way home is trained from, and the puck where it always starts.

        Gives the observation to begin with: the one given where neither is asked for.
        """
        if self.task == "home":
            random = np.random.default_rng(seed.generate_state(4))
            return self.env.reset(state=_away_from_home(self.env, random))
        fixed = _FIXED[self.fixed]
        if not fixed:
            return observation
        state = self.env.base_observation
        rows, start = (
            one.reshape(self.env.n_agents, -1) for one in (state, self._start)
        )  # every robot's holds the puck
        for part in fixed:
            rows[:, part] = start[:, part]
        return self.env.reset(state=state)

    def accomplished(self) -> bool:
        """Whether the task is, now that the episode is over."""
        return at_home(self.env) if self.task == "home" else bool(self.env.succeeded)


def at_home(env: Any) -> bool:
    """Whether the mallet is at home."""
    now = puck_and_mallet(env, env.base_observation)
    return bool(np.hypot(*(now.mallet - HOME)) < _AT_HOME)


def _away_from_home(env: Any, random: np.random.Generator) -> Array:
    """A base observation with the mallet somewhere on its half, clear of the puck."""
    state = env.base_observation
    robot, n = env.simulation.robot, env.simulation.robot.n_joints
    while True:
        place = np.array([random.uniform(*bounds) for bounds in _AWAY])
        if np.hypot(*(place - state[:2])) < 2.0 * CONTACT:
            continue
        joints = np.array(robot.start)
        target = np.array([place[0] - robot.base_positions[0][0], place[1], robot.desired_height])
        if inverse_kinematics(env.simulation.arm, target, joints, work_space(n)):
            state[6 : 6 + n], state[6 + n : 6 + 2 * n] = joints, 0.0
            return np.asarray(state)

"""The tasks, a page each: `hit`, `defend`, `prepare` and `game`.

A page's docstring is the task's manual: start, ends, success, reward, observation and action, in tables. Its code is the same in
the same order. A new task is a page of its own here, and a row among the `environments` of an edition, whose `kind` names the
page.

The rewards are the thesis's (4.1.3 and 4.2), as sums of named terms:

    reward = tasks.reward_for("hit")
    env = AirHockeyChallengeWrapper("7dof-hit", custom_reward_function=reward)

Or with the environment of this package:

    before = env.base_observation
    observation, _, absorbing, info = env.step(action)
    value = reward(env, before, action, env.base_observation, absorbing)
    reward.terms    # {"approach": -0.31, "constraints": -0.002}
"""

import importlib
import pathlib

from airhockey.envs.tasks.reward import Reward, TaskReward
from airhockey.envs.tasks.task import Task
from airhockey.errors import unknown

__all__ = ["Reward", "Task", "TaskReward", "available", "reward_for", "task"]

_SHARED = ("__init__", "positions", "reward", "start", "task", "verdicts")
_HOME = "home"
"""The way home, which is trained and rewarded as a task, but has no page: no environment plays it."""


def available() -> tuple[str, ...]:
    """The names of the pages."""
    return tuple(sorted(page.stem for page in pathlib.Path(__file__).parent.glob("*.py") if page.stem not in _SHARED))


def task(kind: str) -> Task:
    """The task of a page.

    Raises:
        ConfigurationError: There is no such page.
    """
    if kind not in available():
        raise unknown("task", kind, available())
    found: Task = importlib.import_module(f"{__name__}.{kind}").TASK
    return found


def reward_for(kind: str) -> Reward:
    """The reward of a task: "hit", "defend", "prepare" or "home".

    Raises:
        ConfigurationError: There is no reward for this task.
    """
    rewards = {_HOME: TaskReward} | {page: task(page).reward for page in available()}
    reward = rewards.get(kind)
    if reward is None:
        raise unknown("task with a reward", kind, sorted(name for name, found in rewards.items() if found))
    return reward()

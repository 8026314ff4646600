"""The thesis's rewards (4.1.3 and 4.2), as sums of named terms.

    reward = rewards.reward_for("hit")
    env = AirHockeyChallengeWrapper("7dof-hit", custom_reward_function=reward)

Or with the environment of this package:

    before = env.base_observation
    observation, _, absorbing, info = env.step(action)
    value = reward(env, before, action, env.base_observation, absorbing)
    reward.terms    # {"approach": -0.31, "constraints": -0.002}
"""

from airhockey.envs.rewards.hit import HitReward
from airhockey.envs.rewards.reward import Reward
from airhockey.envs.rewards.task import TaskReward
from airhockey.errors import unknown

__all__ = ["HitReward", "Reward", "TaskReward", "reward_for"]

_REWARDS: dict[str, type[Reward]] = {
    "hit": HitReward,
    "defend": TaskReward,
    "prepare": TaskReward,
    "home": TaskReward,
}


def reward_for(task: str) -> Reward:
    """The thesis's reward of a task: "hit", "defend", "prepare" or "home".

    Raises:
        ConfigurationError: There is no reward for this task.
    """
    if task not in _REWARDS:
        raise unknown("task with a reward", task, _REWARDS)
    return _REWARDS[task]()

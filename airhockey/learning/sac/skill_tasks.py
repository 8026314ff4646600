"""Where each skill is trained."""

from airhockey.agents.atacom.skill import SKILLS
from airhockey.envs.gymnasium import AirHockeyEnv
from airhockey.learning.sac.judges import JUDGES
from airhockey.learning.sac.skill_env import SkillEnv


def make_task(task: str, robot: str, disturbances: str = "ideal") -> SkillEnv:
    """The environment in which a skill is trained.

    Args:
        task: "defend" or "home".
        robot: "3dof" or "7dof".
        disturbances: A profile's name or the path of one.
    """
    return SkillEnv(AirHockeyEnv(f"{robot}-defend", disturbances=disturbances), SKILLS[task], JUDGES[task]())

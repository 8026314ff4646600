"""The environment, as a MushroomRL one."""

from airhockey.envs.mushroom import AirHockeyChallengeWrapper

__all__ = ["AirHockeyChallengeWrapper"]

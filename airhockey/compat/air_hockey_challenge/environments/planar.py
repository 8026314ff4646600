"""The tasks of the 3-joint robot as MushroomRL environments."""

from typing import Any

from airhockey.envs.mushroom import AirHockeyChallengeWrapper


class AirHockeyHit(AirHockeyChallengeWrapper):
    """Hit the puck into the goal."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("3dof-hit", interpolation_order=kwargs.get("interpolation_order", 3))


class AirHockeyDefend(AirHockeyChallengeWrapper):
    """Stop the puck."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("3dof-defend", interpolation_order=kwargs.get("interpolation_order", 3))

"""Hit the puck into the goal."""

from airhockey.compat.base_environments import Hit

from .single import AirHockeySingle


class AirHockeyHit(Hit, AirHockeySingle):
    """Hit the puck into the goal."""

    _scene = "3dof-hit"

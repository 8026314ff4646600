"""Hit the puck into the goal; a second robot stands opposite."""

from airhockey.compat.base_environments import Hit

from .env_double import AirHockeyDouble


class AirHockeyHit(Hit, AirHockeyDouble):
    """Hit the puck into the goal; a second robot stands opposite."""

    _scene = "7dof-hit"

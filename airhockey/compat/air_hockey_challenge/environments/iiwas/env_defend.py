"""Stop the puck."""

from airhockey.compat.base_environments import Defend

from .env_single import AirHockeySingle


class AirHockeyDefend(Defend, AirHockeySingle):
    """Stop the puck."""

    _scene = "7dof-defend"

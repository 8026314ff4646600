"""Move the puck to where it can be hit."""

from airhockey.compat.base_environments import Prepare

from .env_single import AirHockeySingle


class AirHockeyPrepare(Prepare, AirHockeySingle):
    """Move the puck to where it can be hit."""

    _scene = "7dof-prepare"

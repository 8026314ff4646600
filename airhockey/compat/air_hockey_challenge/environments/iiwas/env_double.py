"""Two iiwas."""

from .env_base import AirHockeyBase


class AirHockeyDouble(AirHockeyBase):
    """Two iiwas."""

    _scene = "tournament"

"""One planar robot."""

from .base import AirHockeyBase


class AirHockeySingle(AirHockeyBase):
    """One planar robot."""

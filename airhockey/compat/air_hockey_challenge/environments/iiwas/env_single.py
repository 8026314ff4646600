"""One iiwa."""

from .env_base import AirHockeyBase


class AirHockeySingle(AirHockeyBase):
    """One iiwa."""

    _scene = "7dof-defend"

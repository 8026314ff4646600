"""The scene of the planar robot."""

from airhockey.compat.base_environments import BaseEnvironment


class AirHockeyBase(BaseEnvironment):
    """The scene of the planar robot."""

    _scene = "3dof-hit"

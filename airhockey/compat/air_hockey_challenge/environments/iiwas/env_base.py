"""The scene of one iiwa."""

from airhockey.compat.base_environments import BaseEnvironment


class AirHockeyBase(BaseEnvironment):
    """The scene of one iiwa."""

    _scene = "7dof-defend"

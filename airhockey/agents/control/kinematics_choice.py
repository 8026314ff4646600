"""Which kinematics a player computes with: our compiled ones, or Pinocchio's."""

from airhockey.agents.control.kinematics import ArmKinematics
from airhockey.errors import MissingDependencyError, unknown


def chosen_kinematics(own: ArmKinematics, name: str) -> ArmKinematics:
    """The kinematics by name: "compiled" (`own`) or "pinocchio".

    Raises:
        ConfigurationError: Another name.
        MissingDependencyError: Pinocchio is not installed.
    """
    if name == "compiled":
        return own
    if name != "pinocchio":
        raise unknown("kinematics", name, ("compiled", "pinocchio"))
    try:
        from airhockey.agents.control.pinocchio_model import PinocchioKinematics
    except ModuleNotFoundError as error:
        raise MissingDependencyError(f"{error.name} is not installed: pip install 'airhockey[control]'") from error
    return PinocchioKinematics(own.spec)

"""All parameters of the rule-based player: `thesis.yaml` and `tuned.yaml` beside this module."""

from dataclasses import asdict, dataclass, replace
from pathlib import Path

from airhockey.agents.control.parameters import ControlParameters
from airhockey.agents.parameters import load_parameters
from airhockey.agents.thesis.defend import DefendParameters
from airhockey.agents.thesis.hit import HitParameters
from airhockey.agents.thesis.home import HomeParameters
from airhockey.agents.thesis.prepare import PrepareParameters
from airhockey.agents.thesis.switcher import SwitcherParameters


@dataclass(frozen=True)
class Margins:
    """How near the joint controller goes to the robot's limits; what is None is left to the robot's own file.

    Attributes:
        velocity_share, position_share, acceleration_share: See `ControlParameters`.
    """

    velocity_share: float | None = None
    position_share: float | None = None
    acceleration_share: float | None = None

    def within(self, control: ControlParameters) -> ControlParameters:
        """The controller's parameters with these margins."""
        return replace(control, **{name: share for name, share in asdict(self).items() if share is not None})


@dataclass(frozen=True)
class ThesisParameters:
    """θ and thresholds of every task.

    Attributes:
        hit, defend, prepare, home, switcher: Their own.
        opponent_rate: Angular rate at which an opponent that repeats itself is expected to, in [rad]/[s].
        margins: Of the joint controller.
    """

    hit: HitParameters
    defend: DefendParameters
    prepare: PrepareParameters
    home: HomeParameters
    switcher: SwitcherParameters
    opponent_rate: float
    margins: Margins = Margins()


def thesis_parameters(source: str | Path | ThesisParameters = "tuned") -> ThesisParameters:
    """The package's `thesis` or `tuned`, a file of the user's, or what somebody else has made already.

    Raises:
        ConfigurationError: No such file, or one that does not fit.
    """
    if isinstance(source, ThesisParameters):
        return source
    return load_parameters(ThesisParameters, source, Path(__file__).parent)

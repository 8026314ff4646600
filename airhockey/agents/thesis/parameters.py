"""All parameters of the rule-based player: `thesis.yaml` and `tuned.yaml` beside this module."""

from dataclasses import asdict, dataclass, replace
from pathlib import Path

from airhockey.agents.control.parameters import ControlParameters
from airhockey.agents.parameters import convert, load_parameters
from airhockey.agents.settings import asked_of, plain, with_settings
from airhockey.agents.thesis.defend import DefendParameters
from airhockey.agents.thesis.hit import HitParameters
from airhockey.agents.thesis.home import HomeParameters
from airhockey.agents.thesis.prepare import PrepareParameters
from airhockey.agents.thesis.switcher import SwitcherParameters

_FOLDER = Path(__file__).parent


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
        state_machine: A task is changed only through home (4.3.2); otherwise to whatever the switcher suggests.
    """

    hit: HitParameters
    defend: DefendParameters
    prepare: PrepareParameters
    home: HomeParameters
    switcher: SwitcherParameters
    opponent_rate: float
    margins: Margins = Margins()
    state_machine: bool = True


@dataclass(frozen=True)
class ThesisSettings(ThesisParameters):
    """What `--set thesis.…` can change: all of them, and the file that they come from.

    Attributes:
        parameters: As `thesis_parameters` takes it.
    """

    parameters: str = "tuned"


def thesis_parameters(source: str | Path | ThesisParameters = "tuned") -> ThesisParameters:
    """The package's `thesis` or `tuned`, a file of the user's, or what somebody else has made already; then `--set thesis.…`.

    Raises:
        ConfigurationError: No such file, or one that does not fit.
    """
    asked = asked_of("thesis")
    source = asked.pop("parameters", source)
    own = source if isinstance(source, ThesisParameters) else load_parameters(ThesisParameters, source, _FOLDER)
    return convert(ThesisParameters, with_settings(plain(own), asked), "--set thesis") if asked else own

"""Numbers and names as people read them."""

import math
from collections.abc import Iterable

from airhockey.evaluator.judging.tasks import wilson_interval

CONSTRAINTS = {
    "joint_pos_constr": "joint position",
    "joint_vel_constr": "joint velocity",
    "ee_constr": "end-effector",
    "link_constr": "elbow and wrist",
    "computation_time": "computation time",
}
UNITS = {"joint_pos_constr": "rad", "joint_vel_constr": "rad/s", "ee_constr": "m", "link_constr": "m"}


def constraint(name: str) -> str:
    """A constraint's name in words."""
    return CONSTRAINTS.get(name, name)


def percent(share: float) -> str:
    """A share, to a tenth of a percent."""
    return f"{share:.1%}"


def points(difference: float) -> str:
    """A difference of shares in percentage points, with its sign."""
    return f"{100 * difference:+.1f}".replace("-", "−")


def interval(successes: int, trials: int) -> str:
    """The 95 % interval of a share."""
    low, high = wilson_interval(successes, trials)
    return f"{low:.1%} – {high:.1%}"


def milliseconds(seconds: float) -> str:
    """A time to three digits, in ms."""
    return f"{seconds * 1e3:.3g} ms"


def p_value(value: float) -> str:
    """A p-value; below 0.0001 only that."""
    said = "p < 0.0001" if value < 1e-4 else f"p = {value:.2g}"
    return said.replace(" ", "\N{NO-BREAK SPACE}")


def clock(step: int, period: float = 0.02) -> str:
    """The time of a control step in a game, as minutes and seconds."""
    minutes, seconds = divmod(step * period, 60.0)
    return f"{int(minutes)}:{seconds:04.1f}"


def count(number: int, what: str) -> str:
    """A number of things."""
    return f"{number:,} {what}{'' if number == 1 else 's'}"


def enumeration(things: Iterable[str]) -> str:
    """Things with commas and an "and"."""
    listed = list(things)
    return listed[0] if len(listed) == 1 else f"{', '.join(listed[:-1])} and {listed[-1]}"


def file_size(size: int) -> str:
    """A number of bytes."""
    return f"{size / 1e6:.1f} MB" if size >= 1e6 else f"{math.ceil(size / 1e3)} kB"

"""θ: which numbers of the rule-based player are trained, and how a vector of them becomes a whole set of parameters."""

import dataclasses
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import resources
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from airhockey.agents.parameters import convert
from airhockey.agents.settings import plain
from airhockey.agents.thesis.parameters import ThesisParameters
from airhockey.errors import ConfigurationError, unknown
from airhockey.inputs.plain_yaml import load_yaml

Array = NDArray[np.float64]

_OF_TASK = {
    "hit": ("hit.theta.",),
    "defend": ("defend.theta.",),
    "prepare": ("prepare.theta.",),
    "home": ("hit.theta.0", "hit.theta.1", "home."),  # the way home turns by the hit's θ (4.15)
    "switcher": ("switcher.",),
}
"""Beginnings of the names that a task trains unless it is told otherwise: the thesis's θ."""


@dataclasses.dataclass(frozen=True)
class Range:
    """Where a parameter may be.

    Attributes:
        lower, upper: Bounds.
        sigma: Standard deviation to start a search with.
    """

    lower: float
    upper: float
    sigma: float


@cache
def ranges() -> dict[str, Range]:
    """Every trainable parameter by name."""
    text = resources.files(__package__).joinpath("trainable.yaml").read_text(encoding="utf-8")
    return {name: Range(*map(float, values)) for name, values in load_yaml(text, "trainable.yaml").items()}


def names_of(task: str, asked: Sequence[str] = (), fixed: Sequence[str] = (), only: str | None = None) -> list[str]:
    """The parameters to train.

    Args:
        task: "hit", "defend", "prepare", "home" or "switcher".
        asked: Names, or beginnings of names ("hit."), to train instead of the task's own.
        fixed: Names or indices of those among them that stay as they are.
        only: Name or index of the one that is trained, all others fixed.

    Raises:
        ConfigurationError: A name or an index that there is not, or nothing left to train.
    """
    wanted = asked or _OF_TASK[task]
    names = [name for name in ranges() if any(name.startswith(start) for start in wanted)]
    for start in asked:
        if not any(name.startswith(start) for name in ranges()):
            raise unknown("trainable parameter", start, ranges())
    if only is not None:
        return [resolve(only, names)]
    left = [name for name in names if name not in {resolve(one, names) for one in fixed}]
    if not left:
        raise ConfigurationError(f"every parameter is fixed, nothing is left to train; there are {', '.join(names)}")
    return left


def resolve(given: str, names: Sequence[str]) -> str:
    """The name of a parameter given by its name or by its index among those trained."""
    if given in names:
        return given
    if given.isdigit():
        if int(given) < len(names):
            return names[int(given)]
        raise ConfigurationError(
            f"there is no parameter {given}: θ has the indices 0 to {len(names) - 1} ({', '.join(names)})"
        )
    raise unknown("parameter (or index of one)", given, names)


def read(parameters: ThesisParameters, names: Sequence[str]) -> Array:
    """The values of some parameters. Shape (len(names),).

    Raises:
        ConfigurationError: One of them has no value to start from.
    """
    content = plain(parameters)
    values = []
    for name in names:
        try:
            value: Any = content
            for step in name.split("."):
                value = value[_key(step)]
        except KeyError:
            raise ConfigurationError(f"{name} is not set, so there is nothing to start from: --set {name}=…") from None
        values.append(float(value))
    return np.array(values)


def replaced(parameters: ThesisParameters, values: Mapping[str, float]) -> ThesisParameters:
    """The parameters with some of them replaced.

    Args:
        parameters: To start from.
        values: Name -> new value.

    Raises:
        ConfigurationError: A name that there is not.
    """
    content = plain(parameters)
    for name, value in values.items():
        if name not in ranges():
            raise unknown("trainable parameter", name, ranges())
        *way, last = name.split(".")
        part: Any = content
        for step in way:
            part = part[_key(step)]
        part[_key(last)] = float(value)
    return convert(ThesisParameters, content, "parameters")


def _key(step: str) -> str | int:
    return int(step) if step.isdigit() else step


def bounds(names: Sequence[str]) -> tuple[Array, Array]:
    """Lower and upper bounds of some parameters. Shapes (d,), (d,)."""
    chosen = [ranges()[name] for name in names]
    return np.array([one.lower for one in chosen]), np.array([one.upper for one in chosen])


def on_bounds(names: Sequence[str], mean: Array) -> list[str]:
    """Those whose mean sits on a bound: the search cannot go further, and the best value may lie beyond."""
    lower, upper = bounds(names)
    return [name for name, value, low, high in zip(names, mean, lower, upper, strict=True) if not low < value < high]


def as_yaml(parameters: ThesisParameters, comment: Sequence[str] = ()) -> str:
    """A parameter file, as agents and `hockey evaluate --parameters` read it."""
    head = "".join(f"# {line}\n" for line in comment)
    return head + yaml.safe_dump(plain(parameters), sort_keys=False, default_flow_style=None, width=120)

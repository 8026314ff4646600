"""What the commands that train networks have in common: options, the packages they need, a line of the log, the figures."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, TypeVar

import msgspec
import rich_click as click

from airhockey.commands._options import Option
from airhockey.errors import MissingDependencyError

Kind = TypeVar("Kind", bound=msgspec.Struct)

hidden = click.option(
    "--hidden", type=click.IntRange(min=1), default=128, show_default=True, help="Units of a hidden layer."
)
episodes = click.option(
    "--episodes", type=click.IntRange(min=1), default=100, show_default=True, help="Played in the end, unseen ones."
)
HEAD = "  actions     return   success  violations"
"""Over what `columns` gives."""


def steps(default: int) -> Option:
    """How long a training is."""
    return click.option(
        "--steps", type=click.IntRange(min=1), default=default, show_default=True, help="Actions in all."
    )


def learning_rate(default: float) -> Option:
    """Of every part of what learns."""
    return click.option(
        "--learning-rate",
        type=click.FloatRange(min=0.0, min_open=True),
        default=default,
        show_default=True,
        help="To begin with; it falls to a tenth.",
    )


@contextmanager
def learning_packages() -> Iterator[None]:
    """Around the imports of what learns: says what to install where it cannot be imported."""
    try:
        yield
    except ImportError as error:
        raise MissingDependencyError(
            f"training networks needs {error.name or 'a package'}, which cannot be imported; "
            "install it with: pip install 'airhockey[rl]'"
        ) from error


def settings_of(kind: type[Kind], given: Mapping[str, Any]) -> Kind:
    """The settings that a command line asks for; what is no option has its default."""
    from airhockey.commands._session import disturbances_of

    values = {name: given[name] for name in kind.__struct_fields__ if name in given}
    return kind(**values | {"disturbances": disturbances_of(given)})


def columns(line: Any) -> str:
    """What the lines of every log say."""
    return f"{line.steps:>9} {line.mean_return:>10.4g} {line.success:>9.1%} {line.violations:>11.2%}"


def say_figures(figures: Mapping[str, float]) -> None:
    """What the trained network reaches."""
    click.echo(
        f"{figures['episodes']} unseen episodes: success {figures['success']:.1%}, return {figures['mean_return']:.4g}, "
        f"violations in {figures['violations']:.2%} of the steps"
    )

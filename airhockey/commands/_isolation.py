"""Options for agents that live apart, shared by every command that plays."""

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import rich_click as click

if TYPE_CHECKING:
    from airhockey.evaluator.isolation.modes import Mode

ISOLATION_OPTIONS = (
    click.option(
        "--isolate",
        type=click.Choice(["none", "process", "sandbox"]),
        help="Where an agent lives: here, in a process of its own, or in a sandbox without network and files."
        "  [default: none for our own agents, sandbox for submissions]",
    ),
    click.option(
        "--patience",
        type=click.FloatRange(min=0.0, min_open=True),
        default=60.0,
        show_default=True,
        metavar="SECONDS",
        help="How long to wait for an isolated or remote agent before it is stopped.",
    ),
)


def isolation_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options to a command."""
    for option in reversed(ISOLATION_OPTIONS):
        command = option(command)
    return command


def isolation_of(agent: str, asked: str | None) -> "Mode":
    """Where an agent is to live."""
    from airhockey.evaluator.isolation.modes import choose

    return choose(agent, asked).mode


def say_what_is_not_protected(agents: Iterable[str], asked: str | None) -> None:
    """Warn on the standard error, once everything else about the command was found to be right."""
    from airhockey.evaluator.isolation.modes import choose

    for agent in dict.fromkeys(agents):
        warning = choose(agent, asked).warning
        if warning is not None:
            click.echo(f"hockey: warning: {warning}", err=True)

"""Options that `hockey match` and `hockey tournament` share, and the one that `hockey evaluate` shares with them."""

import os
from collections.abc import Callable
from typing import Any

import rich_click as click
from click.core import ParameterSource

from airhockey.commands._isolation import ISOLATION_OPTIONS
from airhockey.evaluator.engines.workers import ONE_THREAD

cluster_option = click.option(
    "--cluster", metavar="ADDRESS|local:N", help="Play on a Dask cluster, or on N Dask workers of this machine."
)
_OPTIONS = (
    click.option(
        "--steps", type=click.IntRange(min=1), default=45000, show_default=True, help="Control steps of a game."
    ),
    click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of everything."),
    click.option("--jobs", type=click.IntRange(min=1), help="Games played at once.  [default: one per CPU]"),
    cluster_option,
    click.option(
        "--disturbances",
        metavar="NAME|PATH",
        default="ideal",
        show_default=True,
        help="Profile ideal, server or harsh, or a YAML file.",
    ),
    click.option(
        "--clock",
        type=click.Choice(["cpu", "wall"]),
        default="cpu",
        show_default=True,
        help="What the 20 ms of draw_action are measured with; cpu does not mind a busy machine.",
    ),
    click.option(
        "--variant",
        type=click.Choice(["package", "thesis"]),
        default="package",
        show_default=True,
        help="Beyond the penalty limit a player cannot win (package), or loses (thesis).",
    ),
    *ISOLATION_OPTIONS,
    click.option("--out", metavar="FOLDER", help="Where everything is stored.  [default: a new folder under runs/]"),
    click.option("--resume", is_flag=True, help="Continue what is in --out; its options need not be repeated."),
    click.option("--json", "as_json", is_flag=True, help="Print the result as one JSON object, and nothing else."),
    click.option("--quiet", is_flag=True, help="No progress, only the result."),
)


def game_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the shared options to a command."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def typed_options(ctx: click.RichContext, given: dict[str, Any]) -> set[str]:
    """Names of the options that the user typed.

    To be called before NumPy is imported: what is played in this process is to be single-threaded.
    """
    os.environ.update(ONE_THREAD)
    return {name for name in given if ctx.get_parameter_source(name) is ParameterSource.COMMANDLINE}

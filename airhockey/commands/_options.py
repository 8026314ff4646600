"""Options that several commands have, each declared once, and what is known once they are read."""

import os
import secrets
from collections.abc import Callable
from typing import Any

import rich_click as click
from click.core import ParameterSource

from airhockey.evaluator.engines.workers import ONE_THREAD

Command = Callable[..., Any]
Option = Callable[[Command], Command]

robot = click.option(
    "--robot", type=click.Choice(["7dof", "3dof"]), default="7dof", show_default=True, help="Who plays it."
)
env = click.option(
    "--env", metavar="NAME", help="Task and robot in one name, as in 7dof-prepare; in the edition of 2025 hit_single."
)
edition = click.option(
    "--edition",
    type=click.Choice(["2023", "2025"]),
    help="The year whose rules apply.  [default: what --env or the submission was made for, else 2023]",
)


class Seed(click.ParamType):  # type: ignore[type-arg,unused-ignore]  # generic since click 8.4
    """A natural number, or "random" for one of 128 bits that nobody can guess."""

    name = "seed"

    def convert(self, value: Any, param: Any, ctx: Any) -> int:
        """The number."""
        if value == "random":
            return secrets.randbits(128)
        return int(click.IntRange(min=0).convert(value, param, ctx))


seed = click.option(
    "--seed",
    type=Seed(),
    default=0,
    show_default=True,
    metavar="N|random",
    help="Seed of everything; a random one is kept in the run's manifest.",
)
agent_seed = click.option(
    "--agent-seed",
    metavar="HEX",
    help="Seed of what agents draw at random themselves.  [default: a secret where submissions play, kept in the manifest]",
)
jobs = click.option("--jobs", type=click.IntRange(min=1), help="Processes that play.  [default: one per CPU]")
cluster = click.option(
    "--cluster", metavar="ADDRESS|local:N", help="Play on a Dask cluster, or on N Dask workers of this machine."
)
disturbances = click.option(
    "--disturbances",
    metavar="NAME|PATH",
    default="ideal",
    show_default=True,
    help="Profile ideal, server or harsh, or a YAML file.",
)
game_steps = click.option(
    "--steps", type=click.IntRange(min=1), default=45000, show_default=True, help="Control steps of a game."
)
clock = click.option(
    "--clock",
    type=click.Choice(["cpu", "wall"]),
    default="cpu",
    show_default=True,
    help="What the time of draw_action is measured with; cpu does not mind a busy machine.",
)
isolate = click.option(
    "--isolate",
    type=click.Choice(["none", "process", "sandbox"]),
    help="Where an agent lives: here, in a process of its own, or in a sandbox without network and files."
    "  [default: none for our own agents, sandbox for submissions]",
)
patience = click.option(
    "--patience",
    type=click.FloatRange(min=0.0, min_open=True),
    default=60.0,
    show_default=True,
    metavar="SECONDS",
    help="How long to wait for an isolated or remote agent before it is stopped.",
)
real_time = click.option(
    "--real-time",
    type=click.FloatRange(min=0.0),
    is_flag=False,
    flag_value=1.0,
    metavar="[FACTOR]",
    help="Pace the steps: 1 as the robot, 2 twice as fast, 0 as fast as possible."
    "  [default: 1 for submissions that think in threads or processes beside their steps, else 0]",
)
python = click.option(
    "--python",
    metavar="PATH",
    help="Another interpreter for a submission's process: Python 3.8 to 3.14 with NumPy and what the agent needs.",
)
settings = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="PART.NAME=VALUE",
    help="Change a parameter of our players, as in control.solver=osqp or thesis.defend.predict=false.",
)
pythons = click.option(
    "--python",
    multiple=True,
    metavar="[PLAYER:]PATH",
    help="Another interpreter for the processes of all submissions, or of one player, as in home:PATH; in a tournament its name.",
)
player_settings = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="[PLAYER:]PART.NAME=VALUE",
    help="Change a parameter of our players, or of one, as in away:control.solver=osqp or home:thesis.parameters=thesis.",
)
trajectories = click.option(
    "--trajectories",
    type=click.Choice(["full", "actions", "none"]),
    default="full",
    show_default=True,
    help="What is kept of every step: all of it; the actions alone, from which the rest is computed again when it is read "
    "(a seventh of the size); or nothing but computation times.",
)
out = click.option("--out", metavar="FOLDER", help="Run folder.  [default: a new one under runs/]")
resume = click.option("--resume", is_flag=True, help="Continue the run in --out; its options need not be repeated.")
as_json = click.option("--json", "as_json", is_flag=True, help="Print the result as one JSON object, and nothing else.")
quiet = click.option("--quiet", is_flag=True, help="No progress, only the result.")
only_notes = click.option("--quiet", is_flag=True, help="Only say what is missing.")
host = click.option(
    "--host",
    default="127.0.0.1",
    show_default=True,
    help="Address to listen on; the page's address holds a token.",
)
port = click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=0,
    help="Port to listen on.  [default: the first free one from 8080]",
)
no_browser = click.option("--no-browser", is_flag=True, help="Only print the address.")
window = click.option("--window", is_flag=True, help="In a window of its own instead of the browser.")
variant = click.option(
    "--variant",
    type=click.Choice(["package", "thesis"]),
    default="package",
    show_default=True,
    help="Beyond the penalty limit a player cannot win (package), or loses (thesis).",
)

ISOLATION = (isolate, patience)
PLAY = (*ISOLATION, real_time)
VIEWER = (host, port, no_browser, window)
RUN = (out, resume, quiet)
GAMES = (
    edition,
    game_steps,
    seed,
    agent_seed,
    jobs,
    cluster,
    disturbances,
    clock,
    variant,
    *PLAY,
    pythons,
    player_settings,
    *RUN,
    as_json,
)


def options(*added: Option) -> Option:
    """A decorator that adds options to a command, in this order."""

    def add(command: Command) -> Command:
        for option in reversed(added):
            command = option(command)
        return command

    return add


def typed_options(ctx: click.RichContext, given: dict[str, Any]) -> set[str]:
    """Names of the options that the user typed.

    To be called before NumPy is imported: what is played in this process is to be single-threaded.
    """
    os.environ.update(ONE_THREAD)
    if given.get("resume") and given["out"] is None:
        raise click.UsageError("--resume needs the run's folder: --out FOLDER")
    return {name for name in given if ctx.get_parameter_source(name) is ParameterSource.COMMANDLINE}

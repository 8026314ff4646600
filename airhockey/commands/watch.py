"""`hockey watch`: a live task or game in the browser."""

from typing import Any

import rich_click as click

from airhockey.commands._isolation import isolation_options
from airhockey.commands._watching import run_watch, viewer_options


@click.command()
@click.argument("agent", metavar="A")
@click.argument("away", metavar="[B]", required=False)
@click.option(
    "--task",
    type=click.Choice(["hit", "defend", "prepare"]),
    default="hit",
    show_default=True,
    help="What A plays alone.",
)
@click.option("--robot", type=click.Choice(["7dof", "3dof"]), default="7dof", show_default=True, help="Who plays it.")
@click.option("--env", metavar="NAME", help="Task and robot in one name, as in 7dof-prepare.")
@click.option("--steps", type=click.IntRange(min=1), default=45000, show_default=True, help="Control steps of a game.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of everything.")
@click.option(
    "--episode", type=click.IntRange(min=0), default=0, show_default=True, help="Episode or game to begin with."
)
@click.option(
    "--disturbances",
    metavar="NAME|PATH",
    default="ideal",
    show_default=True,
    help="Profile ideal, server or harsh, or a file.",
)
@isolation_options
@viewer_options
@click.pass_context
def watch(ctx: click.RichContext, /, **given: Any) -> None:
    """Watch A at a task, or A play B, live in MuJoCo's viewer in the browser.

    Episodes are those of `hockey evaluate` and games those of `hockey match` with the same options. The panel shows score,
    faults, penalty and what the players are doing; the orange line is where the puck will go, discs are where the players
    want their mallets. Buttons and keys: space pauses, . steps, + and - change the speed, r restarts, n and p choose the
    episode; q in the terminal quits.

    \b
    hockey watch planner --task hit
    hockey watch planner thesis
    hockey watch submissions/my_agent --env 7dof-prepare --disturbances server --episode 12
    hockey watch planner --no-browser --port 9000        then: ssh -L 9000:127.0.0.1:9000 …
    """
    ctx.exit(run_watch(given))

"""`hockey replay`: recorded episodes and games in the browser."""

from pathlib import Path
from typing import Any

import rich_click as click

from airhockey.commands._watching import run_replay, viewer_options


@click.command()
@click.argument("run", metavar="RUN", type=click.Path(path_type=Path))
@click.option("--episode", metavar="K", help="Episode or game to begin with.  [default: the first]")
@viewer_options
@click.pass_context
def replay(ctx: click.RichContext, /, **given: Any) -> None:
    """Replay RUN in MuJoCo's viewer: the folder of a run, match or tournament, or an official dataset.pkl.

    Nothing is simulated: everything stands where the recording has it. Buttons and keys: space pauses, . and , step forth
    and back, + and - change the speed, r restarts, n and p choose the episode, the slider goes anywhere; q in the terminal
    quits.

    \b
    hockey replay runs/7dof-prepare-planner-s0 --episode 17
    hockey replay runs/match-planner-thesis-s0
    hockey replay runs/tournament-s0 --episode 1/alpha-beta
    hockey replay official/7dof-hit/dataset.pkl
    """
    ctx.exit(run_replay(given))

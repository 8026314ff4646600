"""`hockey replay`: recorded episodes and games in the browser."""

from pathlib import Path
from typing import Any

import rich_click as click

from airhockey.commands import _options as common


@click.command()
@click.argument("run", metavar="RUN", type=click.Path(path_type=Path))
@click.option("--episode", metavar="K", help="Episode or game to begin with.  [default: the first]")
@click.option("--failed", is_flag=True, help="Only episodes that went wrong.")
@common.options(*common.VIEWER)
def replay(**given: Any) -> None:
    """Replay RUN in MuJoCo's viewer: the folder of a run, match or tournament, or an official dataset.pkl.

    Nothing is simulated: everything stands where the recording has it. Buttons and keys: space pauses, . and , step forth
    and back, + and - change the speed, r restarts, n and p choose the episode, the slider goes anywhere; q in the terminal
    quits.

    \b
    hockey replay runs/7dof-prepare-planner-s0 --episode 17
    hockey replay runs/7dof-prepare-planner-s0 --failed
    hockey replay runs/match-planner-thesis-s0
    hockey replay runs/tournament-s0 --episode 1/alpha-beta
    hockey replay official/7dof-hit/dataset.pkl
    """
    from airhockey.commands._session import MOST_NOTES, say_notes
    from airhockey.commands._viewer import show_in_viewer
    from airhockey.viewing.library import open_library
    from airhockey.viewing.playback import RecordedPlayback

    library = open_library(given["run"])
    library.entries = library.choose(None, given["failed"])
    first = library.position(given["episode"]) if given["episode"] is not None else 0
    say_notes(library.notes, MOST_NOTES)
    show_in_viewer(RecordedPlayback(library.entries, first), given)

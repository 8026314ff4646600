"""How games are going, on the standard error: a line per game in progress on a terminal, now and then a line elsewhere."""

import contextlib
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from airhockey.evaluator.play.watchdog import live_games
from airhockey.evaluator.runs.game_records import GameRecord, Status

STARTING = "starting; the first time on a machine, the simulator is compiled"
CONTROL_PERIOD = 0.02  # [s]
_LOOK = 0.5  # [s] between two looks at the games
_SILENCE = 30.0  # [s] without a line, where there is no terminal ...
_TENTHS = 10  # ... or a tenth of a single game


@dataclass
class Progress:
    """How far all games together are.

    Attributes:
        games: How many there are.
        before: How many were played before this process came.
        played: How many are played now.
    """

    games: int
    before: int
    played: int
    began: float

    @property
    def line(self) -> str:
        """Games played, and how long the others will take at this rate."""
        new, seconds = self.played - self.before, time.monotonic() - self.began
        left = f", about {_duration(seconds / new * (self.games - self.played))} left" if new else ""
        return f"{self.played}/{self.games} games, {_duration(seconds)}{left}"


@dataclass
class View:
    """What the user sees of the games.

    Attributes:
        console: To print what shall stay; quiet where nothing is shown.
    """

    console: Console
    progress: Progress

    def add(self, record: GameRecord) -> None:
        """Show a game that has ended."""
        self.progress.played += 1
        self.console.print(result_line(record, self.progress), markup=False, soft_wrap=True)


@contextlib.contextmanager
def of_games(folder: Path, games: int, played: int, quiet: bool) -> Iterator[View]:
    """Show how games go while the block runs.

    Args:
        folder: Where games in progress are shown (`watch.live_games`).
        games: How many there are.
        played: How many are played already.
        quiet: Show nothing.
    """
    console = Console(stderr=True, highlight=False, quiet=quiet)
    progress = Progress(games, played, played, time.monotonic())
    if quiet:
        yield View(console, progress)
        return
    if console.is_terminal:
        with Live(get_renderable=lambda: _shown(live_games(folder), progress), console=console, transient=True):
            yield View(console, progress)
        return
    console.print(STARTING, soft_wrap=True)
    over = threading.Event()
    thread = threading.Thread(target=_tell, args=(console, folder, progress, over), daemon=True)
    thread.start()
    try:
        yield View(console, progress)
    finally:
        over.set()
        thread.join()


def result_line(record: GameRecord, progress: Progress) -> str:
    """One line about a game that has ended."""
    home, away = record.score
    outcome = "draw" if record.winner == "draw" else f"{getattr(record.job, record.winner)} wins"
    forfeit = ", by forfeit" if record.home.failure or record.away.failure else ""
    return f"{progress.line}: {record.job.home} {home} : {away} {record.job.away}, {outcome}{forfeit}"


def describe(status: Status) -> str:
    """One line about a game in progress."""
    minutes, seconds = divmod(int(status.step * CONTROL_PERIOD), 60)
    return (
        f"{status.home} - {status.away}  {minutes:2d}:{seconds:02d}  score {status.score[0]}:{status.score[1]}  "
        f"faults {status.faults[0]}:{status.faults[1]}  penalty {status.penalty[0]:g}:{status.penalty[1]:g}  "
        f"puck at {getattr(status, status.side)} ({status.side})  {status.rate:.0f} steps/s"
    )


def _shown(games: list[Status], progress: Progress) -> Group:
    """What stands on the terminal now."""
    table = Table(box=None, pad_edge=False)
    for name in ("", "time", "score", "faults", "penalty", "puck", "steps/s", ""):
        table.add_column(name, justify="left" if name in ("", "puck") else "right", no_wrap=True)
    for status in games:
        minutes, seconds = divmod(int(status.step * CONTROL_PERIOD), 60)
        table.add_row(
            Text(f"{status.home} - {status.away}"),
            f"{minutes}:{seconds:02d}",
            *(f"{home:g}:{away:g}" for home, away in (status.score, status.faults, status.penalty)),
            Text(f"{getattr(status, status.side)} ({status.side})"),
            f"{status.rate:.0f}",
            f"{status.step / status.steps:.0%}",
        )
    return Group(*([table] if games else [STARTING]), Text(progress.line))


def _tell(console: Console, folder: Path, progress: Progress, over: threading.Event) -> None:
    """Where there is no terminal: a line for every tenth of a game, if there is only one, and after a silence anyway."""
    said, tenth = time.monotonic(), 0
    while not over.wait(_LOOK):
        games = live_games(folder)
        reached = _TENTHS * games[0].step // games[0].steps if len(games) == progress.games == 1 else tenth
        if games and (reached != tenth or time.monotonic() - said > _SILENCE):
            said, tenth = time.monotonic(), reached
            for status in games:
                console.print(describe(status), markup=False, soft_wrap=True)


def _duration(seconds: float) -> str:
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{seconds:02d}" if hours else f"{minutes}:{seconds:02d}"

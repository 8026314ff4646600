"""How far a run is, on the standard error: a bar on a terminal, now and then a line elsewhere."""

import contextlib
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn, TimeRemainingColumn
from rich.text import Text

from airhockey.evaluator.runs.records import EpisodeRecord, Options

OnEpisode = Callable[[EpisodeRecord], None]
STARTING = "starting; the first time on a machine, the simulator is compiled"
LINES = 10  # per task, where there is no terminal ...
SILENCE = 30.0  # [s] ... and one after this long anyway


@dataclass
class Tally:
    """Counts of one task."""

    played: int = 0
    succeeded: int = 0
    failed: int = 0

    def add(self, record: EpisodeRecord) -> None:
        """Count an episode."""
        self.played += 1
        self.succeeded += record.success
        self.failed += record.error is not None

    def __str__(self) -> str:
        if self.played == 0:
            return STARTING
        failures = f", agent failed {self.failed}" if self.failed else ""
        return f"success {self.succeeded / self.played:.1%}{failures}"


@contextlib.contextmanager
def progress(options: Options, finished: Iterable[EpisodeRecord], quiet: bool) -> Iterator[OnEpisode | None]:
    """Show how far a run is while the block runs; call what it gives with every record.

    Args:
        options: The run's.
        finished: The records that there are already.
        quiet: Show nothing.
    """
    if quiet:
        yield None
        return
    tallies = {env: Tally() for env in options.environments}
    for record in finished:
        tallies[record.env].add(record)
    console = Console(stderr=True)
    if console.is_terminal:
        with _bar(console) as bar:
            yield _on_bar(bar, tallies, options.episodes)
    else:
        console.print(STARTING, highlight=False, soft_wrap=True)
        yield _in_lines(console, tallies, options.episodes)


class _Rate(ProgressColumn):
    """Episodes per second."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:.1f}/s")


def _bar(console: Console) -> Progress:
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        _Rate(),
        TimeRemainingColumn(),
        TextColumn("{task.fields[tally]}"),
        console=console,
    )


def _on_bar(bar: Progress, tallies: dict[str, Tally], episodes: int) -> OnEpisode:
    tasks = {
        env: bar.add_task(env, total=episodes, completed=tally.played, tally=tally, start=False)
        for env, tally in tallies.items()
    }
    started = set()

    def on_episode(record: EpisodeRecord) -> None:
        tallies[record.env].add(record)
        if record.env not in started:
            started.add(record.env)
            bar.start_task(tasks[record.env])
        bar.advance(tasks[record.env])

    return on_episode


def _in_lines(console: Console, tallies: dict[str, Tally], episodes: int) -> OnEpisode:
    began: dict[str, tuple[float, int]] = {}
    said = {env: (time.monotonic(), 0) for env in tallies}

    def on_episode(record: EpisodeRecord) -> None:
        tally, now = tallies[record.env], time.monotonic()
        since, before = began.setdefault(record.env, (now, tally.played))
        tally.add(record)
        last, tenths = said[record.env]
        if tally.played * LINES // episodes == tenths and now - last < SILENCE:
            return
        said[record.env] = now, tally.played * LINES // episodes
        rate = (tally.played - before - 1) / max(now - since, 1e-9)  # the clock starts as the first one ends
        left = f"{(episodes - tally.played) / rate:.0f} s left" if rate else "…"
        line = f"{record.env} {tally.played}/{episodes}  {rate:.1f}/s  {left}  {tally}"
        console.print(line, highlight=False, soft_wrap=True)

    return on_episode

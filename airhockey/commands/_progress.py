"""How far a run is, on the standard error: a bar on a terminal, now and then a line elsewhere."""

import contextlib
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Protocol

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn, TimeRemainingColumn
from rich.text import Text

from airhockey.evaluator.runs.records import EpisodeRecord, Options

OnEpisode = Callable[[EpisodeRecord], None]
STARTING = "starting; the first time on a machine, the simulator is compiled"
LINES = 10  # per task, where there is no terminal ...
SILENCE = 30.0  # [s] ... and one after this long anyway


class Tell(Protocol):
    """Says how far a training is."""

    def __call__(self, line: str | None = None, completed: int | None = None) -> None:
        """A line for the table, or how much is done."""


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
def of_episodes(options: Options, finished: Iterable[EpisodeRecord], quiet: bool) -> Iterator[OnEpisode | None]:
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
        with _bar(console, _Rate(), more=TextColumn("{task.fields[tally]}")) as bar:
            yield _on_bar(bar, tallies, options.episodes)
    else:
        console.print(STARTING, highlight=False, soft_wrap=True)
        yield _in_lines(console, tallies, options.episodes)


@contextlib.contextmanager
def of_training(head: str, what: str, total: int, done: int, quiet: bool) -> Iterator[Tell]:
    """Show a table that grows and, on a terminal, a bar; call what it gives with a line, or with how much is done.

    Args:
        head: Above the table.
        what: The bar counts.
        total, done: How many there are in all, and already.
        quiet: Show nothing.
    """
    console = Console(stderr=True, quiet=quiet)
    console.print(head, highlight=False, soft_wrap=True)
    shown = console.is_terminal and not quiet
    with _bar(console) if shown else contextlib.nullcontext() as bar:
        task = bar.add_task(what, total=total, completed=done) if bar is not None else None

        def tell(line: str | None = None, completed: int | None = None) -> None:
            if line is not None:
                console.print(line, highlight=False, soft_wrap=True)
            if bar is not None and task is not None and completed is not None:
                bar.update(task, completed=min(completed, total))

        yield tell


@contextlib.contextmanager
def of_frames(quiet: bool) -> Iterator[Callable[[int, int], None] | None]:
    """Show how far a film is; call what it gives with the frames that are done, and with how many there will be."""
    if quiet:
        yield None
        return
    console = Console(stderr=True)
    if console.is_terminal:
        with _bar(console, transient=True) as bar:
            task = bar.add_task("rendering", total=None)
            yield lambda done, expected: bar.update(task, completed=done, total=expected)
        return
    said = 0

    def in_lines(done: int, expected: int) -> None:
        nonlocal said
        if LINES * done // expected > said:
            said = LINES * done // expected
            console.print(f"rendered {done}/{expected} frames", highlight=False)

    yield in_lines


@contextlib.contextmanager
def of_files(what: str, total: int, quiet: bool) -> Iterator[Callable[[], None]]:
    """Show how many episodes are written; call what it gives after each."""
    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield lambda: None
        return
    with _bar(console, transient=True) as bar:
        task = bar.add_task(what, total=total)
        yield lambda: bar.advance(task)


@contextlib.contextmanager
def of_pages(quiet: bool) -> Iterator[Callable[[str], None]]:
    """Show what is being done: in one changing line on a terminal, in lines elsewhere."""
    console = Console(stderr=True, quiet=quiet)
    if console.is_terminal and not quiet:
        with console.status("starting") as status:
            yield lambda what: status.update(escape(what))
    else:
        yield lambda what: console.print(what, markup=False, highlight=False, soft_wrap=True)


class _Rate(ProgressColumn):
    """Episodes per second."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:.1f}/s")


def _bar(
    console: Console, *columns: ProgressColumn, more: ProgressColumn | None = None, transient: bool = False
) -> Progress:
    left = [TimeRemainingColumn()] if more is None else [TimeRemainingColumn(), more]
    start = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn()
    return Progress(*start, *columns, *left, console=console, transient=transient)


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

"""How a training goes, on the standard error: a table that grows and a bar on a terminal, a line per iteration elsewhere."""

import contextlib
from collections.abc import Iterator, Sequence

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from airhockey.learning.pgpe.records import Iteration, Outcome, Settings
from airhockey.learning.pgpe.training import OnEpisode, OnIteration

_HEAD = "iteration      return   success   penalty    lambda   sigma/start   seconds"


@contextlib.contextmanager
def training_progress(
    settings: Settings, finished: Sequence[Iteration], quiet: bool
) -> Iterator[tuple[OnEpisode | None, OnIteration | None]]:
    """Show how a training goes while the block runs; call what it gives with every outcome and every iteration."""
    if quiet:
        yield None, None
        return
    console = Console(stderr=True)
    console.print(f"θ: {', '.join(settings.names)}", highlight=False, soft_wrap=True)
    console.print(_HEAD, highlight=False, soft_wrap=True)
    for one in finished:
        console.print(line(settings, one), highlight=False, soft_wrap=True)
    if not console.is_terminal:
        yield None, lambda one: console.print(line(settings, one), highlight=False, soft_wrap=True)
        return
    each = settings.candidates * settings.episodes
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console) as bar:
        task = bar.add_task("episodes", total=settings.iterations * each, completed=len(finished) * each)

        def on_episode(_: Outcome) -> None:
            bar.advance(task)

        def on_iteration(one: Iteration) -> None:
            console.print(line(settings, one), highlight=False, soft_wrap=True)

        yield on_episode, on_iteration


def line(settings: Settings, one: Iteration) -> str:
    """One iteration: σ as the range of its shares of the start."""
    shares = [now / start for now, start in zip(one.sigma, settings.sigma, strict=True)]
    return (
        f"{one.iteration + 1:>4}/{settings.iterations:<4} {one.mean_return:>10.4g} {one.mean_success:>9.1%} "
        f"{one.mean_penalty:>9.3g} {one.multiplier:>9.3g}   {min(shares):.2f} – {max(shares):.2f} {one.seconds:>9.1f}"
    )

"""What `hockey video` does once its options are read."""

import contextlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import click
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from airhockey.viewing.library import Library, open_library
from airhockey.viewing.video import FilmOptions, OnFrame, write_film
from airhockey.viewing.video_writer import check_film

INTERRUPTED = 130
_NOTES = 5


def run(given: Mapping[str, Any]) -> int:
    """Film what was chosen; gives the exit status."""
    width, height = given["size"]
    options = FilmOptions(
        width=width,
        height=height,
        fps=given["fps"],
        speed=given["speed"],
        highlights=given["highlights"],
        inset=not given["no_inset"],
        quality=given["quality"],
        seconds=given["seconds"],
        at=given["at"],
    )
    out: Path = given["out"]
    check_film(out, width, height, options.fps)
    library = open_library(given["run"])
    entries = library.choose(given["episodes"])
    say_what_is_missing(library)
    try:
        with _progress(given["quiet"]) as on_frame:
            frames = write_film(out, entries, options, on_frame)
    except KeyboardInterrupt:
        click.echo("hockey: interrupted; nothing was written", err=True)
        return INTERRUPTED
    length = "1 frame" if options.at is not None else f"{frames} frames, {frames / options.fps:.1f} s"
    click.echo(f"{out}: {length}, {out.stat().st_size / 1e6:.2f} MB")
    return 0


def say_what_is_missing(library: Library) -> None:
    """On the standard error, a line each; a long list is cut."""
    for note in library.notes[:_NOTES]:
        click.echo(f"hockey: {note}", err=True)
    if len(library.notes) > _NOTES:
        click.echo(f"hockey: … and {len(library.notes) - _NOTES} more of this kind", err=True)


@contextlib.contextmanager
def _progress(quiet: bool) -> Iterator[OnFrame | None]:
    """A bar on a terminal, a line per tenth elsewhere."""
    if quiet:
        yield None
        return
    console = Console(stderr=True)
    if console.is_terminal:
        columns = TextColumn("rendering"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
        with Progress(*columns, console=console, transient=True) as bar:
            task = bar.add_task("", total=None)
            yield lambda done, expected: bar.update(task, completed=done, total=expected)
        return
    said = 0

    def in_lines(done: int, expected: int) -> None:
        nonlocal said
        if 10 * done // expected > said:
            said = 10 * done // expected
            console.print(f"rendered {done}/{expected} frames", highlight=False)

    yield in_lines

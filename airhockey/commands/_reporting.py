"""What `hockey report` and `hockey leaderboard` do once their options are read."""

import contextlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import click
from rich.console import Console
from rich.markup import escape

from airhockey.errors import AirHockeyError, ConfigurationError
from airhockey.evaluator.runs.disk import replace_file
from airhockey.reporting import words
from airhockey.reporting.document import report
from airhockey.reporting.leaderboard import write_site


def make_report(given: Mapping[str, Any]) -> int:
    """Write the page; returns the exit status."""
    out = Path(given["out"])
    if out.is_dir():
        raise ConfigurationError(f"--out {str(out)!r} is a folder; name a file, as in {str(out / 'report.html')!r}")
    with told(given["quiet"]) as say:
        page, notes = report([Path(folder) for folder in given["folders"]], say)
    content = page.encode()
    _write(out, content)
    _complain(notes)
    if not given["quiet"]:
        click.echo(f"wrote {out} ({words.file_size(len(content))})")
    return 0


def make_leaderboard(given: Mapping[str, Any]) -> int:
    """Write the site; returns the exit status."""
    folder = Path(given["folder"])
    site = Path(given["out"]) if given["out"] else folder / "leaderboard"
    with told(given["quiet"]) as say:
        pages, notes = write_site(folder, site, say)
    _complain(notes)
    if not given["quiet"]:
        click.echo(f"wrote {words.count(pages, 'page')}; open {site / 'index.html'}")
    return 0


@contextlib.contextmanager
def told(quiet: bool) -> Iterator[Callable[[str], None]]:
    """Shows what is being done: in one changing line on a terminal, in lines elsewhere."""
    console = Console(stderr=True)
    if quiet:
        yield lambda _: None
    elif console.is_terminal:
        with console.status("starting") as status:
            yield lambda what: status.update(escape(what))
    else:
        yield lambda what: console.print(what, markup=False, highlight=False, soft_wrap=True)


def _write(out: Path, content: bytes) -> None:
    try:
        replace_file(out, content)
    except OSError as error:
        raise AirHockeyError(f"cannot write {str(out)!r}: {error.strerror}") from error


def _complain(notes: Iterable[str]) -> None:
    for note in notes:
        click.echo(f"hockey: {' '.join(note.split())}", err=True)

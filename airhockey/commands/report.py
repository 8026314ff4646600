"""`hockey report`: what runs, matches and tournaments left behind, as a page to look at."""

from pathlib import Path
from typing import Any

import rich_click as click

from airhockey.commands import HELP_PAGE
from airhockey.commands import _options as common


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.argument("folders", metavar="RUN…", nargs=-1, required=True)
@click.option(
    "-o",
    "--out",
    metavar="FILE.html",
    default="report.html",
    show_default=True,
    help="Where the page goes; a file of that name is replaced.",
)
@common.options(common.only_notes)
def report(**given: Any) -> None:
    """Make one page of RUN…: folders of `hockey evaluate` (of a sweep, every run), `hockey match` or `hockey tournament`.

    The page needs nothing but itself: no network, no scripts. Several runs of a task are compared, with intervals and a
    test of significance, in pairs where their episodes had the same seeds. What a folder lacks is said on the page and on the
    standard error; what is there is shown. Exit status 2: there is nothing to show at all.

    For example:

    \b
    hockey report runs/7dof-prepare-planner-s0
    hockey report runs/7dof-hit-thesis-s0 runs/7dof-hit-planner-s0 -o hit.html
    hockey report runs/match-planner-thesis-s0 runs/tournament-s0 -o games.html
    """
    from airhockey.commands._progress import of_pages
    from airhockey.commands._session import say_notes
    from airhockey.errors import AirHockeyError, ConfigurationError
    from airhockey.evaluator.runs.disk import replace_file
    from airhockey.evaluator.runs.reader import parts_of
    from airhockey.reporting import words
    from airhockey.reporting.document import report

    out = Path(given["out"])
    if out.is_dir():
        raise ConfigurationError(f"--out {str(out)!r} is a folder; name a file, as in {str(out / 'report.html')!r}")
    with of_pages(given["quiet"]) as say:
        page, notes = report([part for folder in given["folders"] for part in parts_of(Path(folder))], say)
    content = page.encode()
    try:
        replace_file(out, content)
    except OSError as error:
        raise AirHockeyError(f"cannot write {str(out)!r}: {error.strerror}") from error
    say_notes(notes)
    if not given["quiet"]:
        click.echo(f"wrote {out} ({words.file_size(len(content))})")

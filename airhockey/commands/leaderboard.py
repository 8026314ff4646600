"""`hockey leaderboard`: a whole folder of results as a static site."""

from pathlib import Path
from typing import Any

import rich_click as click

from airhockey.commands import HELP_PAGE
from airhockey.commands import _options as common


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.argument("folder", metavar="DIR")
@click.option(
    "-o",
    "--out",
    metavar="SITE",
    help="Folder of the site; its pages are replaced.  [default: DIR/leaderboard]",
)
@common.options(common.only_notes)
def leaderboard(**given: Any) -> None:
    """Make a static site of everything below DIR: every run, match and tournament.

    Entries are ranked overall, by the challenge's weighted score, and in each task, within the three classes of
    deployability; each has its history and a report of every run. Videos (*.mp4) that lie in a run's folder are linked and
    copied. All links are relative: the site works from a disk as it does from a server. Open SITE/index.html.

    For example:

    \b
    hockey leaderboard runs
    hockey leaderboard runs -o public
    """
    from airhockey.commands._progress import of_pages
    from airhockey.commands._session import say_notes
    from airhockey.reporting import words
    from airhockey.reporting.leaderboard import write_site

    folder = Path(given["folder"])
    site = Path(given["out"]) if given["out"] else folder / "leaderboard"
    with of_pages(given["quiet"]) as say:
        pages, notes = write_site(folder, site, say)
    say_notes(notes)
    if not given["quiet"]:
        click.echo(f"wrote {words.count(pages, 'page')}; open {site / 'index.html'}")

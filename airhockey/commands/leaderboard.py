"""`hockey leaderboard`: a whole folder of results as a static site."""

from typing import Any

import rich_click as click

from airhockey.commands import HELP_PAGE


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.argument("folder", metavar="DIR")
@click.option(
    "-o",
    "--out",
    metavar="SITE",
    help="Folder of the site; its pages are replaced.  [default: DIR/leaderboard]",
)
@click.option("--quiet", is_flag=True, help="Only say what is missing.")
@click.pass_context
def leaderboard(ctx: click.RichContext, /, **given: Any) -> None:
    """Make a static site of everything below DIR: every run, match and tournament.

    Entries are ranked overall, by the challenge's weighted score, and in each task, within the three classes of
    deployability; each has its history and a report of every run. Videos (*.mp4) that lie in a run's folder are linked and
    copied. All links are relative: the site works from a disk as it does from a server. Open SITE/index.html.

    For example:

    \b
    hockey leaderboard runs
    hockey leaderboard runs -o public
    """
    from airhockey.commands._reporting import make_leaderboard

    ctx.exit(make_leaderboard(given))

"""`hockey report`: what runs, matches and tournaments left behind, as a page to look at."""

from typing import Any

import rich_click as click

from airhockey.commands import HELP_PAGE


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
@click.option("--quiet", is_flag=True, help="Only say what is missing.")
@click.pass_context
def report(ctx: click.RichContext, /, **given: Any) -> None:
    """Make one page of RUN…: folders of `hockey evaluate`, `hockey match` or `hockey tournament`.

    The page needs nothing but itself: no network, no scripts. Several runs of a task are compared, with intervals and a
    test of significance, in pairs where their episodes had the same seeds. What a folder lacks is said on the page and on the
    standard error; what is there is shown. Exit status 2: there is nothing to show at all.

    For example:

    \b
    hockey report runs/7dof-prepare-planner-s0
    hockey report runs/7dof-hit-thesis-s0 runs/7dof-hit-planner-s0 -o hit.html
    hockey report runs/match-planner-thesis-s0 runs/tournament-s0 -o games.html
    """
    from airhockey.commands._reporting import make_report

    ctx.exit(make_report(given))

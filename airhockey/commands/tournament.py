"""`hockey tournament`: everybody against everybody, at home and away."""

import os
from typing import Any

import rich_click as click

from airhockey.commands._options import game_options


@click.command()
@click.argument("entries", metavar="[NAME=]AGENT…", nargs=-1)
@click.option("--entries-file", metavar="FILE", help="A YAML file with a list of entries (name, agent, second_agent).")
@click.option("--phases", type=click.IntRange(1, 2), default=1, show_default=True, help="Double round robins.")
@click.option("--replace", metavar="NAME=AGENT", multiple=True, help="Another agent for an entry in phase 2.")
@click.option("--show", is_flag=True, help="Show the standings of the tournament in --out without playing.")
@game_options
@click.pass_context
def tournament(ctx: click.RichContext, /, **given: Any) -> None:
    """Play a tournament: a double round robin of whole games, with standings and ratings after each.

    3 points for a win, 1 for a draw; ties are broken by goal difference, goals, head to head, penalty. A tournament that
    was stopped goes on with --resume; entries named then are added to it, and only the missing games are played.

    \b
    hockey tournament thesis baseline hold --steps 5000
    hockey tournament alpha=submissions/alpha beta=submissions/beta --phases 2 --replace beta=submissions/beta2
    hockey tournament --resume --out runs/tournament-s0 thesis
    hockey tournament --show --out runs/tournament-s0
    """
    from airhockey.evaluator.workers import ONE_THREAD

    os.environ.update(ONE_THREAD)
    from airhockey.commands._tournament import run

    ctx.exit(run(given))

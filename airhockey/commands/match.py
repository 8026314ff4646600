"""`hockey match`: games of one pair of players."""

from typing import Any

import rich_click as click

from airhockey.commands._options import game_options, typed_options


@click.command()
@click.argument("home", metavar="A", required=False)
@click.argument("away", metavar="B", required=False)
@click.option("--games", type=click.IntRange(min=1), default=1, show_default=True, help="How many games.")
@click.option("--swap-sides", is_flag=True, help="Home and away: play every second game with the sides exchanged.")
@game_options
@click.pass_context
def match(ctx: click.RichContext, /, **given: Any) -> None:
    """Let A (home, on the left) play B: whole games under the rules of the challenge's tournament.

    A and B are names of `hockey agents` or folders of submissions. A game is 45,000 steps: 15 minutes of play. Its course
    depends on the seed, not on --jobs. A match that was stopped goes on with --resume. Exit status 3: a player failed a
    game; the reason is shown and stored.

    \b
    hockey match thesis hold
    hockey match planner thesis --games 10 --swap-sides --disturbances server
    hockey match thesis submissions/my_agent --steps 3000 --json
    hockey match --resume --out runs/match-planner-thesis-s0
    """
    typed = typed_options(ctx, given)
    if given["resume"] and given["out"] is None:
        raise click.UsageError("--resume needs the match's folder: --out FOLDER")
    if not given["resume"] and given["away"] is None:
        raise click.UsageError("a match takes two players: hockey match A B")
    from airhockey.commands._match import run

    ctx.exit(run(given, typed))

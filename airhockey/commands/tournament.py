"""`hockey tournament`: everybody against everybody, at home and away."""

from typing import Any

import rich_click as click

from airhockey.commands._options import game_options, typed_options


@click.command()
@click.argument("entries", metavar="[NAME=]AGENT…", nargs=-1)
@click.option("--entries-file", metavar="FILE", help="A YAML file with a list of entries (name, agent, second_agent).")
@click.option("--phases", type=click.IntRange(1, 2), default=1, show_default=True, help="Double round robins.")
@click.option("--replace", metavar="NAME=AGENT", multiple=True, help="Another agent for an entry in phase 2.")
@click.option("--show", is_flag=True, help="Show the standings of the tournament in --out without playing.")
@click.option("--csv", "as_csv", is_flag=True, help="Print the standings as comma-separated values, and nothing else.")
@game_options
@click.pass_context
def tournament(ctx: click.RichContext, /, **given: Any) -> None:
    """Play a tournament: a double round robin of whole games, with standings and ratings after each.

    3 points for a win, 1 for a draw; ties are broken by the score: difference, then points; by the games among those tied,
    fewer penalty points, name. With --resume a tournament that was stopped goes on, and one that is finished can be
    extended: by entries, or by --phases 2 with or without --replace. Only the missing games are played. Exit status 3: an
    entry failed games, and so lost them.

    \b
    hockey tournament thesis baseline hold --steps 5000
    hockey tournament alpha=submissions/alpha beta=submissions/beta
    hockey tournament --resume --out runs/tournament-s0 --phases 2 --replace beta=submissions/beta2
    hockey tournament --resume --out runs/tournament-s0 thesis
    hockey tournament --show --out runs/tournament-s0
    """
    typed = typed_options(ctx, given)
    for flag in ("resume", "show"):
        if given[flag] and given["out"] is None:
            raise click.UsageError(f"--{flag} needs the tournament's folder: --out FOLDER")
    if given["as_json"] and given["as_csv"]:
        raise click.UsageError("--json or --csv, not both")
    from airhockey.commands._tournament import run

    ctx.exit(run(given, typed))

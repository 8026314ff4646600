"""`hockey match`: games of one pair of players."""

from pathlib import Path
from typing import Any

import rich_click as click

from airhockey.commands import _options as common


@click.command()
@click.argument("home", metavar="A", required=False)
@click.argument("away", metavar="B", required=False)
@click.option("--games", type=click.IntRange(min=1), default=1, show_default=True, help="How many games.")
@click.option("--swap-sides", is_flag=True, help="Home and away: play every second game with the sides exchanged.")
@common.options(*common.GAMES)
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
    hockey match planner planner --set away:control.solver=osqp --games 4 --swap-sides
    hockey match --resume --out runs/match-planner-thesis-s0
    """
    typed = common.typed_options(ctx, given)
    if not given["resume"] and given["away"] is None:
        raise click.UsageError("a match takes two players: hockey match A B")
    from airhockey.commands import _live, _tables
    from airhockey.commands._players import pythons_of, settings_of
    from airhockey.commands._session import AGENT_FAILED, Session, agent_of, game_options_of
    from airhockey.evaluator.match import MatchOptions, MatchResult, begin_match, play_match, resume_match

    session = Session("match", given, typed)
    home, away = (agent_of(given[side] or "") for side in ("home", "away"))
    own = {name: given[name] for name in ("games", "seed", "swap_sides")}
    players = {} if given["away"] is None else {"home": home, "away": away}
    pythons, settings = pythons_of(given, players), settings_of(given, players)
    options = MatchOptions(
        home=home,
        away=away,
        python=(pythons.get("home"), pythons.get("away")),
        settings=(settings.get("home", ()), settings.get("away", ())),
        game=game_options_of(given, {home: pythons.get("home"), away: pythons.get("away")}),
        **own,
    )
    engine = session.engine(given["games"], isolated=True)
    name = f"match-{Path(home).name}-{Path(away).name}-s{options.seed}"
    folder = session.open(options, name, begin_match, resume_match, (home, away))
    games = folder.manifest.options.games

    def show(result: MatchResult) -> int:
        session.print(folder, result, lambda: _tables.print_match(result, folder))
        return AGENT_FAILED if any(any(game.failures) for game in result.games) else 0

    progress = _live.of_games(folder.live, games, len(folder.records), session.quiet)
    ctx.exit(session.run(folder, f"{games} games", progress, lambda view: play_match(folder, engine, view.add), show))

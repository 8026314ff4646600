"""A match: its games together, then each of them."""

from collections.abc import Sequence

from airhockey.evaluator.runs.reader import Match, short_name
from airhockey.reporting import words
from airhockey.reporting.blocks import Row, paragraphs, section, table
from airhockey.reporting.markup import Child, Markup, element, joined
from airhockey.reporting.sections.games import (
    PlayedGame,
    colours,
    folded_games,
    game_block,
    game_title,
    shots_block,
)

_OPEN = 4  # games of a match that are shown unfolded


def match_section(match: Match, games: Sequence[PlayedGame], identifier: str) -> Markup:
    """All games of a match."""
    first = match.manifest.options.home if match.manifest else games[0].record.job.home
    players = _players(games, first)
    short = short_names(players)
    colour = colours(players)
    heading = "Match: " + " – ".join(short[player] for player in players)
    each: list[Child] = [
        joined(element("h3", f"Game {k}: {game_title(game, short)}"), game_block(game, short, colour))
        for k, game in enumerate(games, start=1)
    ]
    if len(games) > _OPEN:
        each = [element("h3", "Games"), *folded_games(games, short, colour)]
    return section(
        identifier,
        heading,
        paragraphs([_tally(games, players, short)], "lead"),
        _games_table(games, short) if len(games) > 1 else None,
        shots_block(games, players, short),
        *each,
    )


def matches_section(matches: Sequence[tuple[Match, Child]]) -> Markup:
    """Matches on a leaderboard, with their links."""
    rows: list[Row] = []
    for match, links in matches:
        games = [PlayedGame(record, None) for record in match.records]
        first = games[0].record.job
        home, away = (
            (match.manifest.options.home, match.manifest.options.away) if match.manifest else (first.home, first.away)
        )
        short = short_names(list({home: None, away: None}))
        won, drawn, lost = (str(value) for value in _outcomes(games, home))
        if home == away:
            won = lost = "–"
        title = f"{short[home]} – {short[away]}"
        rows.append((title, match.created[:10], str(len(games)), won, drawn, lost, match.conditions, links))
    head = ("match", "begun", "games", "won", "drawn", "lost", "disturbances", "see")
    return section("matches", "Matches", table("Matches, seen from their first player", head, rows, numbers_from=2))


def short_names(players: Sequence[str]) -> dict[str, str]:
    """Names without their folders, unless two would be the same."""
    short = {player: short_name(player) for player in players}
    return short if len(set(short.values())) == len(short) else {player: player for player in players}


def _players(games: Sequence[PlayedGame], first: str) -> list[str]:
    seen = dict.fromkeys(name for game in games for name in (game.record.job.home, game.record.job.away))
    return sorted(seen, key=lambda name: name != first)


def _outcomes(games: Sequence[PlayedGame], player: str) -> tuple[int, int, int]:
    """Games that a player won, drew and lost."""
    winners = [
        None if game.record.winner == "draw" else game.name("home" if game.record.winner == "home" else "away")
        for game in games
    ]
    won, drawn = winners.count(player), winners.count(None)
    return won, drawn, len(winners) - won - drawn


def _tally(games: Sequence[PlayedGame], players: Sequence[str], short: dict[str, str]) -> str:
    played = words.count(len(games), "game")
    if len(players) != 2:
        return f"{played} of {short[players[0]]} against itself."
    won, drawn, lost = _outcomes(games, players[0])
    return f"{short[players[0]]} won {won}, drew {drawn} and lost {lost} of {played} against {short[players[1]]}."


def _games_table(games: Sequence[PlayedGame], short: dict[str, str]) -> Markup:
    rows: list[Row] = []
    for k, game in enumerate(games, start=1):
        record = game.record
        winner = {"home": record.job.home, "away": record.job.away}.get(record.winner)
        rows.append(
            (
                str(k),
                short[record.job.home],
                short[record.job.away],
                f"{record.score[0]} : {record.score[1]}",
                "draw" if winner is None else short[winner],
                f"{record.home.faults} : {record.away.faults}",
                f"{record.home.penalty:g} : {record.away.penalty:g}",
                f"{record.steps:,}",
                str(record.job.seed),
            )
        )
    head = ("game", "home", "away", "score", "winner", "faults", "penalty", "steps", "seed")
    return table("Games", head, rows, numbers_from=3)

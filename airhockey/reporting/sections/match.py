"""A match, or a tournament: the games together, then each of them."""

from collections.abc import Sequence

from airhockey.evaluator.games.records import GameRecord
from airhockey.evaluator.games.schedule import schedule
from airhockey.evaluator.games.standings import Standings, standings
from airhockey.reporting import words
from airhockey.reporting.blocks import Row, figure, figures, paragraphs, section, table
from airhockey.reporting.draw.axes import Scale
from airhockey.reporting.draw.intervals import Interval, interval_plot
from airhockey.reporting.markup import Child, Markup, element, joined
from airhockey.reporting.sections.games import (
    PlayedGame,
    colours,
    folded_games,
    game_block,
    game_title,
    shots_block,
)
from airhockey.reporting.sources import Match, Tournament, short_name

_Z = 1.959964
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


def tournament_section(tournament: Tournament, games: Sequence[PlayedGame], identifier: str) -> Markup:
    """Standings, ratings, cross table, and every game to unfold."""
    names = _entries(tournament)
    found = tournament_standings(tournament, names)
    rows = found.rows
    ranked = [row.name for row in rows]
    colour, short = colours(ranked), {name: name for name in ranked}
    return section(
        identifier,
        "Tournament: " + ", ".join(ranked[:6]) + ("…" if len(ranked) > 6 else ""),
        paragraphs([f"{found.played} of {found.games} games are played."], "lead"),
        standings_table(found),
        figures(_ratings(found, colour)),
        element("h3", "Cross table"),
        _cross_table(ranked, [game.record for game in games]),
        shots_block(games, ranked, short),
        element("h3", "Games"),
        *folded_games(games, short, colour),
    )


def tournament_standings(tournament: Tournament, names: Sequence[str]) -> Standings:
    """The standings; by the games alone where the schedule is not known."""
    jobs = [record.job for record in tournament.records]
    if tournament.manifest is not None:
        jobs = schedule(tournament.manifest.options)
    return standings(names, jobs, tournament.records)


def standings_section(tournament: Tournament, identifier: str, links: Child) -> Markup:
    """A tournament on a leaderboard."""
    found = tournament_standings(tournament, _entries(tournament))
    when = [
        tournament.created[:10],
        f"{found.played} of {found.games} games",
        f"disturbances {tournament.disturbances}",
    ]
    line = element("p", " · ".join(filter(None, when)), " · ", links, class_="note")
    return section(identifier, f"Tournament {tournament.path.name}", line, standings_table(found))


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
        rows.append((title, match.created[:10], str(len(games)), won, drawn, lost, match.disturbances, links))
    head = ("match", "begun", "games", "won", "drawn", "lost", "disturbances", "see")
    return section("matches", "Matches", table("Matches, seen from their first player", head, rows, numbers_from=2))


def standings_table(found: Standings) -> Markup:
    """Everybody, best first."""
    head = (
        "#",
        "entry",
        "points",
        "played",
        "won",
        "drawn",
        "lost",
        "goals",
        "difference",
        "penalty",
        "forfeits",
        "rating",
    )
    rows: list[Row] = [
        (
            str(row.rank),
            row.name,
            element("strong", str(row.points)),
            *(str(value) for value in (row.played, row.won, row.drawn, row.lost)),
            f"{row.goals} : {row.conceded}",
            f"{row.difference:+d}".replace("-", "−"),
            f"{row.penalty:g}",
            str(row.forfeits),
            f"{row.rating:.1f} ± {row.uncertainty:.1f}",
        )
        for row in found.rows
    ]
    return table("Standings", head, rows, numbers_from=2)


def short_names(players: Sequence[str]) -> dict[str, str]:
    """Names without their folders, unless two would be the same."""
    short = {player: short_name(player) for player in players}
    return short if len(set(short.values())) == len(short) else {player: player for player in players}


def _players(games: Sequence[PlayedGame], first: str) -> list[str]:
    seen = dict.fromkeys(name for game in games for name in (game.record.job.home, game.record.job.away))
    return sorted(seen, key=lambda name: name != first)


def _entries(tournament: Tournament) -> list[str]:
    if tournament.manifest is not None:
        return [entry.name for entry in tournament.manifest.options.entries]
    return list(dict.fromkeys(name for record in tournament.records for name in (record.job.home, record.job.away)))


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


def _ratings(found: Standings, colour: dict[str, str]) -> Markup:
    rows = [
        Interval(
            row.name,
            f"{row.rating:.1f}",
            row.rating - _Z * row.uncertainty,
            row.rating,
            row.rating + _Z * row.uncertainty,
            colour[row.name],
        )
        for row in sorted(found.rows, key=lambda row: -row.rating)
    ]
    low, high = min(row.low for row in rows), max(row.high for row in rows)
    title = "Ratings: " + "; ".join(f"{row.label} {row.value}" for row in rows)
    drawing = interval_plot(rows, Scale(5.0 * (low // 5.0), -5.0 * (-high // 5.0)), "openskill rating", title)
    return figure("Ratings with 95 % intervals", drawing)


def _cross_table(names: Sequence[str], records: Sequence[GameRecord]) -> Markup:
    """Rows play at home, columns away; a cell holds the scores of every phase."""
    scores: dict[tuple[str, str], list[str]] = {}
    for record in sorted(records, key=lambda record: record.job.key):
        forfeit = " (forfeit)" if record.home.failure or record.away.failure else ""
        scores.setdefault((record.job.home, record.job.away), []).append(
            f"{record.score[0]} : {record.score[1]}{forfeit}"
        )
    rows = [
        (home, *("·" if home == away else ", ".join(scores.get((home, away), ["–"])) for away in names))
        for home in names
    ]
    return table("Scores: rows at home, columns away", ("home \\ away", *names), rows)

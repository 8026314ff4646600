"""A tournament: standings, ratings, cross table, and its games."""

from collections.abc import Sequence

from airhockey.evaluator.judging.standings import Standings, standings
from airhockey.evaluator.runs.game_records import GameRecord
from airhockey.evaluator.runs.reader import Tournament
from airhockey.evaluator.schedule import schedule
from airhockey.reporting.blocks import Row, figure, figures, paragraphs, section, table
from airhockey.reporting.draw.axes import Scale
from airhockey.reporting.draw.intervals import Interval, interval_plot
from airhockey.reporting.markup import Child, Markup, element
from airhockey.reporting.sections.games import PlayedGame, colours, folded_games, shots_block

_Z = 1.959964


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


def standings_section(tournament: Tournament, identifier: str, links: Child) -> Markup:
    """A tournament on a leaderboard."""
    found = tournament_standings(tournament, _entries(tournament))
    when = [
        tournament.created[:10],
        f"{found.played} of {found.games} games",
        f"disturbances {tournament.conditions}",
    ]
    line = element("p", " · ".join(filter(None, when)), " · ", links, class_="note")
    return section(identifier, f"Tournament {tournament.path.name}", line, standings_table(found))


def tournament_standings(tournament: Tournament, names: Sequence[str]) -> Standings:
    """The standings; by the games alone where the schedule is not known."""
    if tournament.manifest is None:
        return standings(names, [record.job for record in tournament.records], tournament.records)
    options = tournament.manifest.options
    return standings(names, schedule(options), tournament.records, options.game.edition)


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
        "score",
        "difference",
        "goals",
        "by faults",
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
            f"{row.points_for} : {row.points_against}",
            f"{row.difference:+d}".replace("-", "−"),
            f"{row.goals} : {row.conceded}",
            str(row.by_faults),
            f"{row.penalty:g}",
            str(row.forfeits),
            f"{row.rating:.1f} ± {row.uncertainty:.1f}",
        )
        for row in found.rows
    ]
    return table("Standings", head, rows, numbers_from=2)


def _entries(tournament: Tournament) -> list[str]:
    if tournament.manifest is not None:
        return [entry.name for entry in tournament.manifest.options.entries]
    return list(dict.fromkeys(name for record in tournament.records for name in (record.job.home, record.job.away)))


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

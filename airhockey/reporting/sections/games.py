"""Games: their course, the shots, who had the puck."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from airhockey.evaluator.analysis.game import GameAnalysis
from airhockey.evaluator.analysis.shots import OUTCOMES, Shot
from airhockey.evaluator.runs.game_records import AWAY, HOME, SIDES, Event, GameRecord, PlayerResult, Side
from airhockey.reporting import words
from airhockey.reporting.blocks import Row, badge, details, figure, figures, paragraphs, table, wide
from airhockey.reporting.draw.table_map import arrows, cells, density_cells, table_map
from airhockey.reporting.draw.timeline import SHOWN, timeline
from airhockey.reporting.markup import Markup, element, joined

_MOST_SHOTS = 150  # of each outcome that are drawn
_FLIGHT = 0.12  # [s] of flight that a shot's line shows
_CLASSES = {"goal": "goal", "saved": "saved", "off target": "wide-of"}


@dataclass(frozen=True)
class PlayedGame:
    """A game with its film, where there is one."""

    record: GameRecord
    film: GameAnalysis | None

    def name(self, side: Side) -> str:
        """Who played on a side."""
        return self.record.job.home if side == HOME else self.record.job.away

    def player(self, side: Side) -> PlayerResult:
        """How a side fared."""
        return self.record.home if side == HOME else self.record.away


def colours(names: Iterable[str]) -> dict[str, str]:
    """A colour per player, the same on the whole page."""
    return {name: "abcd"[k % 4] for k, name in enumerate(dict.fromkeys(names))}


def game_title(game: PlayedGame, short: dict[str, str]) -> str:
    """Who played and how it ended."""
    home, away = game.record.score
    job = game.record.job
    return f"{short.get(job.home, job.home)} {home} : {away} {short.get(job.away, job.away)}"


def game_block(game: PlayedGame, short: dict[str, str], colour: dict[str, str]) -> Markup:
    """One game: its course, its events, its figures."""
    record = game.record
    names: dict[Side, str] = {side: short.get(game.name(side), game.name(side)) for side in SIDES}
    classes: dict[Side, str] = {side: colour[game.name(side)] for side in SIDES}
    if classes[HOME] == classes[AWAY]:
        classes[AWAY] = "b" if classes[HOME] != "b" else "a"  # a player against itself
    events = [event for event in record.events if event.what in SHOWN or event.what in ("stuck", "out")]
    title = f"Course of the game {game_title(game, short)}: {words.count(len(events), 'event')}."
    at_home = game.film.at_home if game.film else None
    drawing = wide(timeline(record.events, record.steps, classes, at_home, title), "Course of the game")
    legend = [
        (classes[HOME], f"{names[HOME]} (home, left)"),
        (classes[AWAY], f"{names[AWAY]} (away, right)"),
        ("shape", "● point  ▵ fault  ◇ violation  □ forfeit"),
    ]
    return joined(
        figure("Course of the game", drawing, legend=legend, data=_events_table(events, names)),
        _figures_table(game, names),
        paragraphs(
            [f"{names[side]} failed: {game.player(side).failure}" for side in SIDES if game.player(side).failure]
        ),
    )


def shots_block(games: Sequence[PlayedGame], players: Sequence[str], short: dict[str, str]) -> Markup | None:
    """A shot map per player over all games, attacking to the right, and where the puck was; None without films."""
    filmed = [game for game in games if game.film is not None]
    if not filmed:
        return None
    maps = [_shot_map(player, short.get(player, player), shots_of(player, filmed)) for player in players]
    rows = [_shot_row(player, short.get(player, player), filmed) for player in players]
    head = ("player", "touches", "shots", "on target", "goals", "saved", "median speed", "highest", "puck on its side")
    note = (
        "A shot is a hit after which the puck crosses the middle line before anybody touches it again; it is on target "
        "if it scores, or if the opponent touched what would have slid into the goal, friction and side rims counted. All of "
        "this is read off the games' trajectories."
    )
    if any(len(shots_of(player, filmed)) > _MOST_SHOTS for player in players):
        note += f" At most {_MOST_SHOTS} shots of each outcome are drawn and listed."
    return joined(
        element("h3", "Shots and possession"),
        table("Shots by player", head, rows),
        figures(*maps, _puck_map(filmed) if len(players) == 2 else None),
        paragraphs([note], "note"),
    )


def shots_of(player: str, games: Sequence[PlayedGame]) -> list[Shot]:
    """The player's shots in all games, turned so that it plays on the left."""
    turned = []
    for game in games:
        for shot in game.film.shots if game.film else ():
            if game.name(shot.side) == player:
                turned.append(shot if shot.side == HOME else _turned(shot))
    return turned


def folded_games(games: Sequence[PlayedGame], short: dict[str, str], colour: dict[str, str]) -> list[Markup]:
    """Every game, to unfold."""
    return [
        details(f"{game.record.job.key}: {game_title(game, short)}", game_block(game, short, colour)) for game in games
    ]


def _turned(shot: Shot) -> Shot:
    (x, y), (speed_x, speed_y) = shot.start, shot.velocity
    return Shot(shot.side, shot.step, (-x, -y), (-speed_x, -speed_y), shot.outcome)


def _shot_map(player: str, name: str, shots: Sequence[Shot]) -> Markup:
    counts = {outcome: sum(shot.outcome == outcome for shot in shots) for outcome in OUTCOMES}
    title = f"{len(shots)} shots of {name}: " + ", ".join(f"{number} {outcome}" for outcome, number in counts.items())
    layers = []
    for outcome in reversed(OUTCOMES):  # goals on top
        chosen = [shot for shot in shots if shot.outcome == outcome][:_MOST_SHOTS]
        starts = np.array([shot.start for shot in chosen]).reshape(-1, 2)
        ends = starts + _FLIGHT * np.array([shot.velocity for shot in chosen]).reshape(-1, 2)
        says = [f"{words.clock(shot.step)} {shot.outcome}, {shot.speed:.2f} m/s" for shot in chosen]
        layers.append(arrows(starts, ends, _CLASSES[outcome], says))
    legend = [(_CLASSES[outcome], f"{outcome} ({number})") for outcome, number in counts.items()]
    rows = [
        (
            words.clock(shot.step),
            shot.outcome,
            f"{shot.speed:.2f}",
            f"{shot.start[0]:.2f}, {shot.start[1]:.2f}".replace("-", "−"),
        )
        for shot in shots[:_MOST_SHOTS]
    ]
    return figure(
        f"Shots of {name}",
        table_map(title, *layers, left=f"{name} →"),
        legend=legend,
        data=table(f"Shots of {name}", ("time", "outcome", "m/s", "from x, y in m"), rows, numbers_from=2),
    )


def _shot_row(player: str, name: str, games: Sequence[PlayedGame]) -> Row:
    shots = shots_of(player, games)
    speeds = [shot.speed for shot in shots]
    touches, sides, steps = 0, 0.0, 0
    for game in games:
        for k, side in enumerate(SIDES):
            if game.name(side) == player and game.film is not None:
                touches += game.film.touches[k]
                share = game.film.possession if side == HOME else 1.0 - game.film.possession
                sides, steps = sides + share * game.record.steps, steps + game.record.steps
    goals, saved = (sum(shot.outcome == outcome for shot in shots) for outcome in ("goal", "saved"))
    return (
        name,
        f"{touches:,}",
        f"{len(shots):,}",
        f"{goals + saved:,}",
        str(goals),
        str(saved),
        f"{np.median(speeds):.2f} m/s" if speeds else "–",
        f"{max(speeds):.2f} m/s" if speeds else "–",
        words.percent(sides / steps) if steps else "–",
    )


def _puck_map(games: Sequence[PlayedGame]) -> Markup:
    where = np.concatenate([game.film.puck for game in games if game.film is not None])
    title = "Where the puck was, over all games."
    legend = [("d1", "seldom"), ("d5", "sometimes"), ("d10", "often")]
    return figure(
        "Where the puck was",
        table_map(title, cells(density_cells(where, 0.04, "looks")), left="← home", right="away →"),
        legend=legend,
    )


def _events_table(events: Sequence[Event], names: dict[Side, str]) -> Markup | None:
    if not events:
        return None
    rows = [
        (
            words.clock(event.step),
            event.what,
            names[event.who] if event.who else "–",
            "–" if event.score is None else f"{event.score[0]} : {event.score[1]}",
            event.why or "",
        )
        for event in events
    ]
    return table("Events", ("time", "event", "player", "score", "why"), rows, numbers_from=9)


def _figures_table(game: PlayedGame, names: dict[Side, str]) -> Markup:
    players = [game.player(side) for side in SIDES]
    rows: list[Row] = [
        ("points", *(str(player.points) for player in players)),
        ("by goals", *(str(player.goals) for player in players)),
        ("by the opponent's faults", *(str(player.points_by_faults) for player in players)),
        ("faults", *(str(player.faults) for player in players)),
        ("penalty points", *(f"{player.penalty:g}" for player in players)),
        ("deployability", *(badge(player.deployability) for player in players)),
    ]
    for name in dict.fromkeys(name for player in players for name in player.violations):
        if any(player.violations.get(name) for player in players):
            label = f"{words.constraint(name)} violated, episodes of 500 steps"
            rows.append((label, *(str(player.violations.get(name, 0)) for player in players)))
    rows += [
        ("steps with a held command", *(str(player.held) for player in players)),
        ("mean time of draw_action", *(words.milliseconds(player.computation_time.mean) for player in players)),
        ("longest", *(words.milliseconds(player.computation_time.max) for player in players)),
    ]
    return table("Figures of the game", ("", f"{names[HOME]} (home)", f"{names[AWAY]} (away)"), rows)

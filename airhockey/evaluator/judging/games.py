"""The judge of games: penalties per 500 steps, and who wins, from what was recorded alone."""

from collections.abc import Mapping, Sequence

from airhockey.envs.editions import Edition
from airhockey.evaluator.runs.game_records import VARIANTS, PlayerResult, Variant, Winner

COMPUTATION_TIME = "computation_time"


class PenaltyCount:
    """Adds up one player's penalty points over the episodes of a game.

    Args:
        rules: The edition.
    """

    def __init__(self, rules: Edition) -> None:
        self._rules = rules
        self.points = 0.0
        self.violations = dict.fromkeys((*rules.penalty_points, COMPUTATION_TIME), 0)

    def add_episode(self, violated: Mapping[str, bool], longest: float, mean: float) -> dict[str, float]:
        """Count an episode of (at most) 500 steps: each constraint once, and the computation time in [s].

        Returns:
            What was charged: name of the constraint, or "computation_time" -> points; only those that are not 0.
        """
        points = {name: self._rules.penalty_points[name] for name, is_violated in violated.items() if is_violated}
        late = self._rules.time_penalty(longest, mean)
        if late:
            points[COMPUTATION_TIME] = late
        for name, charged in points.items():
            self.points += charged
            self.violations[name] += 1
        return points


def penalty_limit(rules: Edition, steps: int) -> float:
    """Most penalty points with which a player can win a game of so many control steps (135 for a whole game)."""
    return rules.game_penalty_per_episode * steps / rules.horizon.task


def game_class(rules: Edition, penalty: float, steps: int) -> str:
    """Deployability class of a game's penalty, at the rate of an official evaluation of 1000 episodes."""
    return rules.deployability.class_of(penalty * 1000.0 * rules.horizon.task / steps)


def winner(rules: Edition, variant: Variant, steps: int, home: PlayerResult, away: PlayerResult) -> Winner:
    """Who wins.

    A player that failed loses (both: a draw). Otherwise more points win, if the winner's penalty is within the limit. If it
    is not, the game is a draw where a player beyond the limit cannot win ("package"); where such a player loses ("thesis"),
    it loses whatever the score (both: a draw).
    """
    limit = penalty_limit(rules, steps)
    if (home.failure is None) != (away.failure is None):
        return "away" if home.failure is not None else "home"
    if home.failure is not None:
        return "draw"
    beyond = home.penalty > limit, away.penalty > limit
    if VARIANTS[variant] == "loses" and any(beyond):
        return "draw" if all(beyond) else ("away" if beyond[0] else "home")
    if home.points == away.points:
        return "draw"
    better: Winner = "home" if home.points > away.points else "away"
    return "draw" if beyond[better == "away"] else better


def tally(winners: Sequence[Winner]) -> tuple[int, int, int]:
    """Wins of home, draws, wins of away."""
    return winners.count("home"), winners.count("draw"), winners.count("away")

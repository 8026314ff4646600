"""Small real results: two runs with the same seeds, one with another, a match, a tournament."""

from pathlib import Path
from typing import NamedTuple

from airhockey.evaluator import Options, begin, evaluate
from airhockey.evaluator.entries import Entry
from airhockey.evaluator.match import MatchOptions, begin_match, play_match
from airhockey.evaluator.runs.game_records import GameOptions
from airhockey.evaluator.schedule import TournamentOptions
from airhockey.evaluator.tournament import begin_tournament, play_tournament
from submissions import make_submission

ENV = "3dof-defend"
EPISODES = 12
SWING = "action[0] += 0.6 * np.sin(0.1 * self.steps); action[1] += 3 * np.cos(0.1 * self.steps)"
FAIL = "assert self.episodes % 4 or self.steps < 9, '<script>alert(1)</script>'"


class Results(NamedTuple):
    """Folders of results; nobody may write to them.

    Attributes:
        swings: A run whose agent violates constraints and fails every fourth episode with a nasty message.
        holds: A run with the same seeds.
        other: A run of several tasks with another seed and disturbances.
    """

    root: Path
    swings: Path
    holds: Path
    other: Path
    match: Path
    tournament: Path


def make_results(root: Path) -> Results:
    """Play them, in a folder below `root`."""
    agents = root / "agents"
    agents.mkdir()
    swings = make_submission(agents, f"{SWING}\n        {FAIL}", config="interpolation_order: 3\n")
    nasty = Path(swings).rename(agents / "<b>swings&")
    found = Results(
        root / "results",
        *(root / "results" / name for name in ("swings", "holds", "below/other", "match", "tournament")),
    )
    run = Options(environments=(ENV,), agent=str(nasty), episodes=EPISODES, seed=3)
    evaluate(begin(run, found.swings))
    evaluate(begin(Options(environments=(ENV,), agent="hold", episodes=EPISODES, seed=3), found.holds))
    both = ("3dof-hit", "3dof-defend")
    evaluate(begin(Options(environments=both, agent="hold", episodes=4, seed=4, disturbances="server"), found.other))
    short = GameOptions(steps=900)
    match = MatchOptions(home="hold", away="hold", games=2, swap_sides=True, game=short)
    play_match(begin_match(match, found.match))
    entries = tuple(Entry(name=name, agent="hold") for name in ("alpha", "beta", "gamma"))
    tournament = TournamentOptions(entries=entries, game=GameOptions(steps=60))
    play_tournament(begin_tournament(tournament, found.tournament))
    return found

"""A player that breaks down, hangs or kills its process loses its games, and nothing else is lost."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from games import play_one

from airhockey.evaluator.engines.processes import Processes
from airhockey.evaluator.entries import Entry
from airhockey.evaluator.match import MatchOptions, begin_match, play_match
from airhockey.evaluator.play import watchdog as watch
from airhockey.evaluator.play.watchdog import Watch, culprit, live_games
from airhockey.evaluator.runs.game_records import GameOptions, GameRecord, Status
from airhockey.evaluator.runs.journal import read_journal
from airhockey.evaluator.schedule import TournamentOptions
from airhockey.evaluator.tournament import begin_tournament, play_tournament

Submission = Callable[..., str]


@pytest.mark.parametrize(
    ("given", "reason", "steps"),
    [
        ({"building": "raise OSError('no weights')"}, "build_agent: OSError: no weights (agent_builder.py:", 0),
        ({"building": "sys.exit(1)"}, "build_agent: SystemExit: 1", 0),
        ({"config": "interpolation_order: 9\n"}, "build_agent: ConfigurationError: unknown interpolation order 9", 0),
        ({"behaviour": "if self.steps == 5: raise RuntimeError('tired')"}, "step 5: RuntimeError: tired", 5),
        ({"behaviour": "if self.steps == 5: sys.exit(0)"}, "step 5: SystemExit: 0", 5),
        ({"behaviour": "if self.steps == 5: action = action[0]"}, "step 5: the action has shape (7,)", 5),
        ({"behaviour": "if self.steps == 5: action = None"}, "step 5: the action is of type NoneType", 5),
        ({"behaviour": "if self.steps == 5: action[1, 1] = np.nan"}, "step 5: the action holds values", 5),
        ({"behaviour": "if self.steps == 5: action[:] = 1e308"}, "step 5: the action leads to", 5),
        ({"behaviour": "if self.steps == 5: del self.episodes; self.episode_start()"}, "step 5: AttributeError", 5),
    ],
)
@pytest.mark.parametrize("side", ["home", "away"])
def test_it_forfeits_and_the_opponent_wins(
    submission: Submission, given: dict[str, str], reason: str, steps: int, side: str
) -> None:
    agent = submission(**given)
    record = play_one(*((agent, "hold") if side == "home" else ("hold", agent)), steps=30).record
    guilty, other = (record.home, record.away) if side == "home" else (record.away, record.home)
    assert guilty.failure is not None and guilty.failure.startswith(reason)
    assert other.failure is None
    assert record.winner == ("away" if side == "home" else "home")
    assert record.steps == steps
    forfeits = [event for event in record.events if event.what == "forfeit"]
    assert [(event.step, event.who, event.why) for event in forfeits] == [(steps, side, guilty.failure)]


def test_both_may_fail(submission: Submission) -> None:
    record = play_one(submission(building="1 / 0"), submission(building="[][0]")).record
    assert record.winner == "draw"
    assert record.home.failure is not None and "ZeroDivisionError" in record.home.failure
    assert record.away.failure is not None and "IndexError" in record.away.failure


@pytest.mark.parametrize("endless", ["time.sleep(1e6)", "exec('while True: pass')"])
def test_a_call_that_does_not_return_is_ended(
    submission: Submission, monkeypatch: pytest.MonkeyPatch, endless: str
) -> None:
    monkeypatch.setattr(Watch.__init__, "__defaults__", (None, 0.2))
    record = play_one("hold", submission(f"if self.steps == 3: {endless}")).record
    assert record.winner == "home"
    assert record.steps == 3
    assert "it did not return within 0.2 s" in (record.away.failure or "")


def test_a_call_that_does_not_return_is_ended_in_any_thread() -> None:
    """As in a Dask worker."""
    raised: list[BaseException] = []

    def call() -> None:
        with Watch(patience=0.2) as watching:
            try:
                with watching.over("home"):
                    while True:
                        pass
            except watch.Overtime as overtime:
                raised.append(overtime)

    thread = threading.Thread(target=call)
    thread.start()
    thread.join(20.0)
    assert len(raised) == 1


def test_who_was_at_work_survives_the_process(tmp_path: Path) -> None:
    file = tmp_path / "game"
    status = Status(
        key="0",
        home="a",
        away="b",
        step=250,
        steps=500,
        score=(1, 0),
        faults=(0, 2),
        penalty=(0.0, 1.5),
        side="away",
        rate=9.5,
    )
    assert culprit(file) is None
    with Watch(file) as watching:
        assert live_games(tmp_path) == []  # nothing told yet
        watching.tell(status)
        assert live_games(tmp_path) == [status]
        with watching.over("away"):
            assert culprit(file) == "away"
        assert culprit(file) is None
    assert not file.exists()
    with Watch(tmp_path / "no such folder" / "game") as watching:
        watching.tell(status)


def test_a_player_that_kills_its_process_loses_its_games_and_nothing_else(
    submission: Submission, tmp_path: Path
) -> None:
    killer = submission("if self.steps == 20: os.kill(os.getpid(), signal.SIGSEGV)")
    entries = Entry(name="a", agent="hold"), Entry(name="killer", agent=killer)
    options = TournamentOptions(entries=entries, game=GameOptions(steps=50))
    table = play_tournament(begin_tournament(options, tmp_path / "run"), Processes(1, attempts=1))
    assert [(row.name, row.won, row.lost, row.forfeits) for row in table.rows] == [("a", 2, 0, 0), ("killer", 0, 2, 2)]
    failures = {(r.home.failure, r.away.failure) for r in read_journal(tmp_path / "run", GameRecord).records}
    why = "the worker process died 1 times over it (signal SIGSEGV)"
    assert failures == {(None, why), (why, None)}


def test_a_failed_game_of_a_match_is_shown_with_its_reason(submission: Submission, tmp_path: Path) -> None:
    agent = submission("if self.steps == 5: raise RuntimeError('stage [fright]')")
    options: Any = MatchOptions(home=agent, away="hold", games=2, swap_sides=True, game=GameOptions(steps=20))
    result = play_match(begin_match(options, tmp_path / "run"))
    assert (result.wins, result.draws, result.losses) == (0, 0, 2)
    assert [game.winner for game in result.games] == ["away", "away"]
    for game in result.games:
        assert game.failures[0] is not None and "stage [fright]" in game.failures[0]
        assert game.failures[1] is None

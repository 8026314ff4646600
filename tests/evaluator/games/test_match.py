"""A match: the same games whatever plays them, taken up where it was stopped, read from both sides."""

import os
import shutil
from pathlib import Path
from typing import Any

import msgspec
import pytest
from games import course, events_of, film, play_one

from airhockey.errors import ConfigurationError
from airhockey.evaluator.engines.cluster import Cluster
from airhockey.evaluator.engines.processes import Processes
from airhockey.evaluator.match import (
    MatchOptions,
    MatchResult,
    begin_match,
    match_jobs,
    play_match,
    resume_match,
)
from airhockey.evaluator.runs.game_folder import GameFolder
from airhockey.evaluator.runs.game_records import GameOptions, GameRecord
from airhockey.evaluator.runs.game_trajectories import read_film
from airhockey.evaluator.runs.journal import read_journal
from submissions import make_submission

STEPS = 120


@pytest.fixture(scope="module")
def options(tmp_path_factory: pytest.TempPathFactory) -> MatchOptions:
    """Some games of an agent that draws from NumPy's global generator, under disturbances, at home and away."""
    agent = make_submission(tmp_path_factory.mktemp("agents"))
    game = GameOptions(steps=STEPS, disturbances="server")
    return MatchOptions(home=agent, away="hold", games=4, seed=5, swap_sides=True, game=game)


def courses(folder: Path) -> dict[str, Any]:
    return {
        record.job.key: (course(record), film(folder, record.job.key))
        for record in read_journal(folder, GameRecord).records
    }


@pytest.fixture(scope="module")
def folder(options: MatchOptions, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What every other way of playing must reproduce."""
    folder = tmp_path_factory.mktemp("match") / "straight"
    play_match(begin_match(options, folder))
    return folder


@pytest.fixture(scope="module")
def straight(folder: Path) -> Any:
    return courses(folder)


def test_one_job_two_jobs_and_a_cluster_give_the_same_games(
    options: MatchOptions, straight: Any, tmp_path: Path
) -> None:
    for name, engine in {"two": Processes(2), "dask": Cluster("local:2")}.items():
        play_match(begin_match(options, tmp_path / name), engine)
        assert courses(tmp_path / name) == straight


def test_each_game_has_a_seed_of_its_own(options: MatchOptions, straight: Any, tmp_path: Path) -> None:
    assert len({job.seed for job in match_jobs(options)}) == 4
    assert len({film for _, film in straight.values()}) == 4
    other = msgspec.structs.replace(options, seed=6, games=1)
    play_match(begin_match(other, tmp_path / "other"))
    assert courses(tmp_path / "other")["0"] != straight["0"]


def test_taken_up_after_ctrl_c_in_the_order_that_is_left(options: MatchOptions, straight: Any, tmp_path: Path) -> None:
    def stop(_: Any) -> None:
        raise KeyboardInterrupt

    for _ in range(2):
        folder = (
            begin_match(options, tmp_path / "run")
            if not (tmp_path / "run").exists()
            else resume_match(tmp_path / "run")
        )
        with pytest.raises(KeyboardInterrupt):
            play_match(folder, None, stop)
    assert [record.job.key for record in read_journal(tmp_path / "run", GameRecord).records] == ["0", "1"]
    play_match(resume_match(tmp_path / "run"))
    assert courses(tmp_path / "run") == straight
    played: list[Any] = []
    play_match(resume_match(tmp_path / "run"), None, played.append)
    assert played == []  # a finished match is only reported


def test_a_line_that_a_kill_cut_short_is_played_again(folder: Path, straight: Any, tmp_path: Path) -> None:
    copy = shutil.copytree(folder, tmp_path / "copy")
    journal = copy / "journal.jsonl"
    journal.write_bytes(journal.read_bytes()[:-40])
    assert len(read_journal(copy, GameRecord).records) == 3
    play_match(resume_match(copy))
    assert courses(copy) == straight


def test_a_match_seen_from_home(options: MatchOptions, folder: Path) -> None:
    """In every second game its players have changed sides, and the report turns it round."""
    jobs = match_jobs(options)
    assert [job.home == options.home for job in jobs] == [True, False, True, False]
    result = play_match(resume_match(folder))
    records = {record.job.key: record for record in read_journal(folder, GameRecord).records}
    for k, game in enumerate(result.games):
        record = records[str(k)]
        mine, theirs = (record.away, record.home) if k % 2 else (record.home, record.away)
        assert game.swapped == bool(k % 2)
        assert game.score == (mine.points, theirs.points)
        assert game.penalty == (mine.penalty, theirs.penalty)
        assert game.faults == (mine.faults, theirs.faults)
        assert (game.seed, game.steps) == (jobs[k].seed, STEPS)
    serves = [events_of(records["1"], "serve")[0].who, result.games[1].events[0].who]
    assert set(serves) == {"home", "away"}
    stored = (folder / "result.json").read_bytes()
    assert msgspec.json.decode(stored, type=MatchResult) == result


def test_what_is_taken_up_must_be_what_was_asked_for(
    options: MatchOptions, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begin_match(options, tmp_path / "run").close()
    resume_match(tmp_path / "run", {"seed": 5, "steps": STEPS, "disturbances": "server", "away": "hold"}).close()
    for name, value in {
        "seed": 4,
        "games": 7,
        "steps": 9,
        "clock": "wall",
        "disturbances": "harsh",
        "home": "x",
    }.items():
        with pytest.raises(ConfigurationError, match=f"has {name}"):
            resume_match(tmp_path / "run", {name: value})
    with resume_match(tmp_path / "run"), pytest.raises(ConfigurationError, match="another process"):
        resume_match(tmp_path / "run")
    monkeypatch.setattr("airhockey.envs.versions", lambda: {"mujoco": "5.0.0"})
    with pytest.raises(ConfigurationError, match=r"but this is 5\.0\.0"):
        resume_match(tmp_path / "run")


def test_a_wrong_option_leaves_nothing_behind(options: MatchOptions, tmp_path: Path) -> None:
    wrong_games = {"steps": 0, "disturbances": "storm", "clock": "sun", "variant": "street", "edition": "1999"}
    wrong = {"home": "nobody", "away": "./nowhere", "games": 0, "seed": -1}
    for name, value in wrong.items():
        with pytest.raises(ConfigurationError):
            begin_match(msgspec.structs.replace(options, **{name: value}), tmp_path / "run")
    for name, value in wrong_games.items():
        game = msgspec.structs.replace(options.game, **{name: value})
        with pytest.raises(ConfigurationError):
            begin_match(msgspec.structs.replace(options, game=game), tmp_path / "run")
    assert not (tmp_path / "run").exists()
    assert isinstance(begin_match(options, tmp_path / "run"), GameFolder)


def test_a_film_has_a_row_per_step(folder: Path) -> None:
    rows = read_film(folder / "films" / "0.h5")
    assert rows.shape == (STEPS, 46)
    assert abs(rows[:, 0]).max() < 1.0  # the puck is on the table


def test_a_game_does_not_depend_on_what_was_played_before() -> None:
    first = play_one("hold", "thesis", 60, seed=3)
    play_one("thesis", "hold", 60, seed=4)
    again = play_one("hold", "thesis", 60, seed=3)
    assert course(first.record) == course(again.record)
    assert first.film.tobytes() == again.film.tobytes()


def test_memory_is_flat_over_a_game() -> None:
    """All that grows with a game is the list of its events."""
    rows = []

    def memory() -> float:
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE") / 1e6

    from airhockey.envs.disturbances import load_disturbances
    from airhockey.evaluator.play.game import GamePlayer
    from airhockey.evaluator.runs.game_records import GameJob

    play_one("hold", "hold", 50)
    player = GamePlayer(
        GameOptions(steps=3000), load_disturbances("ideal"), on_step=lambda _: rows.append(memory()), every=500
    )
    player(GameJob("0", "h", "a", "hold", "hold", 1))
    assert len(rows) == 6
    assert rows[-1] - rows[0] < 2.0

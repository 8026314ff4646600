"""A tournament is what it is, however it was interrupted, extended and spread."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import msgspec
import pytest
from games import course

from airhockey.errors import ConfigurationError
from airhockey.evaluator.engines.cluster import Cluster
from airhockey.evaluator.engines.processes import Processes
from airhockey.evaluator.entries import Entry
from airhockey.evaluator.judging.standings import Standings
from airhockey.evaluator.runs.game_records import GameOptions, GameRecord
from airhockey.evaluator.runs.journal import read_journal
from airhockey.evaluator.schedule import TournamentOptions
from airhockey.evaluator.tournament import begin_tournament, play_tournament, read_standings, resume_tournament
from submissions import make_submission

STEPS = 300
SECRET = "1f"
"""Of the agents' seeds: a command would draw another one every time."""
HOCKEY = [sys.executable, "-m", "airhockey.cli", "tournament", "--jobs", "1", "--quiet"]
Submission = Callable[..., str]


@pytest.fixture(scope="module")
def entries(tmp_path_factory: pytest.TempPathFactory) -> tuple[Entry, ...]:
    """Some stand, some tremble, one breaks down now and then, one lifts its mallet and is penalised."""
    submission = partial(make_submission, tmp_path_factory.mktemp("agents"))
    agents = {
        "stands": "hold",
        "trembles": submission(),
        "fails": submission("if self.steps == 200 and observation[1] > 0.1: raise RuntimeError('tired')"),
        "lifts": submission("action[0, 3] += 0.0005"),
        "late": "hold",
    }
    return tuple(Entry(name=name, agent=agent) for name, agent in agents.items())


@pytest.fixture(scope="module")
def straight(entries: tuple[Entry, ...], tmp_path_factory: pytest.TempPathFactory) -> Any:
    """All five entries, played without interruption."""
    options = TournamentOptions(entries=entries, seed=2, game=GameOptions(steps=STEPS, agent_seed=SECRET))
    folder = tmp_path_factory.mktemp("tournament") / "straight"
    table = play_tournament(begin_tournament(options, folder), Processes(2))
    rows = {row.name: row for row in table.rows}
    assert 0 < rows["fails"].forfeits < 8
    assert rows["lifts"].penalty > rows["stands"].penalty
    return outcome(folder)


def outcome(folder: Path) -> Any:
    """Standings, as computed from the folder and as left in it, and every game's course."""
    table = read_standings(folder)[1]
    assert msgspec.json.decode((folder / "standings.json").read_bytes(), type=Standings) == table
    return table, {record.job.key: course(record) for record in read_journal(folder, GameRecord).records}


def typed(entries: tuple[Entry, ...]) -> list[str]:
    return [f"{entry.name}={entry.agent}" for entry in entries]


def killed_after(count: int, folder: Path, command: list[str]) -> None:
    """Run a command and kill it, without a word, once the folder holds so many games."""
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        end = time.monotonic() + 60.0
        while len(read_journal(folder, GameRecord).records) < count:
            assert process.poll() is None and time.monotonic() < end
            time.sleep(0.01)
        process.kill()


def test_killed_twice_resumed_and_extended(entries: tuple[Entry, ...], straight: Any, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    out = ["--out", str(folder)]
    begin = [
        *HOCKEY,
        *typed(entries[:4]),
        "--steps",
        str(STEPS),
        "--seed",
        "2",
        "--agent-seed",
        SECRET,
        "--isolate",
        "none",
        *out,
    ]
    killed_after(2, folder, begin)
    killed_after(len(read_journal(folder, GameRecord).records) + 2, folder, [*HOCKEY, "--resume", *out])
    assert len(read_journal(folder, GameRecord).records) < 12
    before = {record.job.key: record for record in read_journal(folder, GameRecord).records}
    done = subprocess.run([*HOCKEY, "--resume", *out, "--json", *typed(entries[4:])], check=False, capture_output=True)
    assert done.returncode == 3  # an entry failed games
    assert outcome(folder) == straight
    assert msgspec.json.decode(done.stdout, type=Standings) == straight[0]
    after = {record.job.key: record for record in read_journal(folder, GameRecord).records}
    assert len(after) == 20
    assert {key: after[key] for key in before} == before  # only the missing games were played


def test_on_dask_with_a_worker_killed(entries: tuple[Entry, ...], straight: Any, tmp_path: Path) -> None:
    options = TournamentOptions(entries=entries, seed=2, game=GameOptions(steps=STEPS, agent_seed=SECRET))
    killed = []

    def kill_a_worker(*_: Any) -> None:
        """After the second game: with two workers, at least one of them is in the middle of another."""
        if len(read_journal(tmp_path / "run", GameRecord).records) == 2:
            victim = sorted(descendants(os.getpid()))[-1]
            os.kill(victim, signal.SIGKILL)
            killed.append(victim)

    play_tournament(begin_tournament(options, tmp_path / "run"), Cluster("local:2"), kill_a_worker)
    assert killed
    assert outcome(tmp_path / "run") == straight


def descendants(pid: int) -> set[int]:
    """Processes of Dask workers below this one."""
    found = set()
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        for child in map(int, task.read_text().split()):
            found |= {child} | descendants(child)
    return {child for child in found if b"resource_tracker" not in Path(f"/proc/{child}/cmdline").read_bytes()}


def test_with_a_process_killed_in_the_middle_of_a_game(entries: tuple[Entry, ...], tmp_path: Path) -> None:
    options = TournamentOptions(entries=entries[:2], seed=2, game=GameOptions(steps=STEPS, agent_seed=SECRET))
    play_tournament(begin_tournament(options, tmp_path / "straight"))
    folder = begin_tournament(options, tmp_path / "run")
    thread = threading.Thread(target=kill_once_playing, args=(folder.live,))
    thread.start()
    play_tournament(folder, Processes(1))
    thread.join()
    assert outcome(tmp_path / "run") == outcome(tmp_path / "straight")


def kill_once_playing(live: Path) -> None:
    """Kill the only worker once its game shows that it has begun."""
    while not any(b"{" in file.read_bytes() for file in live.glob("*")):
        time.sleep(0.01)
    os.kill(sorted(descendants(os.getpid()))[-1], signal.SIGKILL)


def test_a_second_phase_with_a_replacement_after_the_first_is_played(tmp_path: Path, submission: Submission) -> None:
    entries = (Entry(name="a", agent="hold"), Entry(name="b", agent=submission(building="1 / 0")))
    options = TournamentOptions(entries=entries, game=GameOptions(steps=20))
    first = play_tournament(begin_tournament(options, tmp_path / "run"))
    assert [(row.name, row.points) for row in first.rows] == [("a", 6), ("b", 0)]
    folder = resume_tournament(tmp_path / "run", phases=2, replacements={"b": "hold"})
    second = play_tournament(folder)
    assert [(row.name, row.points, row.forfeits) for row in second.rows] == [("a", 8, 0), ("b", 2, 2)]
    with pytest.raises(ConfigurationError, match="'b' has played games of phase 2"):
        resume_tournament(tmp_path / "run", replacements={"b": "thesis"})
    with pytest.raises(ConfigurationError, match="cannot be made 1"):
        resume_tournament(tmp_path / "run", phases=1)
    assert read_standings(tmp_path / "run")[1] == second  # and the refusals changed nothing


def test_an_extension_that_is_wrong_changes_nothing(tmp_path: Path) -> None:
    entries = (Entry(name="a", agent="hold"), Entry(name="b", agent="hold"))
    options = TournamentOptions(entries=entries, game=GameOptions(steps=20))
    begin_tournament(options, tmp_path / "run").close()
    before = (tmp_path / "run" / "tournament.json").read_bytes()
    for wrong in (Entry(name="a", agent="thesis"), Entry(name="c", agent="nobody"), Entry(name="c-d", agent="hold")):
        with pytest.raises(ConfigurationError):
            resume_tournament(tmp_path / "run", [wrong])
    with pytest.raises(ConfigurationError, match="has steps 20, not 30"):
        resume_tournament(tmp_path / "run", (), {"steps": 30})
    with pytest.raises(ConfigurationError, match="has no tournament"):
        resume_tournament(tmp_path)
    assert (tmp_path / "run" / "tournament.json").read_bytes() == before
    with resume_tournament(tmp_path / "run", entries) as folder:  # the same again is no extension
        assert folder.manifest.options == options


def test_standings_are_on_the_disk_after_every_game(tmp_path: Path) -> None:
    entries = tuple(Entry(name=name, agent="hold") for name in "abc")
    options = TournamentOptions(entries=entries, game=GameOptions(steps=20))
    seen = []

    def look(_: Any, table: Standings) -> None:
        stored = msgspec.json.decode((tmp_path / "run" / "standings.json").read_bytes(), type=Standings)
        assert stored == table == read_standings(tmp_path / "run")[1]
        assert (tmp_path / "run" / "standings.csv").read_text().count("\n") == 4
        seen.append(table.played)

    play_tournament(begin_tournament(options, tmp_path / "run"), None, look)
    assert seen == [1, 2, 3, 4, 5, 6]

"""A run's result depends on its options alone: not on the number of jobs, kills, or what else is played."""

import multiprocessing
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest
from outcomes import ENV, outcome, without_time

from airhockey.envs.disturbances import load_disturbances
from airhockey.errors import ConfigurationError
from airhockey.evaluator import Options, Processes, begin, evaluate, play_episode, resume
from airhockey.evaluator.play.episode import EpisodePlayer
from airhockey.evaluator.runs.episode_folder import EpisodeFolder
from airhockey.evaluator.runs.journal import read_journal
from airhockey.evaluator.runs.records import EpisodeRecord, Job
from airhockey.evaluator.runs.trajectories import read_episode


@pytest.fixture
def one_job(options: Options, tmp_path: Path) -> Path:
    """The run that every other way of playing must reproduce."""
    evaluate(begin(options, tmp_path / "one"))
    return tmp_path / "one"


def changed(options: Options, **fields: Any) -> Options:
    return msgspec.structs.replace(options, **fields)


def test_two_jobs_give_what_one_gives(options: Options, one_job: Path, tmp_path: Path) -> None:
    evaluate(begin(options, tmp_path / "two"), Processes(2))
    assert outcome(tmp_path / "two") == outcome(one_job)


def test_the_same_seed_twice_and_another_seed(options: Options, one_job: Path, tmp_path: Path) -> None:
    evaluate(begin(options, tmp_path / "again"))
    assert outcome(tmp_path / "again") == outcome(one_job)
    evaluate(begin(changed(options, seed=4), tmp_path / "other"))
    assert all(here[-1] != there[-1] for here, there in zip(outcome(tmp_path / "other"), outcome(one_job), strict=True))


def test_an_episode_alone_is_the_one_of_the_run(options: Options, tmp_path: Path) -> None:
    evaluate(begin(changed(options, episodes=38), tmp_path / "run"))
    alone = play_episode(changed(options, episodes=38), ENV, 37)
    assert without_time(alone) == outcome(tmp_path / "run")[37]
    assert read_episode(tmp_path / "run" / "trajectories.h5", ENV, 37).keys() == alone.trajectory.keys()


def test_other_tasks_before_it_change_nothing(options: Options, one_job: Path, tmp_path: Path) -> None:
    evaluate(begin(changed(options, environments=("3dof-hit", ENV), episodes=2), tmp_path / "both"))
    assert outcome(tmp_path / "both") == outcome(one_job)[:2]


def test_a_run_taken_up_in_the_middle(options: Options, one_job: Path, tmp_path: Path) -> None:
    """As after Ctrl-C: what was played is kept, the rest is played, by another number of jobs."""
    seen = []

    def stop_after_two(record: Any) -> None:
        seen.append(record.index)
        if len(seen) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        evaluate(begin(options, tmp_path / "run"), None, stop_after_two)
    assert [record.index for record in read_journal(tmp_path / "run", EpisodeRecord).records] == [0, 1]
    evaluate(resume(tmp_path / "run"), Processes(2), lambda record: seen.append(record.index))
    assert sorted(seen) == list(range(6))
    assert outcome(tmp_path / "run") == outcome(one_job)
    result = evaluate(resume(tmp_path / "run"), None, lambda record: seen.append(record.index))
    assert len(seen) == 6  # a finished run is only reported
    assert msgspec.json.decode((tmp_path / "run" / "result.json").read_bytes()) == msgspec.to_builtins(result)


def test_killed_and_resumed(options: Options, tmp_path: Path) -> None:
    """The parent is killed with SIGKILL while two workers play: nothing finished is lost, and no worker stays behind."""
    many = changed(options, episodes=60, agent_seed="5ec7e7")
    evaluate(begin(many, tmp_path / "whole"), Processes(2))
    command = [sys.executable, "-m", "airhockey.cli", "evaluate", "--out", str(tmp_path / "run")]
    fresh = ["--env", ENV, "--agent", options.agent, "--episodes", "60", "--seed", "3", "--disturbances", "server"]
    fresh += ["--agent-seed", "5ec7e7"]  # else the command draws a secret one for a submission
    with subprocess.Popen([*command, *fresh, "--jobs", "2", "--quiet"], stdout=subprocess.DEVNULL) as process:
        wait_for(lambda: len(read_journal(tmp_path / "run", EpisodeRecord).records) > 0)
        children = children_of(process.pid)
        process.kill()
    finished = {record.index for record in read_journal(tmp_path / "run", EpisodeRecord).records}
    assert len(finished) < 60
    wait_for(lambda: not any(map(is_running, children)))
    resumed = subprocess.run(
        [*command, "--resume", "--jobs", "1", "--json"], capture_output=True, text=True, check=True
    )
    assert outcome(tmp_path / "run") == outcome(tmp_path / "whole")
    assert msgspec.json.decode(resumed.stdout)["episodes"] == 60


def test_another_run_is_not_taken_up(options: Options, one_job: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    resume(one_job, {"seed": 3, "disturbances": "server"}).__exit__()
    for name, value in {"seed": 4, "episodes": 7, "clock": "wall", "disturbances": "harsh", "agent": "hold"}.items():
        with pytest.raises(ConfigurationError, match=f"has {name}"):
            resume(one_job, {name: value})
    monkeypatch.setattr("airhockey.envs.versions", lambda: {"mujoco": "5.0.0"})
    with pytest.raises(ConfigurationError, match=r"began with mujoco 4\.0\.\d+, but this is 5\.0\.0"):
        resume(one_job)


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("behaviour", "reason"),
    [
        ("if self.episodes % 2 == 0: raise RuntimeError('tired')", "step 0: RuntimeError: tired (agent_builder.py:"),
        ("if self.steps == 3: action = action[0]", "step 2: ActionError"),
        ("if self.steps == 3: action[1, 1] = np.nan", "step 2: ActionError"),
        ("if self.steps == 3: sys.exit(0)", "step 2: SystemExit: 0"),
    ],
)
def test_a_failing_agent_fails_its_episodes_and_the_run_goes_on(
    submission: Callable[..., str], tmp_path: Path, behaviour: str, reason: str
) -> None:
    result = evaluate(begin(Options(environments=(ENV,), agent=submission(behaviour), episodes=4), tmp_path / "run"))
    records = read_journal(tmp_path / "run", EpisodeRecord).records
    errors = [record.error for record in records if record.error is not None]
    assert errors
    assert all(error.startswith(reason) for error in errors)
    assert result.agent_errors == len(errors)
    assert len(records) == 4


@pytest.mark.parametrize("engine", [None, Processes(2)])
def test_a_builder_that_fails(submission: Callable[..., str], tmp_path: Path, engine: Any) -> None:
    agent = submission(building="raise OSError('no weights')")
    result = evaluate(begin(Options(environments=(ENV,), agent=agent, episodes=4), tmp_path / "run"), engine)
    assert (result.agent_errors, result.success, result.penalty) == (4, 0.0, 0.0)
    errors = {record.error for record in read_journal(tmp_path / "run", EpisodeRecord).records}
    assert len(errors) == 1
    assert errors.pop().startswith("build_agent: OSError: no weights (agent_builder.py:")


def test_an_agent_that_kills_its_process_fails_that_episode(submission: Callable[..., str], tmp_path: Path) -> None:
    agent = submission("if observation[1] < -0.3: os.kill(os.getpid(), signal.SIGSEGV)")
    result = evaluate(begin(Options(environments=(ENV,), agent=agent, episodes=5), tmp_path / "run"), Processes(2))
    errors = [record.error for record in read_journal(tmp_path / "run", EpisodeRecord).records if record.error]
    assert 0 < len(errors) < 5
    assert set(errors) == {"the worker process died 3 times over it (signal SIGSEGV)"}
    assert result.agent_errors == len(errors)


@pytest.mark.parametrize(("order", "shape"), [("1", (3,)), ("5", (3, 3)), ("none", (20, 3, 3)), ("agent", (2, 3))])
def test_the_interpolation_order_is_what_was_asked_for(tmp_path: Path, order: str, shape: tuple[int, ...]) -> None:
    asked = int(order) if order.isdigit() else order
    options = Options(environments=(ENV,), agent="hold", episodes=1, interpolation_order=asked)  # type: ignore[arg-type]
    assert play_episode(options, ENV, 0).trajectory["actions"].shape[1:] == shape


def test_a_submission_says_its_own_order(submission: Callable[..., str]) -> None:
    agent = submission("action = action[0]", config="interpolation_order: 1\n")
    assert play_episode(Options(environments=(ENV,), agent=agent), ENV, 0).record.error is None
    agent = submission("pass", config="interpolation_order: 9\n")
    assert "9" in (play_episode(Options(environments=(ENV,), agent=agent), ENV, 0).record.error or "")


def test_the_cpu_clock_does_not_count_waiting(submission: Callable[..., str]) -> None:
    options = Options(environments=(ENV,), agent=submission("if self.steps == 1: time.sleep(0.3)"), episodes=1)
    assert play_episode(changed(options, clock="wall"), ENV, 0).record.computation_time.max > 0.3
    assert play_episode(changed(options, clock="cpu"), ENV, 0).record.computation_time.max < 0.1


def test_a_wrong_option_leaves_nothing_behind(options: Options, tmp_path: Path) -> None:
    wrong = {"environments": ("8dof-hit",), "episodes": 0, "seed": -1, "disturbances": "storm", "agent": "nobody"}
    for name, value in {**wrong, "interpolation_order": 7, "clock": "sun", "edition": "1999"}.items():
        with pytest.raises(ConfigurationError):
            begin(changed(options, **{name: value}), tmp_path / "run")
    assert not (tmp_path / "run").exists()
    assert isinstance(begin(options, tmp_path / "run"), EpisodeFolder)


def wait_for(condition: Callable[[], bool], seconds: float = 20.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it never came to pass"
        time.sleep(0.02)


def children_of(pid: int) -> list[int]:
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def is_running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def memory(pid: int | str, key: str) -> float:
    """Of a process, in [MB]: VmRSS now, VmHWM at its highest."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return next(float(line.split()[1]) / 1e3 for line in lines if line.startswith(key))


def test_a_workers_memory_has_a_bound(tmp_path: Path) -> None:
    """400 MB, Pinocchio and the environment with two robots included."""
    peaks = []

    def on_episode(_: Any) -> None:
        peaks.extend(memory(child.pid or 0, "VmHWM") for child in multiprocessing.active_children())

    options = Options(environments=("7dof-hit",), agent="thesis", episodes=3, disturbances="server")
    evaluate(begin(options, tmp_path / "run"), Processes(1), on_episode)
    assert peaks
    assert max(peaks) < 400


@pytest.mark.long
def test_memory_does_not_grow_with_the_episodes() -> None:
    options = Options(environments=(ENV,), agent="hold", disturbances="server")
    player = EpisodePlayer(options, load_disturbances("server"))
    for index in range(20):
        player(Job(ENV, index))
    before = memory("self", "VmRSS")
    for index in range(20, 120):
        player(Job(ENV, index))
    assert memory("self", "VmRSS") < before + 5

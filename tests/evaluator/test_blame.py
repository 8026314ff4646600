"""What the environment, its disturbances or the machine did is on no agent's record; the run stops, and goes on."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Hockey
from engine_functions import DiesInTheSecond
from numba.core.errors import NumbaError
from outcomes import ENV

from airhockey import envs
from airhockey.agents.hold import HoldAgent
from airhockey.envs.environment import Environment
from airhockey.errors import EnvironmentFault
from airhockey.evaluator import Options, Processes, begin, evaluate, resume
from airhockey.evaluator.match import MatchOptions, begin_match, play_match
from airhockey.evaluator.play.blame import HUGE
from airhockey.evaluator.runs.game_records import GameOptions, GameRecord
from airhockey.evaluator.runs.journal import read_journal
from airhockey.evaluator.runs.records import EpisodeRecord

Submission = Callable[..., str]
LIGHT = "profile: light\nmismatch: {mass: [1.0e-6, 1.0e-5]}\n"
"""Links of some micrograms: the simulation of the 7-DoF arm fails in the first step."""


@pytest.fixture
def light(tmp_path: Path) -> str:
    path = tmp_path / "light.yaml"
    path.write_text(LIGHT)
    return str(path)


@pytest.mark.parametrize("engine", [None, Processes(2)])
def test_a_profile_that_no_simulation_survives(light: str, tmp_path: Path, engine: Any) -> None:
    options = Options(environments=("7dof-hit",), agent="hold", episodes=2, disturbances=light)
    with pytest.raises(EnvironmentFault, match="the disturbances 'light' make the simulation fail in step 1"):
        evaluate(begin(options, tmp_path / "run"), engine)
    assert read_journal(tmp_path / "run", EpisodeRecord).records == []


def test_it_is_no_forfeit_either(light: str, tmp_path: Path) -> None:
    options = MatchOptions(home="hold", away="hold", game=GameOptions(steps=5, disturbances=light))
    with pytest.raises(EnvironmentFault, match="'light'"):
        play_match(begin_match(options, tmp_path / "match"))
    assert read_journal(tmp_path / "match", GameRecord).records == []


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "line",
    [
        "evaluate --env 7dof-hit --agent hold --episodes 1 --jobs 1",
        "match hold hold --steps 5 --jobs 1",
        "train pgpe --task hit --iterations 1 --episodes 1 --candidates 2 --jobs 1",
    ],
)
def test_the_command_line_says_whose_it_is(light: str, hockey: Hockey, line: str) -> None:
    status, _, err = hockey(f"{line} --disturbances {light} --out run --quiet")
    assert status == 4
    assert "the disturbances 'light' make the simulation fail" in err and "no agent's fault" in err
    assert "--resume --out run" in err and "Traceback" not in err
    status, _, again = hockey(
        f"{' '.join(line.split()[: 2 if line.startswith('train') else 1])} --resume --out run --quiet"
    )
    assert status == 4 and "the disturbances 'light'" in again


@pytest.mark.parametrize("failing", ["step", "reset"])
def test_what_an_environment_raises_is_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing: str) -> None:
    options = Options(environments=(ENV,), agent="hold", episodes=4)
    evaluate(begin(options, tmp_path / "whole"))
    plain, calls = getattr(Environment, failing), []

    def breaks(self: Environment, *args: Any, **kwargs: Any) -> Any:
        calls.append(failing)
        if len(calls) == (400 if failing == "step" else 5):
            raise ZeroDivisionError("division by zero")
        return plain(self, *args, **kwargs)

    monkeypatch.setattr(Environment, failing, breaks)
    with pytest.raises(EnvironmentFault, match=f"{ENV}.*ZeroDivisionError"):
        evaluate(begin(options, tmp_path / "run"))
    records = read_journal(tmp_path / "run", EpisodeRecord).records
    assert 0 < len(records) < 4
    assert [record.error for record in records] == [None] * len(records)
    assert evaluate(resume(tmp_path / "run")).agent_errors == 0
    strip = ("env", "index", "success", "steps", "violations", "error")
    assert [[getattr(one, key) for key in strip] for one in read_journal(tmp_path / "run", EpisodeRecord).records] == [
        [getattr(one, key) for key in strip] for one in read_journal(tmp_path / "whole", EpisodeRecord).records
    ]


def test_a_state_that_is_not_finite(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = Environment.step

    def broken(self: Environment, action: Any) -> Any:
        if self.step_count == 3:
            self.simulation.data.qvel[0] = np.nan
        return plain(self, action)

    monkeypatch.setattr(Environment, "step", broken)
    with pytest.raises(EnvironmentFault, match="the environment or this machine failed in step 4"):
        evaluate(begin(Options(environments=(ENV,), agent="hold", episodes=1), tmp_path / "run"))


def test_an_observation_that_is_not_finite(
    submission: Submission, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Environment, "_observe", lambda self: np.full(self.true_observation.size, np.nan))
    agent = submission("action = np.nan_to_num(action) / int(np.isfinite(observation).all())")
    with pytest.raises(EnvironmentFault, match="not finite"):
        evaluate(begin(Options(environments=(ENV,), agent=agent, episodes=1), tmp_path / "run"))


@pytest.mark.parametrize("order", ["1", "2", "3", "4", "5", "-1", "none"])
@pytest.mark.parametrize("value", [2e6, 1e30, 1e308])
def test_an_absurd_command_stays_its_senders(
    light: str, submission: Submission, tmp_path: Path, order: str, value: float
) -> None:
    behaviour = f"action = np.full({{shape}}, {value})"
    shapes = {"1": "7", "2": "7", "3": "(2, 7)", "4": "(2, 7)", "5": "(3, 7)", "-1": "(2, 7)", "none": "(20, 3, 7)"}
    agent = submission(behaviour.format(shape=shapes[order]), config=f"interpolation_order: {order}\n")
    options = Options(environments=("7dof-hit",), agent=agent, episodes=1, disturbances=light)
    assert evaluate(begin(options, tmp_path / "run")).agent_errors == 1


@pytest.mark.parametrize("name", ["3dof-hit", "7dof-hit", "tournament"])
@pytest.mark.parametrize("order", [1, 3, 5, None])
def test_a_command_that_is_not_absurd_breaks_no_undisturbed_simulation(name: str, order: int | None) -> None:
    env, random = envs.make(name, order), np.random.default_rng(1)
    env.reset(seed=0)
    for _ in range(25):
        actions = [HUGE * random.choice([-1.0, 1.0], form.shape) for form in env.formats]
        env.step(actions if env.n_players == 2 else actions[0])
    assert np.isfinite(env.true_observation).all()


class Broken(HoldAgent):
    """One of our own players (its module says so) on a machine that fails."""

    __module__ = "airhockey.agents.hold"
    failure: Exception

    def draw_action(self, observation: Any) -> Any:
        raise self.failure


@pytest.mark.parametrize(
    ("failure", "machine"),
    [
        (NumbaError("no LLVM"), True),
        (MemoryError(), True),
        (OSError(28, "No space left on device"), True),
        (ImportError("libstdc++.so.6"), True),
        (ValueError("a mistake of the player's"), False),
        (EnvironmentFault("said from inside"), True),
    ],
)
def test_a_machine_that_fails_under_our_own_player(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failure: Exception, machine: bool
) -> None:
    monkeypatch.setattr(Broken, "failure", failure, raising=False)
    monkeypatch.setattr("airhockey.agents.hold.HoldAgent", Broken)
    folder = begin(Options(environments=(ENV,), agent="hold", episodes=2), tmp_path / "run")
    if machine:
        with pytest.raises(EnvironmentFault):
            evaluate(folder)
    else:
        assert evaluate(folder).agent_errors == 2


@pytest.mark.parametrize(
    "code", ["raise MemoryError", "from airhockey.errors import EnvironmentFault; raise EnvironmentFault('not me')"]
)
@pytest.mark.parametrize("where", ["behaviour", "building"])
@pytest.mark.parametrize("isolate", ["none", "process"])
def test_a_submission_cannot_talk_its_way_out(
    submission: Submission, tmp_path: Path, code: str, where: str, isolate: Any
) -> None:
    options = Options(environments=(ENV,), agent=submission(**{where: code}), episodes=1, isolate=isolate)
    assert evaluate(begin(options, tmp_path / "run")).agent_errors == 1


@pytest.mark.parametrize(
    "code",
    [
        "observation[:] = np.nan; raise ValueError('what I saw')",
        "raise GeneratorExit",
        "raise BaseExceptionGroup('all', [BaseException()])",
        "raise type('Mute', (Exception,), {'__str__': lambda self: 1 / 0})",
    ],
)
def test_whatever_it_raises_here_is_its_own(submission: Submission, tmp_path: Path, code: str) -> None:
    options = Options(environments=(ENV,), agent=submission(code), episodes=2, isolate="none")
    assert evaluate(begin(options, tmp_path / "run")).agent_errors == 2


def test_an_agents_process_that_cannot_be_started(
    submission: Submission, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_more(*_: Any, **__: Any) -> Any:
        raise BlockingIOError(11, "Resource temporarily unavailable")

    monkeypatch.setattr("airhockey.evaluator.isolation.agent_client.subprocess.Popen", no_more)
    options = Options(environments=(ENV,), agent=submission(), episodes=1, isolate="process")
    with pytest.raises(EnvironmentFault, match="Resource temporarily unavailable"):
        evaluate(begin(options, tmp_path / "run"))


@pytest.mark.parametrize("isolate", ["none", "process"])
def test_a_worker_without_foreign_code_dies_of_the_machine(
    submission: Submission, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, isolate: Any
) -> None:
    monkeypatch.setattr("airhockey.evaluator.evaluation.EpisodePlayer", DiesInTheSecond)
    agent = "hold" if isolate == "none" else submission()
    options = Options(environments=(ENV,), agent=agent, episodes=2, isolate=isolate)
    with pytest.raises(EnvironmentFault, match=r"SIGKILL.*no agent's code ran in it"):
        evaluate(begin(options, tmp_path / "run"), Processes(1))
    assert [record.index for record in read_journal(tmp_path / "run", EpisodeRecord).records] == [0]
    monkeypatch.undo()
    assert evaluate(resume(tmp_path / "run")).agent_errors == 0


@pytest.mark.parametrize(
    ("environment", "modules", "message"),
    [
        ({"NUMBA_DISABLE_JIT": "1"}, {}, "unset NUMBA_DISABLE_JIT"),
        ({}, {"llvmlite.py": "raise OSError('libLLVM.so: cannot open shared object file')"}, "libLLVM.so"),
        ({}, {"mujoco.py": "raise ImportError('libGL.so.1: cannot open')"}, "libGL.so.1"),
    ],
)
@pytest.mark.parametrize("command", ["evaluate --env 3dof-hit --agent hold --jobs 1", "match hold hold --jobs 1"])
def test_an_installation_that_cannot_simulate(
    tmp_path: Path, environment: dict[str, str], modules: dict[str, str], message: str, command: str
) -> None:
    (tmp_path / "path").mkdir()
    for name, content in modules.items():
        (tmp_path / "path" / name).write_text(content)
    line = [sys.executable, "-m", "airhockey.cli", *command.split(), "--out", "run"]
    surroundings = os.environ | environment | {"PYTHONPATH": str(tmp_path / "path")}
    done = subprocess.run(line, cwd=tmp_path, env=surroundings, capture_output=True, text=True)
    assert done.returncode == 4, done.stderr
    assert message in done.stderr and "Traceback" not in done.stderr
    assert not (tmp_path / "run" / "journal.jsonl").exists()

"""`hockey new`, `validate` and `package`, and the submissions of this repository."""

import importlib.util
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from submission_examples import SUBMISSIONS, ZOO
from tools import needs_opencv

from airhockey import envs
from airhockey.agents.packaging.packing import pack
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.play.build_seats import Entrant, build_seats
from airhockey.evaluator.play.seat import Care
from airhockey.evaluator.validation import Trial, try_out, validate

LIMITS = Limits(start=60.0, patience=20.0)


@pytest.mark.parametrize("name", ["template", "thesis", "planner"])
def test_our_submissions_are_packed_validated_and_played(name: str, tmp_path: Path) -> None:
    packed = pack(SUBMISSIONS / name, tmp_path / "packed.zip")
    verdict = validate(packed.path, "none", LIMITS, steps=4)
    assert [problem for problem in verdict.problems if "ms" not in problem.what] == []
    assert {trial.env for trial in verdict.trials} >= {"7dof-hit", "7dof-defend", "7dof-prepare", "tournament"}
    assert all(trial.steps == 4 for trial in verdict.trials)


def test_our_packed_agent_plays_in_the_sandbox(sandbox: None, tmp_path: Path) -> None:
    packed = pack(SUBMISSIONS / "planner", tmp_path / "packed.zip")
    outcome = try_out(Entrant(str(packed.path), isolate="sandbox", limits=LIMITS), "7dof-hit", 20)
    assert isinstance(outcome, Trial) and outcome.steps == 20 and outcome.start < 30.0


@pytest.mark.long
@pytest.mark.parametrize("name", ["template", "thesis"])
def test_our_agents_offer_what_the_official_evaluator_calls(name: str) -> None:
    code = f"""
import sys
from airhockey import compat
compat.install()
sys.path.insert(0, {str(SUBMISSIONS / name)!r})
from air_hockey_challenge.framework import AirHockeyChallengeWrapper
from air_hockey_agent.agent_builder import build_agent
from mushroom_rl.core import Core
env = AirHockeyChallengeWrapper("7dof-hit", interpolation_order=3)
agent = build_agent(env.env_info)
core = Core(agent, env)
dataset = core.evaluate(n_steps=5, quiet=True)
assert len(dataset) == 5 and agent.next_action is None
agent.stop()
"""
    if importlib.util.find_spec("mushroom_rl") is None:
        pytest.skip("needs the extra mushroom")
    needs_opencv()
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)


def problems_of(folder: str | Path, limits: Limits = LIMITS) -> list[tuple[str, str]]:
    verdict = validate(Path(folder), "process", limits, steps=5)
    return [(problem.what, problem.remedy) for problem in verdict.problems]


def test_every_problem_comes_with_its_remedy(bad: Callable[..., str], tmp_path: Path) -> None:
    (what, remedy), *_ = problems_of(tmp_path)
    assert "agent_builder.py" in what and "hockey new" in remedy
    folder = Path(bad(importing="import nowhere_to_be_found"))
    (folder / "submission.yaml").write_text("name: bad\ntasks: [3dof-hit]\npackages: [nowhere-to-be-found>=2]\n")
    (missing, install), (failed, _) = problems_of(folder)
    assert "nowhere-to-be-found>=2" in missing and install == "pip install 'nowhere-to-be-found>=2'"
    assert "neither a file of the submission nor a package known here" in failed and "pip install" not in failed
    folder = Path(bad("return action[0]"))
    (folder / "submission.yaml").write_text("name: bad\ntasks: [3dof-hit]\n")
    ((what, remedy),) = problems_of(folder)
    assert "shape (3,)" in what and "shape" in remedy
    folder = Path(bad("while True: pass"))
    (folder / "submission.yaml").write_text("name: bad\ntasks: [3dof-hit]\ninterpolation_order: 3\n")
    (folder / "agent_config.yml").write_text("interpolation_order: 3\n")
    ((what, remedy),) = problems_of(folder, Limits(start=60.0, patience=0.5))
    assert "did not answer" in what and "--patience" in remedy


def hockey(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "airhockey.cli", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, env=os.environ | {"COLUMNS": "200"})


@pytest.mark.long
def test_the_commands_from_an_idea_to_a_judged_entry(tmp_path: Path) -> None:
    assert hockey(tmp_path, "new", "mine").returncode == 0
    (tmp_path / "mine" / "submission.yaml").write_text("name: mine\ntasks: [3dof-hit]\n")
    packed = hockey(tmp_path, "package", "mine")
    assert packed.returncode == 0 and "mine-0.1.0.zip" in packed.stdout
    verdict = hockey(tmp_path, "validate", "mine-0.1.0.zip", "--steps", "5", "--json", "--isolate", "process")
    assert verdict.returncode == 0 and json.loads(verdict.stdout)["problems"] == []
    arguments = ["--env", "3dof-hit", "--agent", "mine-0.1.0.zip", "--episodes", "2", "--jobs", "1"]
    arguments += ["--json", "--quiet", "--isolate", "process"]
    judged = hockey(tmp_path, "evaluate", *arguments)
    assert judged.returncode == 0 and json.loads(judged.stdout)["agent_errors"] == 0
    again = hockey(tmp_path, "new", "mine")
    assert again.returncode == 2 and len(again.stderr.splitlines()) == 1
    refused = hockey(tmp_path, "validate", "nothing")
    assert refused.returncode == 2


PREPROCESSED = """
import numpy as np

class Agent:
    def __init__(self, env_info):
        self.joints = env_info["joint_pos_ids"]
        self.preprocessors = [lambda observation: np.append(observation, 1.0)]

    def episode_start(self):
        pass

    def draw_action(self, observation):
        position = observation[self.joints] * observation[-1]
        assert observation[-1] == 1.0, "the preprocessor's entry is missing"
        return np.array([position, 0 * position])

def build_agent(env_info, **kwargs):
    return Agent(env_info)
"""


@pytest.mark.parametrize("task", ["3dof-defend", "tournament"])
def test_an_agent_with_preprocessors_is_as_fit_as_the_evaluator_finds_it(tmp_path: Path, task: str) -> None:
    (tmp_path / "agent_builder.py").write_text(PREPROCESSED)
    outcome = try_out(Entrant(str(tmp_path), limits=LIMITS), task, 5)
    assert isinstance(outcome, Trial), outcome
    assert outcome.steps == 5


NEEDS_MUSHROOM = pytest.mark.skipif(importlib.util.find_spec("mushroom_rl") is None, reason="needs the extra mushroom")


@NEEDS_MUSHROOM
def test_a_checkout_plays_what_its_configuration_names_on_both_sides(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ZOO / "no_base_class")
    verdict = validate(Path("."), "process", LIMITS, steps=3)
    assert [trial.env for trial in verdict.trials] == ["3dof-defend", "7dof-hit", "tournament", "tournament (away)"]
    assert verdict.name == "no_base_class" and "\n" not in verdict.conclusion
    slow = [problem for problem in verdict.problems if "ms" in problem.what]  # a busy machine
    assert list(verdict.problems) == slow
    assert verdict.conclusion.startswith("no_base_class: plays 3dof-defend, 7dof-hit, tournament, tournament (away)")
    assert any("layout is the official one" in note for note in verdict.notes)


@NEEDS_MUSHROOM
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("helper_out_of_reach", ["does not play, because", "training/tactics", "the entry's cause", "mend the import"]),
        ("package_missing", ["does not play, because", "this installation's cause", "what to do: install it"]),
        pytest.param("size_one_arrays", ["the libraries' cause", "x.item()", "--python PATH"], marks=pytest.mark.long),
        pytest.param(
            "template_as_it_was",
            ["NotImplementedError", "the entry's cause", "name in env what the agent plays"],
            marks=pytest.mark.long,
        ),
    ],
)
def test_one_line_says_why_whose_cause_and_what_to_do(name: str, words: list[str]) -> None:
    verdict = validate(ZOO / name, "process", LIMITS, steps=3)
    assert verdict.problems and "\n" not in verdict.conclusion
    assert [word for word in words if word not in verdict.conclusion] == []


@pytest.mark.long
@NEEDS_MUSHROOM
def test_the_verdict_says_whose_copy_of_the_package_plays() -> None:
    verdict = validate(ZOO / "own_copy_extended", "process", LIMITS, steps=3)
    assert any("its own copy" in note and "AgentBase.get_puck_history" in note for note in verdict.notes)


def test_an_environment_that_there_is_not_is_named(bad: Callable[..., str]) -> None:
    folder = Path(bad())
    (folder / "agent_config.yml").write_text("env: [7dof-hot]\n")
    verdict = validate(folder, "process", LIMITS, steps=3)
    assert "7dof-hit" in verdict.problems[0].what and verdict.problems[0].where == "env of agent_config.yml"


POINTER = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n"


@pytest.mark.parametrize("place", ["building", "act"])
def test_playing_with_what_git_lfs_has_not_fetched_says_what_validate_says(bad: Callable[..., str], place: str) -> None:
    folder = Path(bad(**{place: "np.load('weights.npy')"}))
    (folder / "weights.npy").write_text(POINTER)
    entrant = Entrant(str(folder), isolate="process", limits=LIMITS)
    env, (seat,) = build_seats(lambda orders: envs.make("3dof-hit", orders[0]), [entrant], Care())
    seat.start()
    observation = env.reset(seed=1)
    for step in range(1, 4):
        seat.act(observation, step)
    seat.close()
    assert seat.failure is not None and "'weights.npy' is not there: git lfs has left a pointer" in seat.failure
    assert seat.failure.endswith("(git lfs pull, in the checkout)")


def test_a_checkout_that_git_lfs_has_not_filled_is_told_so(bad: Callable[..., str]) -> None:
    pointer = POINTER
    folder = Path(bad(building="np.load('weights.npy')"))
    (folder / "agent_config.yml").write_text("env: 3dof-hit\n")
    (folder / "weights.npy").write_text(pointer)
    verdict = validate(folder, "process", LIMITS, steps=2)
    assert "'weights.npy' is not there: git lfs has left a pointer" in verdict.conclusion
    assert "git has not fetched all of it); what to do: git lfs pull" in verdict.conclusion
    builder = folder / "agent_builder.py"
    builder.write_text(builder.read_text().replace("np.load('weights.npy')", "pass"))
    verdict = validate(folder, "process", LIMITS, steps=2)
    assert not verdict.problems and any("git lfs" in note for note in verdict.notes)

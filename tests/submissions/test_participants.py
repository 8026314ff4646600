"""A zoo of entries in the ways that participants wrote them: each plays, at home and away, or is refused for the right cause."""

import importlib.util
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tools

from airhockey import envs
from airhockey.agents.packaging.edition import edition_of_entry
from airhockey.agents.submission import submission_config, wanted_order
from airhockey.envs.editions import DEFAULT
from airhockey.errors import AirHockeyError
from airhockey.evaluator.isolation.build import build_agent
from airhockey.evaluator.isolation.failures import AgentRaised
from airhockey.evaluator.isolation.limits import Limits

pytestmark = pytest.mark.skipif(importlib.util.find_spec("mushroom_rl") is None, reason="needs the extra mushroom")

ZOO = Path(__file__).parent / "zoo"
LIMITS = Limits(start=300.0, patience=60.0)
STEPS = 8

PLAYS = sorted({
    "agent_id_fixed", "answers_of_other_kinds", "array_defaults", "atacom", "compiles_and_caches", "configs_of_all_kinds",
    "data_of_the_package", "environments_of_its_own", "evaluates_itself", "files_opened_late", "helper_packages",
    "kinematics_of_the_model", "limits_changed_in_place", "module_of_the_root", "names_of_2025", "network_of_spaces",
    "no_base_class", "notebooks_beside", "numpy_1", "one_agent_a_task", "optimizer_at_every_step", "order_1", "order_5",
    "order_minus_1", "order_none", "own_copy", "own_copy_extended", "own_copy_with_more", "own_kinematics",
    "paths_of_all_kinds", "planar_only", "pool_of_processes", "preprocessors", "reads_command_line", "relative_files",
    "saved_agent", "source_layout", "spawned_planner", "threaded_planner", "weights_of_a_gpu",
})  # fmt: skip

REFUSED = {
    "file_forgotten": r"imports 'air_hockey_agent.agents\S*', but has no such file",
    "helper_out_of_reach": r"imports 'tactics', which lies at 'training/tactics' in it, .* 'training.tactics'",
    "old_gym": r"imports 'gym', .* OpenAI Gym .* gymnasium .*--python PATH",
    "package_missing": r"imports 'nlopt', which is not installed: pip install nlopt",
    "size_one_arrays": r"TypeError: only 0-dimensional arrays can be converted.*sway.py",
    "submodule_not_fetched": r"in the git submodule 'third_party/learners', whose folder is empty: .* submodule update",
    "template_as_it_was": r"NotImplementedError",
    "wants_a_gpu": r"AssertionError: Torch not compiled with CUDA enabled|CUDA",
    "writes_into_its_folder": r"Read-only file system|Permission denied",
    "wrong_shape": r"the action has shape \(2, 7\); with interpolation order 5 it must be \(3, 7\)",
}


PLAY_HERE = """
import sys
sys.path[:0] = {here!r}
import numpy as np
from pathlib import Path
from test_participants import PLAYS, play, tasks
zoo, told = Path({zoo!r}), {{}}
for name in PLAYS:
    told[name] = list(play(zoo / name, tasks(zoo / name)[0], "none"))
    if "tournament" in tasks(zoo / name):
        told[name + " away"] = list(play(zoo / name, "tournament", "none", side=2))
np.savez({target!r}, **told)
"""


@pytest.fixture(scope="session", autouse=True)
def opencv() -> None:
    """Some entries import MushroomRL, which imports it."""
    tools.needs_opencv()


@pytest.fixture(scope="module")
def zoo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The zoo outside this repository, with the weights that entries would have trained."""
    place = tmp_path_factory.mktemp("entries") / "zoo"
    shutil.copytree(ZOO, place, ignore=shutil.ignore_patterns("__pycache__"))
    for script in sorted(place.glob("*/save_weights.py")):
        code = f"import sys; sys.path.insert(0, '.'); exec(open({script.name!r}).read())"
        subprocess.run([sys.executable, "-c", code], cwd=script.parent, check=True)
    return place


@pytest.fixture(scope="module")
def here(zoo: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What each does without isolation, one after the other in one process: entry -> actions; away games as "NAME away"."""
    target = tmp_path_factory.mktemp("actions") / "here.npz"
    here = [str(Path(__file__).parent), str(Path(tools.__file__).parent)]
    code = PLAY_HERE.format(here=here, zoo=str(zoo), target=str(target))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    return dict(np.load(target))


def tasks(entry: Path) -> list[str]:
    return list(submission_config(entry)["env"])


def play(entry: Path, task: str, mode: str, side: int = 1) -> Iterator[Any]:
    """The actions of a few steps, after which the agent is gone."""
    order = wanted_order(entry)
    game = task == "tournament"
    orders = ((order, 3) if side == 1 else (3, order)) if game else order
    env = envs.make(task, orders, edition=edition_of_entry(entry) or DEFAULT)
    agent = build_agent(str(entry), env, side, mode=mode, limits=LIMITS)  # type: ignore[arg-type]
    try:
        agent.episode_start()
        observation = env.reset(seed=1)
        half = observation.size // 2
        start = np.array(env.simulation.robot.start)
        for _ in range(STEPS):
            mine = observation if not game else observation[:half] if side == 1 else observation[half:]
            action = np.array(agent.act(mine.copy()))
            yield action
            other = np.stack((start, 0.0 * start))
            pair = (action, other) if side == 1 else (other, action)
            observation, *_ = env.step(pair if game else action)
    finally:
        agent.close()


def test_the_lists_are_the_zoo() -> None:
    assert sorted(path.name for path in ZOO.iterdir()) == sorted({*PLAYS, *REFUSED})
    assert len(PLAYS) + len(REFUSED) >= 20


def test_all_play_at_home_and_away(here: dict[str, Any]) -> None:
    assert {name for name in here if not name.endswith(" away")} == set(PLAYS)
    assert sum(name.endswith(" away") for name in here) >= 15
    assert all(len(actions) == STEPS and np.isfinite(actions).all() for actions in here.values())


SANDBOXED = [name for name in PLAYS if name != "threaded_planner"]


@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", SANDBOXED)
def test_one_plays_in_the_sandbox_as_here(zoo: Path, here: dict[str, Any], sandbox: None, name: str) -> None:
    np.testing.assert_array_equal(list(play(zoo / name, tasks(zoo / name)[0], "sandbox")), here[name])


@pytest.mark.long
@pytest.mark.parametrize("name", ["own_copy_extended", "relative_files"])
def test_one_plays_away_in_a_process_and_in_the_sandbox(
    zoo: Path, here: dict[str, Any], sandbox: None, name: str
) -> None:
    for mode in ("process", "sandbox"):
        np.testing.assert_array_equal(list(play(zoo / name, "tournament", mode, side=2)), here[f"{name} away"])


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", REFUSED)
def test_one_is_refused_for_the_right_cause(zoo: Path, sandbox: None, name: str) -> None:
    with pytest.raises(AirHockeyError, match=REFUSED[name]):
        list(play(zoo / name, tasks(zoo / name)[0], "sandbox"))


def test_one_of_the_planar_robot_says_so_elsewhere(zoo: Path, sandbox: None) -> None:
    with pytest.raises(AgentRaised, match="NotImplementedError"):
        list(play(zoo / "planar_only", "7dof-hit", "sandbox"))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", ["helper_packages", "module_of_the_root", "relative_files", "own_copy_with_more"])
def test_a_checkout_is_found_from_its_agents_folder_too(zoo: Path, name: str) -> None:
    entry = zoo / name
    if not any((entry / mark).exists() for mark in ("README.md", "requirements.txt", "air_hockey_challenge")):
        (entry / ".git").mkdir()
    inside = entry / "air_hockey_agent"
    assert len(list(play(inside, tasks(inside)[0], "process"))) == STEPS

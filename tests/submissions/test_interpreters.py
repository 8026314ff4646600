"""An entry in an interpreter of its own, which has NumPy and nothing else of ours: it plays what it plays here."""

import ast
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from submission_examples import ZOO

from airhockey import envs
from airhockey.errors import ConfigurationError
from airhockey.evaluator.isolation.build import build_agent
from airhockey.evaluator.isolation.failures import AgentRaised
from airhockey.evaluator.isolation.interpreters import FOREIGN, interpreter
from airhockey.evaluator.isolation.limits import Limits

LIMITS = Limits(start=120.0, patience=60.0)


@pytest.fixture(scope="module")
def bare(tmp_path_factory: pytest.TempPathFactory) -> str:
    """An environment of this Python with NumPy, a copy of the one here, alone."""
    place = tmp_path_factory.mktemp("bare")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(place)], check=True)
    python = place / "bin" / "python"
    ask = "import sysconfig; print(sysconfig.get_path('purelib'))"
    target = Path(subprocess.run([python, "-c", ask], capture_output=True, text=True, check=True).stdout.strip())
    source = Path(sysconfig.get_path("purelib"))
    for name in ("numpy", "numpy.libs"):
        if (source / name).is_dir():
            shutil.copytree(source / name, target / name, ignore=shutil.ignore_patterns("tests", "__pycache__"))
    return str(python)


def actions(entry: Path, env_name: str, mode: str, python: str | None, steps: int = 6) -> Any:
    env = envs.make(env_name)
    agent = build_agent(str(entry), env, mode=mode, limits=LIMITS, python=python)  # type: ignore[arg-type]
    try:
        agent.episode_start()
        observation, told = env.reset(seed=2), []
        for _ in range(steps):
            told.append(np.array(agent.act(observation)))
            observation, *_ = env.step(told[-1])
        return np.array(told)
    finally:
        agent.close()


@pytest.mark.long
@pytest.mark.parametrize("mode", ["process", "sandbox"])
@pytest.mark.parametrize("name", ["helper_packages", "no_base_class"])
def test_it_plays_there_as_here(bare: str, sandbox: None, name: str, mode: str) -> None:
    np.testing.assert_array_equal(*(actions(ZOO / name, "7dof-defend", mode, python) for python in (bare, None)))


PROBE = """
import numpy as np
from air_hockey_challenge.framework import AgentBase
from air_hockey_challenge.utils import forward_kinematics, inverse_kinematics, jacobian, world_to_robot


class Probe(AgentBase):
    def reset(self):
        pass

    def draw_action(self, observation):
        q = self.get_joint_pos(observation)
        dq = np.linspace(-1.0, 1.0, q.size)
        told = [*self.get_ee_pose(observation)[0], *jacobian(self.robot_model, self.robot_data, q).ravel()]
        for values in (self.env_info["constraints"].fun(q, dq), self.env_info["constraints"].jacobian(q, dq)):
            for name in self.env_info["constraints"].keys():
                told += list(np.ravel(values[name]))
        told += list(forward_kinematics(self.robot_model, self.robot_data, q, "2")[1].ravel())
        found, joints = inverse_kinematics(
            self.robot_model, self.robot_data, self.get_ee_pose(observation)[0] + 0.01, initial_q=q
        )
        told += [float(found), *self.env_info["rl_info"].action_space.high, *self.env_info["rl_info"].shape]
        told += list(world_to_robot(self.env_info["robot"]["base_frame"][0], [0.1, 0.2, 0.0])[0])
        return np.array(told)


def build_agent(env_info, **kwargs):
    return Probe(env_info, **kwargs)
"""


@pytest.mark.sampled(2)
@pytest.mark.parametrize("env_name", ["3dof-hit", "7dof-hit"])
def test_it_is_told_there_what_it_is_told_here(bare: str, tmp_path: Path, env_name: str) -> None:
    pytest.importorskip("mushroom_rl")
    (tmp_path / "agent_builder.py").write_text(PROBE)
    env = envs.make(env_name)
    told = []
    for python in (bare, None):
        agent = build_agent(str(tmp_path), env, mode="process", limits=LIMITS, python=python)
        agent.episode_start()
        told.append(agent.act(env.reset(seed=2)))
        agent.close()
    np.testing.assert_allclose(*told, atol=1e-9)


def test_what_it_raises_names_its_python(bare: str, tmp_path: Path) -> None:
    (tmp_path / "agent_builder.py").write_text("import torch\n")
    with pytest.raises(AgentRaised, match=rf"No module named 'torch'.*Python 3\.{sys.version_info[1]}, NumPy"):
        build_agent(str(tmp_path), envs.make("3dof-hit"), mode="process", limits=LIMITS, python=bare)


def test_what_cannot_run_an_agent_is_refused(tmp_path: Path) -> None:
    for path in (tmp_path / "nothing", Path("/bin/true")):
        with pytest.raises(ConfigurationError, match="no Python interpreter"):
            interpreter(str(path))
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(tmp_path / "empty")], check=True)
    with pytest.raises(ConfigurationError, match="has no NumPy"):
        interpreter(str(tmp_path / "empty" / "bin" / "python"))
    with pytest.raises(ConfigurationError, match="--python is for submissions"):
        build_agent("hold", envs.make("3dof-hit"), mode="process", python=sys.executable)


def test_the_agents_side_is_python_3_8_and_imports_nothing_of_ours() -> None:
    tree = ast.parse(FOREIGN.read_text(), feature_version=(3, 8))
    imported = [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
    imported += [str(node.module) for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    assert {name.partition(".")[0] for name in imported} - set(sys.stdlib_module_names) == {"numpy"}

"""Submissions on disk: examples, and small bad ones."""

import importlib.util
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from submission_examples import EXAMPLES

from airhockey.evaluator.isolation.sandbox import why_no_sandbox

SAVE = """
import sys
from airhockey import compat, envs
compat.install()
sys.path.insert(0, sys.argv[1])
import torch
torch.manual_seed(5)
from air_hockey_agent.agents.striker import Striker
env = envs.make("7dof-hit", 5)
agent = Striker(env.env_info)
agent.gains *= 1.25
agent.save(sys.argv[1] + "/air_hockey_agent/agents/striker.msh")
"""


@pytest.fixture(scope="session")
def sandbox() -> None:
    """Skips where there is none to be had."""
    why = why_no_sandbox()
    if why is not None:
        pytest.skip(why)


@pytest.fixture
def bad(tmp_path: Path) -> Callable[..., str]:
    """Makes a submission whose `draw_action` does what is given at step 3, and whose builder does what is given."""

    def make(act: str = "pass", building: str = "pass", importing: str = "pass") -> str:
        folder = tmp_path / f"bad{len(list(tmp_path.glob('bad*')))}"
        folder.mkdir()
        text = BAD.replace("IMPORTING", importing).replace("BUILDING", building)
        (folder / "agent_builder.py").write_text(text.replace("ACTING", act.replace("\n", "\n            ")))
        return str(folder)

    return make


BAD = """
import ctypes, os, signal, socket, subprocess, sys, tempfile, threading, time
import numpy as np
IMPORTING

class Agent:
    def __init__(self, env_info):
        self.env_info = env_info
        self.joints = env_info["joint_pos_ids"]

    def episode_start(self):
        self.step = 0

    def draw_action(self, observation):
        self.step += 1
        position = observation[self.joints]
        action = np.array([position, 0 * position])
        if self.step == 3:
            ACTING
        return action

def build_agent(env_info, **kwargs):
    BUILDING
    return Agent(env_info)
"""


@pytest.fixture(scope="session")
def striker(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The iiwa example with its saved parameters."""
    if importlib.util.find_spec("mushroom_rl") is None:
        pytest.skip("needs the extra mushroom")
    folder = tmp_path_factory.mktemp("examples") / "iiwa_striker"
    shutil.copytree(EXAMPLES / "iiwa_striker", folder, ignore=shutil.ignore_patterns("__pycache__"))
    subprocess.run([sys.executable, "-c", SAVE, str(folder)], check=True)
    return folder

"""Small agents as submission folders, and short runs of them."""

from collections.abc import Callable
from pathlib import Path

import pytest
from outcomes import ENV

from airhockey.evaluator import Options

BUILDER = """
import os, signal, sys, time
import numpy as np

class Agent:
    def __init__(self, env_info):
        self.joints = env_info["joint_pos_ids"]
        self.episodes = 0

    def episode_start(self):
        self.episodes += 1
        self.steps = 0

    def draw_action(self, observation):
        self.steps += 1
        position = observation[self.joints]
        action = np.array([position + 0.002 * np.random.standard_normal(position.size), 0 * position])
        {behaviour}
        return action

def build_agent(env_info, **kwargs):
    {building}
    return Agent(env_info)
"""


@pytest.fixture
def submission(tmp_path: Path) -> Callable[..., str]:
    """Makes the folder of an agent that trembles at random and besides does what the given line says."""

    def make(behaviour: str = "pass", building: str = "pass", config: str | None = None) -> str:
        folder = tmp_path / f"agent{len(list(tmp_path.glob('agent*')))}"
        folder.mkdir()
        (folder / "agent_builder.py").write_text(BUILDER.format(behaviour=behaviour, building=building))
        if config is not None:
            (folder / "agent_config.yml").write_text(config)
        return str(folder)

    return make


@pytest.fixture
def options(submission: Callable[..., str]) -> Options:
    """A short run of an agent that draws from NumPy's global generator, under disturbances."""
    return Options(environments=(ENV,), agent=submission(), episodes=6, seed=3, disturbances="server")

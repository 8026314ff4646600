"""Small agents as submission folders."""

from pathlib import Path

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


def make_submission(place: Path, behaviour: str = "pass", building: str = "pass", config: str | None = None) -> str:
    """The folder, in `place`, of an agent that trembles at random and besides does what the given lines say."""
    folder = place / f"agent{len(list(place.glob('agent*')))}"
    folder.mkdir()
    (folder / "agent_builder.py").write_text(BUILDER.format(behaviour=behaviour, building=building))
    if config is not None:
        (folder / "agent_config.yml").write_text(config)
    return str(folder)

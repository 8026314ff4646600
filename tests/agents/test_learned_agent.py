"""`learned`: its networks come with cards, defend better than standing still, and others play what they were not trained for."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml

from airhockey import envs
from airhockey.agents import build_agent
from airhockey.agents.learned.agent import FOLDER
from airhockey.agents.learned.player import NETWORK, POLICY, LearnedPlayer
from airhockey.agents.thesis.final import FinalThesisAgent
from airhockey.errors import ConfigurationError

SEEDS = range(100, 108)


def successes(name):
    env = envs.make("7dof-defend", disturbances="server")
    agent, count = build_agent(name, env.env_info), 0
    for seed in SEEDS:
        observation, over = env.reset(seed=seed), False
        agent.episode_start()
        while not over:
            observation, _, over, info = env.step(agent.draw_action(observation))
            assert env.constraint_values.max() <= 0.0
        count += info["success"]
    return count


def test_it_defends_where_standing_still_does_not():
    learned = successes("learned")
    assert learned >= 6 and learned > 2 * successes("hold")


@pytest.mark.parametrize("name", ["7dof-hit", "tournament"])
def test_what_no_network_was_trained_for_is_played_by_another(name):
    assert isinstance(build_agent("learned", envs.make(name).env_info), FinalThesisAgent)


@pytest.mark.parametrize("folder", sorted(FOLDER.iterdir()), ids=lambda folder: folder.name)
def test_every_network_has_its_card(folder):
    card = yaml.safe_load((folder / "card.yaml").read_text())
    assert card["settings"]["task"] == folder.name
    assert card["figures"]["violations"] == 0.0 and card["figures"]["success"] > 0.5
    assert card["command"].startswith("hockey train ppo ") and (folder / NETWORK).stat().st_size < 5e6
    agent = build_agent("learned", envs.make(folder.name).env_info)
    assert isinstance(agent, LearnedPlayer)
    assert agent.draw_action(np.zeros(20)).shape == (2, 7)


@pytest.mark.parametrize(
    "line", ["repeat: 0", "horizon: 0", "repeat: -1", "horizon: .nan", "repeat: [1]", "horizon: .inf"]
)
def test_a_description_that_is_none_is_refused_by_name(tmp_path: Path, line: str) -> None:
    folder = Path(shutil.copytree(FOLDER / "7dof-defend", tmp_path / "player"))
    kept = [one for one in (folder / POLICY).read_text().splitlines() if not one.startswith(line.split(":")[0])]
    (folder / POLICY).write_text("\n".join([*kept, line]))
    with pytest.raises(ConfigurationError, match=POLICY):
        LearnedPlayer.load(folder, envs.make("7dof-defend").env_info)

"""Agents by name and by folder; `hold` for every order; nothing heavy imported before it is needed."""

import subprocess
import sys
import textwrap

import numpy as np
import pytest

from airhockey import envs
from airhockey.agents import AGENTS, build_agent
from airhockey.agents.hold import standing_still
from airhockey.envs.editions import available
from airhockey.errors import ConfigurationError


@pytest.fixture(scope="module")
def env_info():
    return envs.make("7dof-prepare").env_info


def submission(tmp_path, builder, config=None, nested=False):
    folder = tmp_path / "air_hockey_agent" if nested else tmp_path
    folder.mkdir(exist_ok=True)
    (folder / "agent_builder.py").write_text(textwrap.dedent(builder), encoding="utf-8")
    if config is not None:
        (folder / "agent_config.yml").write_text(config, encoding="utf-8")
    return tmp_path


BUILDER = """
    from airhockey.agents.base import AgentBase
    import helper

    class Mine(AgentBase):
        def reset(self): pass
        def draw_action(self, observation): return helper.action(observation)

    def build_agent(env_info, **kwargs):
        agent = Mine(env_info, **kwargs)
        agent.kwargs = kwargs
        return agent
"""


def test_every_entry_is_described():
    for name, entry in AGENTS.items():
        assert entry.name == name and "\n" not in entry.summary
        assert set(entry.environments) == {name for year in available() for name in envs.edition(year).environments}


def test_an_unknown_name_lists_the_agents(env_info):
    with pytest.raises(ConfigurationError, match=r"unknown agent 'thesys'.*thesis"):
        build_agent("thesys", env_info)


@pytest.mark.parametrize("nested", [False, True])
def test_a_folder_is_built_with_its_configuration(tmp_path, env_info, nested):
    path = submission(tmp_path, BUILDER, "interpolation_order: -1\nn_episodes: 7\nmy_gain: 0.5\n", nested)
    home = path / "air_hockey_agent" if nested else path
    (home / "helper.py").write_text("def action(observation):\n    return observation[:7]\n", encoding="utf-8")
    agent = build_agent(path, env_info, my_bias=1)
    assert agent.kwargs == {"my_gain": 0.5, "my_bias": 1}
    assert agent.interpolation_order == -1
    assert agent.draw_action(np.arange(20.0)).shape == (7,)


def test_two_submissions_do_not_mix(tmp_path, env_info):
    agents = []
    for number in (1, 2):
        folder = tmp_path / str(number)
        folder.mkdir()
        builder = f"""
            class Mine:
                number = {number}
                def episode_start(self): pass
                def draw_action(self, observation): return observation
            def build_agent(env_info, **kwargs):
                return Mine()
        """
        agents.append(build_agent(submission(folder, builder), env_info))
    assert [agent.number for agent in agents] == [1, 2]


@pytest.mark.parametrize(
    ("builder", "config", "error", "message"),
    [
        ("x = 1", None, ConfigurationError, "defines no function build_agent"),
        ("1 / 0", None, ConfigurationError, "ZeroDivisionError"),
        ("import no_such_package", None, ConfigurationError, "no_such_package.*neither a file of the submission"),
        ("def build_agent(env_info): return 3", None, ConfigurationError, "without draw_action"),
        ("def build_agent(env_info): return 3", "[1, 2]", ConfigurationError, "must hold a mapping"),
        ("def build_agent(env_info): return 3", "a: [", ConfigurationError, "is not valid YAML"),
    ],
)
def test_a_folder_that_cannot_be_used_says_why(tmp_path, env_info, builder, config, error, message):
    with pytest.raises(error, match=message):
        build_agent(submission(tmp_path, builder, config), env_info)


def test_an_empty_folder_has_no_agent(tmp_path, env_info):
    with pytest.raises(ConfigurationError, match="neither it nor its sub-folder"):
        build_agent(tmp_path, env_info)


@pytest.mark.parametrize(
    ("order", "shape"), [(1, (7,)), (2, (7,)), (3, (2, 7)), (4, (2, 7)), (5, (3, 7)), (-1, (2, 7)), (None, (20, 3, 7))]
)
def test_standing_still_in_every_order(order, shape):
    q = np.arange(7.0)
    action = standing_still(q, order)
    assert action.shape == shape
    positions = action if action.ndim == 1 else action[..., 0, :]
    assert np.all(positions == q)
    assert action.sum() == pytest.approx(q.sum() * (20 if order is None else 1))


def test_hold_holds_the_first_observation_until_the_next_serve(env_info):
    agent = build_agent("hold", env_info)
    agent.episode_start()
    first = np.arange(20.0)
    action = agent.draw_action(first)
    action[:] = 9.0  # the caller may do what it likes with it
    np.testing.assert_array_equal(agent.draw_action(first + 1)[0], first[6:13])
    agent.episode_start()
    np.testing.assert_array_equal(agent.draw_action(first + 1)[0], first[6:13] + 1)


def test_importing_the_agents_imports_nothing_heavy():
    code = (
        "import sys, airhockey.agents as a; list(a.AGENTS); "
        "print([m for m in ('mujoco', 'numba', 'pinocchio', 'mushroom_rl', 'torch') if m in sys.modules])"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"

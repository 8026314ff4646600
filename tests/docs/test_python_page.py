"""The programs on the page about Python run."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tools import needs_opencv, needs_rendering

from airhockey import envs

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "python.md"
PROGRAMS = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text("utf-8"), re.MULTILINE | re.DOTALL)
ENVIRONMENT, PLANNING, AGENT, MUSHROOM, GYMNASIUM, PICTURE, BATCH, BATCH_OF_OTHERS = PROGRAMS


def test_the_program_with_an_environment(capsys: pytest.CaptureFixture[str]) -> None:
    exec(ENVIRONMENT, {})
    assert capsys.readouterr().out in ("goal!\n", "no goal\n")


def test_the_program_that_plans() -> None:
    names: dict[str, Any] = {}
    exec(PLANNING, names)
    env, twin, action = names["env"], names["twin"], names["action"]
    assert len(set(names["violations"])) == 5
    assert env.step_count == twin.step_count == 0
    assert env.step(action)[0].tobytes() == twin.step(action)[0].tobytes()


def test_the_agent_stays_where_it_is() -> None:
    names: dict[str, Any] = {}
    exec(AGENT, names)
    env = envs.make("3dof-defend")
    agent = names["Still"](env.env_info)
    agent.episode_start()
    observation = env.reset(seed=0)
    first, _ = agent.draw_action(observation)
    for _ in range(5):
        action = agent.draw_action(observation)
        observation, *_ = env.step(action)
    assert np.array_equal(action, [first, np.zeros(3)])


def test_the_program_with_mushroom_rl() -> None:
    needs_opencv()
    pytest.importorskip("mushroom_rl")
    names: dict[str, Any] = {}
    exec(MUSHROOM, names)
    assert -3.0 <= names["reward"] <= -0.5  # a puck comes at 1 to 3 m/s


def test_the_program_with_gymnasium() -> None:
    pytest.importorskip("gymnasium")
    names: dict[str, Any] = {}
    exec(GYMNASIUM, names)
    assert names["observation"].shape == names["env"].observation_space.shape
    names["env"].close()


def test_the_program_with_a_picture() -> None:
    pytest.importorskip("gymnasium")
    needs_rendering()
    names: dict[str, Any] = {}
    exec(GYMNASIUM + PICTURE, names)
    assert names["picture"].shape == (360, 640, 3)


def test_the_program_with_a_batch() -> None:
    names: dict[str, Any] = {}
    exec(BATCH, names)
    alone = envs.make("7dof-hit", disturbances="server")
    joints = alone.reset(seed=7)[names["vec"].single.env_info["joint_pos_ids"]]
    for _ in range(10):
        observation, *_ = alone.step(np.stack((joints, 0 * joints)))
    assert names["batch"].observations[7].tobytes() == observation.tobytes()


def test_the_program_with_others_batches() -> None:
    pytest.importorskip("stable_baselines3")
    names: dict[str, Any] = {}
    exec(BATCH_OF_OTHERS, names)
    assert names["vec_for_sb3"].num_envs == 8
    names["vec"].close()

"""Submissions in the style of 2023 run unchanged, wherever they live, with the same results."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from submission_examples import EXAMPLES

from airhockey.envs.disturbances import load_disturbances
from airhockey.evaluator import Options
from airhockey.evaluator.play.episode import EpisodePlayer
from airhockey.evaluator.runs.records import Episode, Job

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("mushroom_rl") is None, reason="the compatibility layer needs the extra mushroom"
)


def first_episodes(agent: Path, env: str, mode: str) -> list[Episode]:
    options = Options(environments=(env,), agent=str(agent), episodes=2, seed=7, disturbances="server", isolate=mode)
    player = EpisodePlayer(options, load_disturbances("server"))
    try:
        return [player(Job(env, index)) for index in range(2)]
    finally:
        player.close()


def assert_the_same(env: str, agent: Path) -> list[Episode]:
    here, process, sandbox = (first_episodes(agent, env, mode) for mode in ("none", "process", "sandbox"))
    for one, *others in zip(here, process, sandbox, strict=True):
        assert one.record.error is None
        for other in others:
            assert other.record.error is None
            assert other.record.success == one.record.success and other.record.violations == one.record.violations
            for name in ("observations", "actions", "rewards"):
                np.testing.assert_array_equal(other.trajectory[name], one.trajectory[name])
    return here


@pytest.mark.long
def test_the_planar_hitting_agent_plays_the_same_in_every_mode(sandbox: None) -> None:
    episodes = assert_the_same("3dof-hit", EXAMPLES / "planar_hitting")
    moved = [np.ptp(episode.trajectory["true_observations"][:, 0]) for episode in episodes]
    assert max(moved) > 0.1  # it hits the puck


@pytest.mark.long
def test_the_iiwa_agent_with_saved_parameters_plays_the_same_in_every_mode(sandbox: None, striker: Path) -> None:
    episodes = assert_the_same("7dof-hit", striker)
    assert episodes[0].trajectory["actions"].shape[1:] == (3, 7)


def test_the_package_is_there_only_for_submissions() -> None:
    code = """
import importlib.util
import airhockey.agents, airhockey.evaluator.play.episode
assert importlib.util.find_spec("air_hockey_challenge") is None
from airhockey import compat
assert importlib.util.find_spec("air_hockey_challenge") is None
compat.install()
assert importlib.util.find_spec("air_hockey_challenge.utils.kinematics") is not None
import sys
assert "mushroom_rl" not in sys.modules and "torch" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_kinematics_agree_with_finite_differences() -> None:
    code = """
import numpy as np
from airhockey import compat, envs
compat.install()
from air_hockey_challenge.utils import forward_kinematics, inverse_kinematics, jacobian, robot_to_world, world_to_robot
for name, link in (("3dof-hit", "ee"), ("7dof-hit", "ee"), ("7dof-hit", "4")):
    info = envs.make(name).env_info
    model, data = info["robot"]["robot_model"], info["robot"]["robot_data"]
    q = np.linspace(-0.4, 0.5, model.nq)
    slope, h = jacobian(model, data, q, link), 1e-6
    for k in range(q.size):
        d = np.zeros(q.size); d[k] = h
        ahead, behind = (forward_kinematics(model, data, q + s * d, link)[0] for s in (1, -1))
        np.testing.assert_allclose(slope[:3, k], (ahead - behind) / (2 * h), atol=1e-8)
    where, turn = forward_kinematics(model, data, q)
    found, joints = inverse_kinematics(model, data, where, None, q + 0.05)
    assert found and np.linalg.norm(forward_kinematics(model, data, joints)[0] - where) < 1e-4
    base = info["robot"]["base_frame"][0]
    back = world_to_robot(base, *robot_to_world(base, where, turn))
    np.testing.assert_allclose(back[0], where); np.testing.assert_allclose(back[1], turn)
"""
    subprocess.run([sys.executable, "-c", code], check=True)

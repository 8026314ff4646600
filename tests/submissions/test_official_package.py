"""Every public module of the challenge's package can be imported, and does what it says."""

import importlib
import importlib.util
import json
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from arms import striker_angles
from tools import needs_opencv

from airhockey import compat, envs
from airhockey.compat.finder import Finder

pytestmark = pytest.mark.skipif(importlib.util.find_spec("mushroom_rl") is None, reason="needs the extra mushroom")


@pytest.fixture(autouse=True)
def opencv() -> None:
    """MushroomRL imports it."""
    needs_opencv()


MODULES = {
    "": (),
    "constraints": ("ConstraintList", "EndEffectorConstraint", "JointPositionConstraint", "LinkConstraint"),
    "constraints.constraints": ("Constraint", "JointVelocityConstraint"),
    "environments": ("IiwaPositionHit", "PlanarPositionDefend"),
    "environments.iiwas": ("AirHockeyHit", "AirHockeyDefend", "AirHockeyPrepare", "AirHockeyTournament"),
    "environments.iiwas.env_base": ("AirHockeyBase",),
    "environments.iiwas.env_single": ("AirHockeySingle",),
    "environments.iiwas.env_double": ("AirHockeyDouble",),
    "environments.iiwas.env_hit": ("AirHockeyHit",),
    "environments.iiwas.env_defend": ("AirHockeyDefend",),
    "environments.iiwas.env_prepare": ("AirHockeyPrepare",),
    "environments.iiwas.env_tournament": ("AirHockeyTournament",),
    "environments.planar": ("AirHockeyHit", "AirHockeyDefend"),
    "environments.planar.base": ("AirHockeyBase",),
    "environments.planar.single": ("AirHockeySingle",),
    "environments.planar.hit": ("AirHockeyHit",),
    "environments.planar.defend": ("AirHockeyDefend",),
    "environments.position_control_wrapper": ("PositionControlIIWA", "PositionControlPlanar", "IiwaPositionTournament"),
    "framework": ("AgentBase", "AirHockeyChallengeWrapper", "ChallengeCore"),
    "framework.agent_base": ("AgentBase",),
    "framework.air_hockey_challenge_wrapper": ("AirHockeyChallengeWrapper",),
    "framework.challenge_core": ("ChallengeCore",),
    "framework.evaluate_agent": ("evaluate",),
    "framework.evaluate_tournament": ("run_tournament",),
    "utils": ("forward_kinematics", "inverse_kinematics", "jacobian", "robot_to_world", "world_to_robot"),
    "utils.kinematics": ("forward_kinematics", "inverse_kinematics", "jacobian", "link_to_xml_name"),
    "utils.replay_dataset": ("replay_dataset",),
    "utils.tournament_agent_server": ("TournamentAgentServer",),
    "utils.tournament_agent_wrapper": ("SimpleTournamentAgentWrapper", "RemoteTournamentAgentWrapper"),
    "utils.transformations": ("robot_to_world", "world_to_robot"),
    "utils.universal_joint_plugin": ("UniversalJointPlugin",),
}


@pytest.fixture(scope="module", autouse=True)
def package() -> Iterator[None]:
    """The package is there for these tests, and gone afterwards."""
    compat.install()
    before = np.random.get_state()
    yield
    np.random.set_state(before)
    sys.meta_path[:] = [finder for finder in sys.meta_path if not isinstance(finder, Finder)]
    for name in [name for name in sys.modules if name.partition(".")[0] == "air_hockey_challenge"]:
        del sys.modules[name]


def official(name: str) -> Any:
    return importlib.import_module(f"air_hockey_challenge.{name}" if name else "air_hockey_challenge")


@pytest.mark.parametrize("name", MODULES)
def test_a_module_is_there_with_its_names(name: str) -> None:
    module = official(name)
    assert [missing for missing in MODULES[name] if not callable(getattr(module, missing, None))] == []


POSITION = {
    "PlanarPositionHit": "3dof-hit",
    "PlanarPositionDefend": "3dof-defend",
    "IiwaPositionHit": "7dof-hit",
    "IiwaPositionDefend": "7dof-defend",
    "IiwaPositionPrepare": "7dof-prepare",
    "IiwaPositionTournament": "tournament",
}


@pytest.mark.parametrize("name", POSITION)
def test_a_base_environment_moves_as_the_wrapped_one(name: str) -> None:
    np.random.seed(3)
    base = getattr(official("environments"), name)(interpolation_order=3)
    seen = base.reset()
    np.random.seed(3)
    wrapped = envs.AirHockeyChallengeWrapper(POSITION[name])
    np.testing.assert_allclose(seen, wrapped.reset(), atol=1e-12)
    for k in range(1, 40):
        q = base.init_state + 0.1 * np.sin(0.1 * k)
        action: Any = np.stack((q, 0.0 * q))
        if name.endswith("Tournament"):
            action = (action, action)
        (seen, reward, absorbing, _), theirs = base.step(action), wrapped.step(action)
        np.testing.assert_allclose(seen, theirs[0], atol=1e-12)
        assert (reward, absorbing) == (0.0, theirs[2])
        if absorbing:
            break


@pytest.mark.parametrize("place", ["iiwas.env_single", "planar.single"])
def test_an_environment_of_ones_own_is_moved_by_torques(place: str) -> None:
    single = official(f"environments.{place}").AirHockeySingle

    class Pushed(single):  # type: ignore[misc]
        def setup(self, obs: Any) -> None:
            super().setup(obs)
            self._write_data("puck_x_pos", 0.3)
            self._write_data("puck_x_vel", 0.5)

        def reward(self, state: Any, action: Any, next_state: Any, absorbing: bool) -> float:
            return float(next_state[0] - state[0])

    env = Pushed(horizon=100)
    observation = env.reset()
    n = env.env_info["robot"]["n_joints"]
    assert env.info.horizon == 100 and observation.shape == (6 + 2 * n,)
    np.testing.assert_allclose(observation[:4], [1.81, 0.0, 0.0, 0.5])
    moved = 0.0
    for _ in range(10):
        mujoco.mj_forward(env._model, env._data)  # the weight that the motors carry
        observation, reward, absorbing, _ = env.step(env._data.qfrc_bias[:n].copy())
        moved += reward
        assert not absorbing
    assert moved == pytest.approx(0.5 * 0.2, rel=0.06)  # slower by its damping
    np.testing.assert_allclose(observation[6 : 6 + n], env.init_state, atol=0.02)
    assert env.get_ee()[0].shape == (3,) and env.get_joints(env._obs, 1)[0].shape == (n,)


def test_the_universal_joint_keeps_the_mallet_level() -> None:
    plugin = official("utils.universal_joint_plugin")
    kinematics = official("utils.kinematics")
    env = official("environments.iiwas.env_single").AirHockeySingle()
    env.reset()
    robot = env.env_info["robot"]
    _, rotation = kinematics.forward_kinematics(robot["robot_model"], robot["robot_data"], env.init_state)
    np.testing.assert_allclose(
        plugin.level_angles(rotation[:, 0], rotation[:, 1]), striker_angles(rotation[:, 0], rotation[:, 1])
    )
    for k in range(25):
        mujoco.mj_forward(env._model, env._data)
        swing = np.array([0.0, 0.0, 0.0, 3.0 * np.sin(0.5 * k), 0.0, 0.0, 0.0])
        env.step(env._data.qfrc_bias[:7] + swing)
    axis = env._data.body("iiwa_1/striker_mallet").xmat.reshape(3, 3)[:, 2]
    assert abs(axis[2]) > 0.995


def holding(env_info: dict[str, Any], **kwargs: Any) -> Any:
    """An agent of the official interface that holds its joints; also a builder for other processes."""
    base = official("framework.agent_base").AgentBase

    class Holding(base):  # type: ignore[misc]
        def reset(self) -> None:
            self.q = None

        def draw_action(self, observation: Any) -> Any:
            self.q = self.get_joint_pos(observation) if self.q is None else self.q
            return np.stack((self.q, 0.0 * self.q))

    return Holding(env_info, **kwargs)


def test_the_core_lets_agents_play_and_measures_them() -> None:
    core = official("framework.challenge_core").ChallengeCore
    env = envs.AirHockeyChallengeWrapper("7dof-defend")
    dataset, info = core(holding(env.env_info), env).evaluate(n_steps=7, quiet=True, get_env_info=True)
    assert len(dataset) == 7 and all(len(sample) == 6 for sample in dataset)
    assert len(info["computation_time"]) == 7 and max(info["computation_time"]) < 1.0
    start = env._env.base_observation
    again = core(holding(env.env_info), env, init_state=start).evaluate(n_episodes=1, quiet=True)
    assert again[0][0][0] == pytest.approx(start[0] + 1.51)


def test_two_agents_are_one_in_a_tournament_and_the_late_one_holds() -> None:
    env = envs.AirHockeyChallengeWrapper("tournament")
    wrapper = official("utils.tournament_agent_wrapper").SimpleTournamentAgentWrapper
    home, away = holding(env.env_info), holding(env.env_info)
    agent = wrapper(env.env_info, home, away)
    late = iter([False, False, True, False])
    draw = away.draw_action

    def slow(observation: Any) -> Any:
        action = draw(observation)
        if next(late):
            threading.Event().wait(0.03)
            action = action + 0.05
        return action

    away.draw_action = slow
    core = official("framework.challenge_core").ChallengeCore(agent, env, is_tournament=True)
    dataset, info = core.evaluate(n_steps=4, quiet=True, get_env_info=True)
    assert [spent[1] > 0.02 for spent in info["computation_time"]][2]
    np.testing.assert_array_equal(dataset[2][1][1][0], dataset[1][1][1][0])
    assert np.all(dataset[2][1][1][1] == 0.0)


def test_an_agent_is_served_and_reached() -> None:
    env = envs.AirHockeyChallengeWrapper("tournament")
    server = official("utils.tournament_agent_server")
    servers = [server.TournamentAgentServer(holding(env.env_info), port=0) for _ in range(2)]
    threads = [threading.Thread(target=one.run, args=(1,), daemon=True) for one in servers]
    for thread in threads:
        thread.start()
    remote = official("utils.tournament_agent_wrapper").RemoteTournamentAgentWrapper
    agent = remote(env.env_info, *((one.host, one.port) for one in servers))
    agent.episode_start()
    seen = env.reset()
    for half, action in zip(np.split(seen, 2), agent.draw_action(seen), strict=True):
        np.testing.assert_array_equal(action, [half[6:13], np.zeros(7)])
    agent.agent_1._socket.close()
    agent.agent_2._socket.close()
    for thread in threads:
        thread.join(5.0)
        assert not thread.is_alive()


BUILDER = """
import numpy as np
from air_hockey_challenge.framework import AgentBase

class Holding(AgentBase):
    def __init__(self, env_info, lift=0.0, **kwargs):
        super().__init__(env_info, **kwargs)
        self.lift = lift
    def reset(self):
        self.q = None
    def draw_action(self, observation):
        self.q = self.get_joint_pos(observation) + self.lift if self.q is None else self.q
        return np.stack((self.q, 0 * self.q))

def make_it(env_info, **kwargs):
    return Holding(env_info, **kwargs)
"""


@pytest.mark.long
def test_an_official_evaluation_leaves_the_official_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "my_own_builder.py").write_text(BUILDER)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.chdir(tmp_path)
    make_it = importlib.import_module("my_own_builder").make_it
    evaluate = official("framework.evaluate_agent").evaluate
    place = evaluate(make_it, tmp_path / "log", ["3dof-hit", "defend"], n_episodes=2, n_cores=1, seed=4, lift=0.01)
    results = json.loads((place / "results.json").read_text())
    assert {"3dof-hit", "7dof-defend"} <= set(results)
    for env in ("3dof-hit", "7dof-defend"):
        assert (place / env / "dataset.pkl").is_file() and (place / env / "computation_time.npy").is_file()
    games = official("framework.evaluate_tournament").run_tournament(
        make_it, None, tmp_path / "games", steps_per_game=60
    )
    assert (games / "result.json").is_file() or any(games.iterdir())

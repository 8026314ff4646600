"""Networks without torch, the skills that come with the package, and the player made of them."""

import subprocess
import sys

import numpy as np
import pytest
import yaml

from airhockey import envs
from airhockey.agents import build_agent
from airhockey.agents.atacom.controller import AtacomController
from airhockey.agents.atacom.features import (
    ACTION_MIRROR,
    DEFEND_MIRROR,
    HOME_MIRROR,
    HORIZON,
    LINE,
    crossing,
    defend_features,
    home_features,
)
from airhockey.agents.atacom.learned import FOLDER, LearnedSkill, trained
from airhockey.agents.atacom.network import Network
from airhockey.agents.atacom.skill import DEFEND, HOME_SKILL, REPEAT
from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.estimation.motion import advance, puck_motion
from airhockey.agents.skill import Situation
from airhockey.agents.table import HOME, to_table
from airhockey.envs.specs import IIWA
from airhockey.errors import ConfigurationError

NETWORKS = sorted(FOLDER.glob("*.npz"))


def small_network(inputs=3, outputs=2, hidden=4):
    random = np.random.default_rng(0)
    shapes = {"weight_0": (hidden, inputs), "bias_0": (hidden,), "weight_1": (outputs, hidden), "bias_1": (outputs,)}
    return Network({name: random.normal(size=shape).astype(np.float32) for name, shape in shapes.items()})


def test_a_network_is_what_its_formula_says():
    one = np.float32(1.0)
    network = Network(
        {
            "weight_0": np.array([[1.0, -1.0], [-1.0, 1.0]]),
            "bias_0": np.array([0.5, 0.0]),
            "weight_1": np.array([[2.0, 3.0]]),
            "bias_1": np.array([-1.0]),
        }
    )
    np.testing.assert_allclose(network(np.array([one, 0.25 * one])), np.tanh([2.0 * 1.25 - 1.0]), rtol=1e-6)


def test_a_network_comes_back_from_its_file(tmp_path):
    network = small_network()
    (tmp_path / "n.npz").write_bytes(network.as_bytes())
    again = Network.load(tmp_path / "n.npz")
    np.testing.assert_array_equal(network(np.ones(3, np.float32)), again(np.ones(3, np.float32)))
    assert (again.inputs, again.outputs) == (3, 2)


@pytest.mark.parametrize(
    ("arrays", "complaint"),
    [
        ({"weight_0": np.zeros((2, 3))}, "weight_0"),
        ({"weight_0": np.zeros((2, 3)), "bias_0": np.zeros(3)}, "does not fit"),
        ({"weight_0": np.full((2, 3), np.nan), "bias_0": np.zeros(2)}, "not finite"),
        ({"weight_0": np.array([object()]), "bias_0": np.zeros(2)}, "cannot read"),
    ],
)
def test_a_bad_file_is_refused(tmp_path, arrays, complaint):
    np.savez(tmp_path / "bad.npz", **arrays)
    with pytest.raises(ConfigurationError, match=complaint):
        Network.load(tmp_path / "bad.npz")


def test_a_file_that_is_none_or_too_large_is_refused(tmp_path):
    (tmp_path / "text.npz").write_text("no network")
    with pytest.raises(ConfigurationError, match="cannot read"):
        Network.load(tmp_path / "text.npz")
    (tmp_path / "large.npz").write_bytes(bytes(500_001))
    with pytest.raises(ConfigurationError, match="500000 bytes"):
        Network.load(tmp_path / "large.npz")


def test_a_network_for_something_else_is_refused(tmp_path):
    (tmp_path / "n.npz").write_bytes(small_network().as_bytes())
    with pytest.raises(ConfigurationError, match="maps 3 numbers to 2; defend needs 16 to 2"):
        trained("defend", "7dof", tmp_path / "n.npz")
    with pytest.raises(ConfigurationError, match="nowhere"):
        trained("defend", "7dof", tmp_path / "nowhere.npz")


def test_features_in_a_mirror():
    puck, tip, velocity = np.array([0.2, 0.1, -1.5, 0.4, 3.0]), np.array([-0.8, 0.05]), np.array([0.2, -0.1])
    there, back = np.array([1.0, -1.0, 1.0, -1.0, -1.0]), ACTION_MIRROR
    seen = defend_features(puck, tip, velocity)
    np.testing.assert_allclose(
        defend_features(there * puck, back * tip, back * velocity), DEFEND_MIRROR * seen, atol=1e-6
    )
    seen = home_features(puck, tip, velocity)
    np.testing.assert_allclose(home_features(there * puck, back * tip, back * velocity), HOME_MIRROR * seen, atol=1e-6)


def test_a_crossing_is_where_the_puck_will_be():
    state, constants = np.array([0.3, 0.2, -2.0, 1.5, 0.0]), puck_motion().constants  # bounces once on its way
    time, y, x_speed, y_speed = crossing(state, LINE, HORIZON, constants)
    later = state.copy()
    advance(later, time, constants)
    np.testing.assert_allclose(later[:4], [LINE, y, x_speed, y_speed], atol=0.012)
    assert crossing(np.array([0.3, 0.0, 1.0, 0.0, 0.0]), LINE, HORIZON, constants)[0] >= HORIZON


def seen(puck, tip=HOME, tip_velocity=np.zeros(2)):  # noqa: B008 - nobody writes to it
    return Situation(PuckEstimate(puck, np.eye(5), 0), tip, tip_velocity)


def test_a_skill_acts_every_so_many_steps_and_rests_when_it_is_done():
    controller, calls = AtacomController(IIWA), []

    class Watched(Network):
        def __call__(self, features):
            calls.append(features)
            return np.array([0.0, 1.0], dtype=np.float32)

    network = Watched({"weight_0": np.zeros((2, 16)), "bias_0": np.zeros(2)})
    learned = LearnedSkill(DEFEND, network, controller)
    calls.clear()
    coming, gone = np.array([0.2, 0.0, -1.0, 0.0, 0.0]), np.array([-0.5, 0.0, 0.2, 0.0, 0.0])
    tips = []
    for _ in range(6):
        learned.act(seen(coming))
        tips.append(controller.tip_velocity[1])
    assert len(calls) == 6 / REPEAT
    assert tips[-1] > 0.3
    for _ in range(40):
        learned.act(seen(gone))
    assert learned.finished and len(calls) == 6 / REPEAT
    assert abs(controller.tip_velocity).max() < 1e-2


@pytest.mark.parametrize("path", NETWORKS, ids=lambda path: path.stem)
def test_a_trained_skill_is_small_has_a_card_and_fits(path):
    task, robot = path.stem.split("_")
    trained(task, robot)
    assert path.stat().st_size <= 500_000
    card = yaml.safe_load(path.with_suffix(".yaml").read_text(encoding="utf-8"))
    assert {"data", "settings", "figures", "versions", "made"} <= set(card)
    assert (card["settings"]["task"], card["settings"]["robot"]) == (task, robot)
    assert card["figures"]["violations"] < 0.01


def test_skills_of_both_kinds_come_with_the_package():
    assert {"defend_7dof", "home_7dof"} <= {path.stem for path in NETWORKS}


@pytest.mark.parametrize("name", envs.ENVIRONMENTS)
def test_the_final_player_plays_everywhere_within_the_constraints(name):
    env = envs.make(name, disturbances="server")
    players = [build_agent("thesis-final", env.env_info, agent_id=k + 1) for k in range(env.n_players)]
    observation = env.reset(seed=5)
    half = observation.size // env.n_players
    for player in players:
        player.episode_start()
    for _ in range(150):
        actions = [player.draw_action(observation[k * half : (k + 1) * half]) for k, player in enumerate(players)]
        observation, _, over, _ = env.step(actions[0] if len(players) == 1 else tuple(actions))
        assert env.constraint_values.max() <= 0.0
        if over:
            break


def test_the_final_player_defends_with_its_network():
    env = envs.make("7dof-defend")
    agent = build_agent("thesis-final", env.env_info)
    successes, phases = 0, set()
    for episode in range(12):
        agent.episode_start()
        observation, over = env.reset(seed=1000 + episode), False
        while not over and env.step_count < env.horizon:
            observation, _, over, info = env.step(agent.draw_action(observation))
            phases.add(agent.phase)
            assert env.constraint_values.max() <= 0.0
        successes += info["success"]
    assert successes >= 9
    assert {"defend learned", "defend rest"} <= phases


def test_the_way_home_is_learned_and_arrives():
    random, arrived = np.random.default_rng(0), 0
    controller = AtacomController(IIWA)
    learned = LearnedSkill(HOME_SKILL, trained("home", "7dof"), controller)
    puck = np.array([0.6, 0.3, 0.0, 0.0, 0.0])
    for _ in range(10):
        controller.reset(np.array(IIWA.start))
        for action in random.uniform(-1.0, 1.0, (4, 2)):
            for _ in range(15):
                controller.step(action)
        learned.begin(seen(puck))
        for _ in range(150):
            learned.act(seen(puck, to_table(controller.tip), controller.tip_velocity))
        arrived += learned.finished
    assert arrived >= 9


def test_the_final_player_needs_no_torch():
    code = (
        "import sys; sys.modules.update(dict.fromkeys(['torch', 'gymnasium', 'stable_baselines3']))\n"
        "from airhockey import envs; from airhockey.agents import build_agent\n"
        "env = envs.make('7dof-defend'); agent = build_agent('thesis-final', env.env_info)\n"
        "agent.episode_start(); env.step(agent.draw_action(env.reset(seed=0)))\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)

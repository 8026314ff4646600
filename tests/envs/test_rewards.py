"""The thesis's rewards, against cases worked out by hand."""

import math

import numpy as np
import pytest

from airhockey import envs
from airhockey.envs.tasks import TaskReward, hit, reward_for
from airhockey.envs.tasks.hit import HitReward, met
from airhockey.envs.tasks.positions import PuckAndMallet, puck_and_mallet
from airhockey.envs.tasks.reward import normalized_violated_constraints
from airhockey.errors import ConfigurationError

POINTS = {"joint_pos_constr": 2.0, "joint_vel_constr": 1.0, "ee_constr": 3.0, "link_constr": 3.0}


def puck_state(env, x, y, vx, vy):
    """The start's base observation with another puck."""
    env.reset(seed=1)
    rows = env.base_observation.reshape(env.n_agents, -1)
    rows[:, :6] = (x, y, 0.0, vx, vy, 0.0)
    return rows.ravel()


def stand(env):
    """The action that stays where the episode begins."""
    start = np.array(env.simulation.robot.start)
    return np.stack((start, np.zeros_like(start)))


def run(env, reward, state, steps=500):
    """The terms of an episode in which the robot stands still."""
    env.reset(seed=1, state=state)
    before, terms = env.base_observation, []
    for _ in range(steps):
        _, _, absorbing, _ = env.step(stand(env))
        reward(env, before, None, env.base_observation, absorbing)
        before = env.base_observation
        terms.append(dict(reward.terms))
        if absorbing:
            break
    return terms


def test_violations_are_weighted_by_penalty_points_and_averaged_over_the_violated_ones():
    values = {
        "joint_pos_constr": np.array([-1.0, 0.2, 0.4]),  # mean of the positive ones 0.3, times 2
        "joint_vel_constr": np.array([-0.1, -0.2]),
        "ee_constr": np.array([0.06, -3.0]),  # 0.06, times 3
        "link_constr": np.array([-0.5]),
    }
    assert normalized_violated_constraints(values, POINTS) == pytest.approx((0.6 + 0.18) / 9.0)
    planar = {name: values[name] for name in ("joint_pos_constr", "joint_vel_constr", "ee_constr")}
    assert normalized_violated_constraints(planar, POINTS) == pytest.approx(0.78 / 6.0)


def test_the_thesiss_own_example_of_a_slack():
    """4.1.3: a value of 0.3 where the limit is 0.25 is a σ of 0.05; alone it weighs 3 of 9 points."""
    values = {name: np.array([-1.0]) for name in POINTS} | {"link_constr": np.array([0.3 - 0.25])}
    assert normalized_violated_constraints(values, POINTS) == pytest.approx(0.05 * 3.0 / 9.0)


def test_approach_is_the_distance_in_half_diagonals():
    diagonal = math.sqrt(1.948**2 + 1.038**2)
    got = hit.approach(np.array([-0.8, 0.1]), np.array([-0.5, 0.5]))  # 0.5 m apart
    assert got == pytest.approx(-0.5 / (0.5 * diagonal))


@pytest.mark.parametrize(
    ("velocity", "expected"),
    [
        ((2.0, 0.0), 100.0 + 10.0 * 2.0 / 20.0),  # straight ahead: α = 0
        ((0.0, 2.0), 100.0),  # sideways: α = π/2, the bracket is 0
        ((1.0, 1.0), 100.0 + 10.0 * 0.75 * math.sqrt(2.0) / 20.0),  # α = π/4: 1 − 1/4
        ((-1.0, 0.0), 100.0 - 30.0 / 20.0),  # backwards: α = π, 1 − 4
    ],
)
def test_a_strike_counts_its_direction_and_speed(velocity, expected):
    assert hit.strike(np.array(velocity), max_speed=20.0) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("puck", "inside"),
    [((0.5, 0.0), True), ((-0.2, 0.0), False), ((0.974, 0.12), True), ((0.974, 0.13), False), ((0.0, 0.0), True)],
)
def test_the_triangle_of_goal_and_previous_puck(puck, inside):
    assert hit.inside_triangle(np.zeros(2), np.array(puck)) is inside


def test_the_angle_outside_is_measured_from_the_nearer_border():
    post = math.atan2(0.125, 0.974)
    assert hit.angle_outside(np.zeros(2), np.array([0.0, 1.0])) == pytest.approx(math.pi / 2 - post)
    assert hit.angle_outside(np.zeros(2), np.array([0.0, -1.0])) == pytest.approx(math.pi / 2 - post)
    assert hit.angle_outside(np.zeros(2), np.array([-1.0, 0.0])) == pytest.approx(math.pi - post)


@pytest.mark.parametrize("name", ["3dof-hit", "7dof-hit"])
def test_the_mallet_is_where_mujoco_has_it(name):
    env = envs.make(name)
    env.reset(seed=3)
    seen = puck_and_mallet(env, env.base_observation)
    body = env.simulation.data.body(f"{env.simulation.robot.prefix}_1/{env.simulation.robot.end_effector}")
    np.testing.assert_allclose(seen.mallet, body.xpos[:2], atol=1e-9)


def test_the_mallets_velocity_is_the_change_of_its_position():
    env = envs.make("3dof-hit")
    env.reset(seed=3)
    state, step = env.base_observation, 1e-6
    velocity = np.array([0.3, -0.7, 0.5])
    state[9:12] = velocity
    later = state.copy()
    later[6:9] += step * velocity
    change = (puck_and_mallet(env, later).mallet - puck_and_mallet(env, state).mallet) / step
    np.testing.assert_allclose(puck_and_mallet(env, state).mallet_velocity, change, atol=1e-6)


def test_a_puck_on_its_way_into_the_goal():
    """It touches a mallet that it nearly rolls into, and then runs: hit once, inside until the goal."""
    env = envs.make("3dof-hit")
    state = puck_state(env, -0.6, 0.0, -1.0, 0.0)
    terms = run(env, HitReward(), state)
    names = [next(iter(step)) for step in terms]
    assert names.count("hit") == 1 and names[0] == "approach"
    assert names.index("hit") == pytest.approx((0.26 - 0.0798) / 0.02, abs=2)  # the gap at 1 m/s
    first = terms[0]["approach"]
    assert first == pytest.approx(-(0.86 - 0.62) / (0.5 * hit.TABLE_DIAGONAL), abs=1e-3)
    after = terms[names.index("hit") + 2]
    assert after["inside"] == pytest.approx(10.4, abs=0.3)  # it bounced straight back at less than half its speed
    assert all(step["constraints"] == 0.0 for step in terms)


def test_a_goal_is_worth_the_whole_future():
    env = envs.make("3dof-hit")
    state = puck_state(env, 0.9, 0.0, 3.0, 0.0)
    terms = run(env, HitReward(discount=0.997), state)
    assert terms[-1] == {"goal": pytest.approx(1.0 / 0.003), "constraints": 0.0}
    assert run(env, HitReward(), state)[-1]["goal"] == pytest.approx(100.0)  # the challenge's discount is 0.99


def test_after_the_hit_a_puck_beside_the_goal_costs_its_angle():
    env = envs.make("3dof-hit")
    state = puck_state(env, -0.3, 0.2, 1.0, 1.0)
    reward = HitReward()
    env.reset(seed=1, state=state)
    env.step(stand(env))
    reward(env, state, None, env.base_observation, False)
    reward._hit = True
    before = env.base_observation
    env.step(stand(env))
    got = reward(env, before, None, env.base_observation, False)
    upper = math.atan2(0.125 - before[1], 0.974 - before[0])
    assert got == pytest.approx(-(math.pi / 4 - upper), abs=1e-6)


def test_a_new_episode_begins_without_a_hit():
    env = envs.make("3dof-hit")
    reward = HitReward()
    run(env, reward, puck_state(env, -0.6, 0.0, -1.0, 0.0), steps=40)
    assert "approach" in run(env, reward, puck_state(env, -0.3, 0.0, 0.0, 0.0), steps=1)[0]


def test_a_bounce_off_the_rim_is_no_hit():
    before = PuckAndMallet(np.array([0.3, 0.48]), np.array([0.0, 1.0]), np.array([-0.8, 0.0]), np.zeros(2))
    after = PuckAndMallet(np.array([0.3, 0.48]), np.array([0.0, -0.8]), np.array([-0.8, 0.0]), np.zeros(2))
    assert not met(before, after)


@pytest.mark.parametrize(("velocity", "last"), [(0.05, {"success": 1000.0}), (3.0, {"failure": -100.0})])
def test_success_and_failure_count_once_at_the_end(velocity, last):
    """A slow puck on our side is a defended one; one that comes off the rim and leaves is not."""
    env = envs.make("7dof-defend")
    state = puck_state(env, -0.5 if velocity < 1.0 else -0.1, 0.3, velocity, 0.0)
    terms = run(env, TaskReward(), state)
    assert terms[-1] == last | {"constraints": 0.0}
    assert all(step == {"constraints": 0.0} for step in terms[:-1])


def test_the_horizon_ends_an_episode_too():
    env = envs.make("7dof-prepare")
    state = puck_state(env, -0.6, 0.45, 0.0, 0.0)
    terms = run(env, reward_for("prepare"), state)
    assert len(terms) == 500 and terms[-1]["failure"] == -100.0


def test_the_wrapper_takes_it_and_gives_the_same_numbers():
    np.random.seed(5)
    reward = HitReward()
    wrapped = envs.AirHockeyChallengeWrapper("3dof-hit", custom_reward_function=reward)
    wrapped.reset()
    plain, own = envs.make("3dof-hit"), HitReward()
    state = wrapped._env.base_observation
    plain.reset(seed=1, state=state)
    action = stand(plain)
    action[0, 0] += 3.0  # beyond the joint's limit: it violates
    violated = False
    for _ in range(30):
        before = plain.base_observation
        _, value, absorbing, _ = wrapped.step(action)
        plain.step(action)
        assert value == own(plain, before, action, plain.base_observation, absorbing) == sum(reward.terms.values())
        violated |= reward.terms["constraints"] < 0.0
    assert violated


def test_an_unknown_task_is_named():
    with pytest.raises(ConfigurationError, match=r"'score'.*defend, hit, home, prepare"):
        reward_for("score")

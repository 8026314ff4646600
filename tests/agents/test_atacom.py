"""ATACOM against its definitions: kinematics, constraints, tangent space, and what random actions may not do."""

from itertools import pairwise

import numpy as np
import pytest

from airhockey import envs
from airhockey.agents.atacom.chain import chain_of, task_coordinates
from airhockey.agents.atacom.controller import AtacomController
from airhockey.agents.atacom.limits import limits_of
from airhockey.agents.atacom.parameters import atacom_parameters
from airhockey.agents.atacom.tangent import compensation, constraint_rows, tangent_control
from airhockey.agents.control.kinematics import ArmKinematics
from airhockey.envs.specs import IIWA, PLANAR

SPECS = {"3dof": PLANAR, "7dof": IIWA}
ROBOTS = pytest.mark.parametrize("robot", ["3dof", "7dof"])


def random_state(spec, random):
    """Joint positions around the start, and velocities."""
    n = spec.n_joints
    return np.array(spec.start) + random.uniform(-0.3, 0.3, n), random.uniform(-0.5, 0.5, n)


def rows_at(spec, q, velocity):
    """c, b, J_G and A, with J̇ q̇ by central differences."""
    chain, limits = chain_of(spec), limits_of(spec, atacom_parameters(spec))
    values, rows = task_coordinates(chain, q)
    nudge = 1e-5
    ahead, behind = (task_coordinates(chain, q + s * nudge * velocity)[1] for s in (1, -1))
    drift = (ahead - behind) @ velocity / (2 * nudge)
    return constraint_rows(limits, values, rows, drift, q, velocity)


@ROBOTS
def test_task_coordinates_are_pinocchios(robot):
    spec, random = SPECS[robot], np.random.default_rng(0)
    arm, chain = ArmKinematics(spec), chain_of(SPECS[robot])
    for _ in range(10):
        q, _ = random_state(spec, random)
        values, rows = task_coordinates(chain, q)
        m = min(chain.rows, 3)
        position, jacobian = arm.position_and_jacobian(q)
        np.testing.assert_allclose(values[:m], position[:m], atol=1e-12)
        np.testing.assert_allclose(rows[:m], jacobian[:m], atol=1e-12)
        if robot == "7dof":
            heights, moved = arm.link_heights_and_jacobian(q)
            np.testing.assert_allclose(values[3:], heights[::-1], atol=1e-12)
            np.testing.assert_allclose(rows[3:], moved[::-1], atol=1e-12)


@ROBOTS
def test_at_rest_the_rows_are_the_challenges_constraints_and_a_margin(robot):
    spec, p, random = SPECS[robot], atacom_parameters(SPECS[robot]), np.random.default_rng(1)
    official = envs.make(f"{robot}-defend").env_info["constraints"]
    n = spec.n_joints
    for _ in range(10):
        q, _ = random_state(spec, random)
        c = rows_at(spec, q, np.zeros(n))[0]
        edges = official.get("ee_constr").fun(q, np.zeros(n))
        np.testing.assert_allclose(c[:3], edges[:3] + p.edge_margin, atol=1e-9)
        if robot == "7dof":
            np.testing.assert_allclose(c[3:5], edges[3:5] + 0.02 - p.height_tolerance, atol=1e-9)
            links = official.get("link_constr").fun(q, np.zeros(n))
            np.testing.assert_allclose(c[5:7], links + p.link_height - 0.25, atol=1e-9)
        joints = official.get("joint_pos_constr").fun(q, np.zeros(n))
        margin = (0.95 - p.position_share) * np.tile(spec.joint_position_limit[1], 2)
        np.testing.assert_allclose(c[-4 * n : -2 * n], joints + margin, atol=1e-9)


@ROBOTS
def test_constraints_change_as_their_rows_say(robot):
    spec, random = SPECS[robot], np.random.default_rng(2)
    limit = atacom_parameters(spec).acceleration_share * spec.joint_acceleration_limit[1]
    h, checked = 1e-5, 0
    for _ in range(20):
        q, velocity = random_state(spec, random)
        u = random.uniform(-1.0, 1.0, spec.n_joints)
        c, b, jacobian, _ = rows_at(spec, q, velocity)
        later = rows_at(spec, q + h * velocity + 0.5 * h * h * limit * u, velocity + h * limit * u)[0]
        rate = (later - c) / h
        drifting = (b > 1e-9) & (c < -1e-3)  # with slack left and a drift towards the limit, b is the whole drift
        np.testing.assert_allclose(rate[drifting], (b + jacobian @ u)[drifting], atol=5e-3)
        assert (rate[~drifting & (c < -1e-3)] <= (jacobian @ u)[~drifting & (c < -1e-3)] + 5e-3).all()
        checked += int(drifting.sum())
    assert checked > 50


@ROBOTS
def test_the_control_is_the_one_of_the_methods(robot):
    """The tangent part is the projection (1 − J_u⁺ J_u) [a; 0], computed as it is written; the rest is −J_u⁺ b."""
    spec, random = SPECS[robot], np.random.default_rng(3)
    n, checked = spec.n_joints, 0
    for _ in range(150):
        q, velocity = random_state(spec, random)
        _, b, jacobian, a = rows_at(spec, q, 0.3 * velocity)
        action = random.uniform(-0.3, 0.3, n)
        rest = compensation(b, jacobian, a)
        whole = np.hstack([jacobian, np.diag(a)])
        inverse = np.linalg.pinv(whole, rcond=1e-15)
        tangent = ((np.eye(len(whole.T)) - inverse @ whole) @ np.concatenate([action, np.zeros(len(b))]))[:n]
        if np.abs(rest).max() < 1.0 and np.abs(rest + tangent).max() < 1.0:
            np.testing.assert_allclose(tangent_control(action, b, jacobian, a), rest + tangent, atol=1e-6)
            checked += 1
        used = jacobian @ rest + b > 0.0  # without those whose slack grows it is the pseudo-inverse's
        some = np.hstack([jacobian[used], np.diag(a[used])])
        np.testing.assert_allclose(rest, (-np.linalg.pinv(some, rcond=1e-15) @ b[used])[:n], atol=1e-6)
    assert checked > 10


@ROBOTS
def test_the_compensation_is_the_least_of_its_cost(robot):
    spec, random = SPECS[robot], np.random.default_rng(8)
    n = spec.n_joints
    for _ in range(30):
        q, velocity = random_state(spec, random)
        _, b, jacobian, a = rows_at(spec, q, velocity)

        def cost(u, b=b, jacobian=jacobian, a=a):
            return 0.5 * u @ u + 0.5 * np.sum((np.maximum(jacobian @ u + b, 0.0) / a) ** 2)

        least = compensation(b, jacobian, a)
        for direction in random.normal(size=(20, n)):
            assert cost(least) <= cost(least + 0.01 * direction) + 1e-9


def test_a_joint_at_its_largest_speed_brakes_for_a_limit_ahead():
    ahead, b, a = np.array([1.0, 0.3]), np.array([0.5, 0.0]), np.array([1e-3, 1e-3])  # no slack in the second
    braking = -0.5 * ahead / (ahead @ ahead)
    np.testing.assert_allclose(compensation(b, np.array([ahead, [1.0, 0.0]]), a), braking, atol=1e-4)
    other_joint = [0.0, -0.5 / 0.3]  # where the first may not be slowed down
    np.testing.assert_allclose(compensation(b, np.array([ahead, [-1.0, 0.0]]), a), other_joint, atol=1e-4)


def test_the_tangent_part_is_scaled_down_to_what_the_drift_leaves():
    jacobian, a = np.zeros((1, 2)), np.ones(1)
    np.testing.assert_allclose(tangent_control(np.array([2.0, -1.0]), np.zeros(1), jacobian, a), [1.0, -0.5])
    braking = tangent_control(np.array([0.0, 1.0]), np.array([100.0]), np.array([[1.0, 0.0]]), np.array([1e-3]))
    np.testing.assert_allclose(braking, [-1.0, 1.0])


@ROBOTS
def test_the_basis_is_continuous_along_random_paths(robot):
    spec, random = SPECS[robot], np.random.default_rng(4)
    n = spec.n_joints

    def basis(q, velocity):
        _, b, jacobian, a = rows_at(spec, q, velocity)
        return np.array([tangent_control(unit, np.zeros_like(b), jacobian, a) for unit in np.eye(n)])

    (q, v), (to_q, to_v) = random_state(spec, random), random_state(spec, random)
    jumps = {}
    for count in (200, 2000):
        path = [basis(q + s * (to_q - q), v + s * (to_v - v)) for s in np.linspace(0.0, 1.0, count + 1)]
        jumps[count] = max(float(np.abs(b - a).max()) for a, b in pairwise(path))
    assert jumps[2000] < 0.15 * jumps[200]  # ten times finer, and so are the changes: no flip of a sign, no jump
    assert jumps[2000] < 0.05


@ROBOTS
@pytest.mark.parametrize("size", ["tip", "joints"])
def test_an_action_of_zero_stays(robot, size):
    controller = AtacomController(SPECS[robot])
    n = SPECS[robot].n_joints
    action, random = np.zeros(2 if size == "tip" else n), np.random.default_rng(5)
    for _ in range(30):  # somewhere else, in motion
        controller.step(random.uniform(-1.0, 1.0, 2) if size == "tip" else random.uniform(-1.0, 1.0, n))
    for _ in range(100):  # come to rest
        controller.step(action)
    tip, q = controller.tip.copy(), controller.q.copy()
    for _ in range(200):
        controller.step(action)
    np.testing.assert_allclose(controller.tip, tip, atol=2e-3)
    if size == "joints":
        np.testing.assert_allclose(controller.q, q, atol=1e-6)


@ROBOTS
@pytest.mark.parametrize("size", ["tip", "joints"])
@pytest.mark.parametrize("hold", [1, 12, 40])
def test_random_actions_violate_nothing(robot, size, hold):
    """The command never does, margins included; so the arm does not, unless its tracking error exceeds them."""
    env, spec = envs.make(f"{robot}-defend"), SPECS[robot]
    controller, random = AtacomController(spec), np.random.default_rng(hold)
    constraints, n, p = env.env_info["constraints"], spec.n_joints, atacom_parameters(spec)
    observation = env.reset(seed=hold)
    controller.reset(observation[env.env_info["joint_pos_ids"]])
    farthest = 0.0
    for step in range(300):
        if step % hold == 0:
            action = random.uniform(-1.5, 1.5, 2 if size == "tip" else n)
        command = controller.step(action)
        _, _, over, _ = env.step(command)
        farthest = max(farthest, float(np.hypot(*(controller.tip - _home(controller)))))
        values = constraints.fun(*command)
        assert values["ee_constr"][:3].max() <= -0.5 * p.edge_margin
        assert max(value.max() for value in values.values()) <= 0.0
        assert env.constraint_values.max() <= 0.0
        if over:
            env.reset(state=_parked(env, command))
    assert farthest > 0.1  # it did go somewhere


def _home(controller):
    return task_coordinates(chain_of(controller.spec), np.array(controller.spec.start))[0][:2]


def _parked(env, command):
    """The scene with a slow puck far away, and the arm on its command."""
    state, n = env.base_observation, command.shape[1]
    state[:6] = [0.3, 0.0, 0.0, -1.0, 0.3, 0.0]
    state[6 : 6 + 2 * n] = command.ravel()
    return state


@ROBOTS
def test_extreme_commands_are_braked_in_time(robot):
    """Full speed against each edge in turn."""
    spec, edges = SPECS[robot], envs.make(f"{robot}-defend").env_info["constraints"].get("ee_constr")
    margin = atacom_parameters(spec).edge_margin
    controller = AtacomController(spec)
    reached = []
    for action in ([-1.0, 0.0], [1.0, 1.0], [0.0, -1.0], [-1.0, 1.0]):
        controller.reset(np.array(spec.start))
        for _ in range(150):
            command = controller.step(np.array(action))
            assert edges.fun(*command)[:3].max() <= -0.9 * margin
        reached.append(controller.tip)
    near_x = 1.51 - (0.974 - 0.04815)
    assert near_x < reached[0][0] < near_x + 0.03
    assert 0.40 < abs(reached[2][1]) < 0.519 - 0.04815


def test_parameters_of_both_robots_are_read():
    assert atacom_parameters(PLANAR) is not atacom_parameters(IIWA)
    assert atacom_parameters(IIWA).edge_margin > 0.0

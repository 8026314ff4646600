"""The compiled control step against a slow one, written from the challenge's description with NumPy and MuJoCo's bindings."""

import mujoco
import numpy as np
import pytest
from arms import alone, striker_angles, swinging

from airhockey import envs
from airhockey.envs.specs import IIWA, PLANAR

STIFFNESS = {3: [960, 480, 240], 7: [1500, 1500, 1200, 1200, 1000, 1000, 500]}
VISCOSITY = {3: [60, 20, 4], 7: [60, 80, 60, 30, 10, 1, 0.5]}
TORQUE = {3: [100, 50, 30], 7: [320, 320, 176, 176, 110, 40, 40]}
POSITION = {
    3: np.array([2.9670597283903604, 1.8, 2.0943951023931953]),
    7: np.array([2.96706, 2.0944, 2.96706, 2.0944, 2.96706, 2.0944, 3.05433]),
}
VELOCITY = {3: np.pi * np.array([1 / 2, 1 / 2, 2 / 3]), 7: np.radians([85, 85, 100, 75, 130, 135, 135])}


class SlowController:
    """One robot, interpolation order 3."""

    def __init__(self, env):
        self.model, self.data = env.simulation.model, mujoco.MjData(env.simulation.model)
        self.data.qpos[:], self.data.qvel[:] = env.simulation.data.qpos, env.simulation.data.qvel
        mujoco.mj_forward(self.model, self.data)
        robot = env.simulation.robot
        self.alone, self.alone_data, _ = alone(robot)
        self.rod = f"{robot.prefix}_1/{robot.end_effector}"
        self.n = n = robot.n_joints
        self.previous = np.stack([self.data.qpos[:n], self.data.qvel[:n]])
        self.clipped, self.filtered = self.data.qpos[:n].copy(), self.data.qvel[:n].copy()
        self.striker_velocity, self.striker_seen = np.zeros(2), np.zeros(2)

    def step(self, action):
        for set_point in self.cubic(action):
            self.data.ctrl[: self.n] = self.torque(*self.limited(set_point))
            if self.n == 7:
                self.data.ctrl[7:9] = self.striker_torque()
            self.striker_seen = self.data.qpos[self.n : self.n + 2].copy()
            mujoco.mj_step(self.model, self.data)
            self.filtered = 0.274 * self.data.qvel[: self.n] + 0.726 * self.filtered

    def cubic(self, action):
        (p0, v0), (p1, v1), tf = self.previous, action, 0.02
        equations = np.array([[tf**2, tf**3], [2 * tf, 3 * tf**2]])
        c2, c3 = np.linalg.solve(equations, np.stack([p1 - p0 - v0 * tf, v1 - v0]))
        self.previous = np.array(action)
        for t in 0.001 * np.arange(1, 21):
            yield p0 + v0 * t + c2 * t**2 + c3 * t**3, v0 + 2 * c2 * t + 3 * c3 * t**2, 2 * c2 + 6 * c3 * t

    def limited(self, set_point):
        position, velocity, acceleration = set_point
        limit, top = POSITION[self.n], VELOCITY[self.n]
        slowest = np.clip(-20 * (self.clipped + limit), -top, top)
        fastest = np.clip(-20 * (self.clipped - limit), -top, top)
        self.clipped = np.clip(position, self.clipped + slowest * 0.001, self.clipped + fastest * 0.001)
        return self.clipped, np.clip(velocity, slowest, fastest), acceleration

    def torque(self, position, velocity, acceleration):
        q = self.data.qpos[: self.n]
        self.alone_data.qpos[:], self.alone_data.qvel[:] = q, self.filtered
        mujoco.mj_forward(self.alone, self.alone_data)
        mass = np.zeros((self.n, self.n))
        mujoco.mj_fullM(self.alone, self.alone_data, mass)
        feed_forward = mass @ acceleration + self.alone_data.qfrc_bias
        feedback = STIFFNESS[self.n] * (position - q) + VISCOSITY[self.n] * (velocity - self.filtered)
        return np.clip(feedback + feed_forward, -np.array(TORQUE[self.n]), TORQUE[self.n])

    def striker_torque(self):
        x, y, _ = self.alone_data.body(self.rod).xmat.reshape(3, 3).T
        desired = np.array(striker_angles(x, y))
        desired -= 2 * np.pi * (desired - self.striker_seen > np.pi)
        desired += 2 * np.pi * (desired - self.striker_seen < -np.pi)
        desired = np.clip(desired, -0.95 * np.pi / 2, 0.95 * np.pi / 2)
        self.striker_velocity = 0.273 * self.data.qvel[7:9] + 0.727 * self.striker_velocity
        return np.clip(4 * (desired - self.data.qpos[7:9]) - 0.31 * self.striker_velocity, -10, 10)


@pytest.mark.parametrize(("name", "robot"), [("3dof-defend", PLANAR), ("7dof-defend", IIWA)])
def test_the_compiled_step_is_the_described_one(name, robot):
    env = envs.make(name)
    env.reset(seed=1)
    slow = SlowController(env)
    for action in swinging(env, 8):
        env.step(action)
        slow.step(action)
        data = env.simulation.data
        np.testing.assert_allclose(data.qpos, slow.data.qpos, atol=1e-11)
        np.testing.assert_allclose(data.qvel, slow.data.qvel, atol=1e-9)
        np.testing.assert_allclose(data.ctrl, slow.data.ctrl, atol=1e-7)
        n = robot.n_joints
        np.testing.assert_allclose(env.true_observation[6 + n : 6 + 2 * n], slow.filtered, atol=1e-9)


@pytest.mark.parametrize("name", ["3dof-defend", "7dof-prepare"])
def test_the_step_after_a_reset_to_a_moving_arm_is_the_described_one(name):
    env = envs.make(name)
    env.reset(seed=1)
    moves = list(swinging(env, 30))
    for action in moves[:22]:
        env.step(action)
    env.reset(state=env.base_observation)
    slow = SlowController(env)
    assert np.abs(slow.previous[1]).max() > 0.1
    for action in (*moves[22:26], 8.0 * moves[26], moves[27]):
        env.step(action)
        slow.step(action)
        np.testing.assert_allclose(env.simulation.data.qpos, slow.data.qpos, atol=1e-10)


def test_wild_set_points_are_limited_as_described():
    env = envs.make("7dof-prepare")
    env.reset(seed=1)
    slow = SlowController(env)
    random = np.random.default_rng(0)
    for _ in range(8):
        action = random.uniform(-20, 20, (2, 7)) * [[1.0], [5.0]]
        env.step(action)
        slow.step(action)
        np.testing.assert_allclose(env.simulation.data.qpos, slow.data.qpos, atol=1e-9)


def test_an_arm_that_bends_until_the_striker_angles_unwrap_moves_as_described():
    env = envs.make("7dof-prepare")
    env.reset(seed=1)
    slow, unwrapped = SlowController(env), 0
    start, goal = np.array(IIWA.start), np.random.default_rng(3).uniform(-2, 2, 7)
    for step in range(1, 61):
        action = np.stack([start + (goal - start) * step / 60, np.zeros(7)])
        env.step(action)
        slow.step(action)
        np.testing.assert_allclose(env.simulation.data.qpos, slow.data.qpos, atol=1e-10)
        rod = slow.alone_data.body(slow.rod).xmat.reshape(3, 3)
        unwrapped += np.abs(np.array(striker_angles(*rod.T[:2])) - slow.striker_seen).max() > np.pi
    assert unwrapped > 5


def test_noise_is_added_to_the_torque_of_its_robot_joint_and_substep():
    n, ctrl = 7, []
    for size in (0.0, 0.25):
        env = envs.make("tournament")
        env.reset(seed=2)
        noise = np.zeros((20, 2, n))
        noise[19, 1, 3] = size  # in the last substep, so that nothing has moved yet
        action = np.array(list(next(swinging(env, 1))))
        env.simulation.step(action, noise, 1)
        ctrl.append(env.simulation.data.ctrl.copy())
    expected = np.zeros(18)
    expected[9 + 3] = 0.25
    np.testing.assert_allclose(ctrl[1] - ctrl[0], expected, atol=1e-12)

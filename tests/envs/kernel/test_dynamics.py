"""Inverse dynamics against MuJoCo's mass matrix and bias forces, and against energy."""

import mujoco
import numpy as np
from arms import ROBOTS, alone, differences, random_joints

from airhockey.envs.kernel.dynamics import inverse_dynamics
from airhockey.envs.kernel.kinematics import link_rotations


def torque(arm, position, velocity, acceleration):
    n = position.size
    rotations, forces, result = np.empty((n, 3, 3)), np.empty((n, 6)), np.empty(n)
    link_rotations(arm, position, rotations)
    inverse_dynamics(arm, rotations, velocity, acceleration, forces, result)
    return result


@ROBOTS
def test_torque_is_mass_matrix_times_acceleration_plus_bias(robot):
    model, data, arm = alone(robot)
    for position, velocity, acceleration in random_joints(robot, 1):
        data.qpos[:], data.qvel[:] = position, velocity
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass)
        expected = mass @ acceleration + data.qfrc_bias
        np.testing.assert_allclose(torque(arm, position, velocity, acceleration), expected, rtol=1e-10, atol=1e-10)


@ROBOTS
def test_torque_at_rest_is_the_slope_of_the_potential_energy(robot):
    model, data, arm = alone(robot)

    def energy(position):
        data.qpos[:] = position
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        return np.array([9.81 * model.body_mass @ data.xipos[:, 2]])

    for position, _, _ in random_joints(robot, 2, 5):
        still = np.zeros_like(position)
        slope = differences(energy, position)[0]
        np.testing.assert_allclose(torque(arm, position, still, still), slope, atol=1e-6)

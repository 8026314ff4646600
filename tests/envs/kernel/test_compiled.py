"""Compiled functions give what their Python source gives."""

import os
import shutil
import subprocess
import sys

import numpy as np
import pytest
from arms import ROBOTS, alone, random_joints

from airhockey.envs.kernel import compiling, controller, dynamics, interpolation, kinematics, universal_joint
from airhockey.envs.specs import IIWA


def both_ways(function, arguments, written):
    """What the compiled function and its source write to the arguments at those places."""
    results = []
    for call in (function, function.py_func):
        given = [np.copy(value) if isinstance(value, np.ndarray) else value for value in arguments]
        returned = call(*given)
        results.append([given[place] for place in written] + [np.nan if returned is None else returned])
    return results


def assert_same(function, arguments, written):
    compiled, source = both_ways(function, arguments, written)
    for ours, theirs in zip(compiled, source, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-13, atol=1e-13)


@ROBOTS
def test_kinematics_dynamics_and_control(robot):
    _, _, arm = alone(robot)
    n = robot.n_joints
    for position, velocity, acceleration in random_joints(robot, 40, 4):
        rotations = np.zeros((n, 3, 3))
        assert_same(kinematics.link_rotations, (arm, position, rotations), [2])
        kinematics.link_rotations(arm, position, rotations)
        places = (arm, position, np.zeros((n + 1, 3)), np.zeros((n + 2, 3)))
        assert_same(kinematics.forward_kinematics, places, [2, 3])
        forces, torque = np.zeros((n, 6)), np.zeros(n)
        assert_same(dynamics.inverse_dynamics, (arm, rotations, velocity, acceleration, forces, torque), [4, 5])
        set_point = np.stack([position, velocity, acceleration])
        assert_same(controller.limit_set_point, (arm, set_point, 0.9 * position), [1, 2])


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5, -1])
def test_interpolation(order):
    random = np.random.default_rng(order + 2)
    action, command = random.normal(size=(3, 5)), random.normal(size=(3, 5))
    arguments = (order, action, command, np.zeros((20, 3, 5)), np.zeros(5))
    assert_same(interpolation.interpolate, arguments, [2, 3, 4])


def test_the_universal_joint():
    _, _, arm = alone(IIWA)
    for position, _, _ in random_joints(IIWA, 41, 10):
        rotations, axes = np.zeros((7, 3, 3)), np.zeros((2, 3))
        kinematics.link_rotations(arm, position, rotations)
        assert_same(universal_joint.rod_axes, (rotations, axes), [1])
        universal_joint.rod_axes(rotations, axes)
        assert_same(universal_joint.desired_angles, (axes,), [])


def test_a_change_in_a_called_function_or_a_constant_is_noticed(tmp_path):
    """Numba's own cache would go on with the old code: it looks at the file of the outermost function only."""
    kernel = tmp_path / "arena" / "kernel"
    kernel.mkdir(parents=True)
    shutil.copy(compiling.__file__, kernel)
    head = "from arena.kernel.compiling import compiled\n"
    (kernel / "outer.py").write_text(
        f"{head}from arena.kernel.inner import inner\n@compiled\ndef outer(x):\n    return 2.0 * inner(x)\n"
    )
    program = "from arena.kernel.outer import outer; print(outer(1.0), len(outer.stats.cache_hits))"
    told = []
    for factor, constant in ((3.0, 10.0), (3.0, 10.0), (4.0, 10.0), (4.0, 20.0)):
        source = f"{head}from arena.specs import C\n@compiled\ndef inner(x):\n    return {factor} * x + C\n"
        (kernel / "inner.py").write_text(source)
        (tmp_path / "arena" / "specs.py").write_text(f"C = {constant}\n")
        done = subprocess.run(
            [sys.executable, "-c", program],
            env=os.environ | {"PYTHONPATH": str(tmp_path)},
            capture_output=True,
            text=True,
            check=True,
        )
        told.append(done.stdout.split())
    assert told == [["26.0", "0"], ["26.0", "1"], ["28.0", "0"], ["48.0", "0"]]
    assert not list(kernel.glob("*.nb?"))

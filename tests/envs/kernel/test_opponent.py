"""The opponent of 7dof-hit follows its figure of eight, and begins it anew at every reset."""

import numpy as np
from arms import alone, standing

from airhockey import envs
from airhockey.envs.kernel.kinematics import forward_kinematics, work_space
from airhockey.envs.kernel.opponent import Opponent, figure_of_eight, reset_opponent
from airhockey.envs.specs import IIWA


def target(step):
    t = np.pi / 2 + 0.06 * step
    return np.array([0.65 + 0.1 * np.sin(t) * np.cos(t), 0.16 * np.cos(t), 0.1645])


def test_its_commands_lie_on_the_figure_and_their_velocity_is_the_difference():
    _, _, arm = alone(IIWA)
    opponent = Opponent(np.zeros(1), np.zeros(7), np.zeros(3))
    reset_opponent(opponent, np.array(IIWA.start))
    before = np.array(IIWA.start)
    positions, axes = np.empty((8, 3)), np.empty((9, 3))
    for step in range(1, 106):  # once around
        action = np.zeros((2, 7))
        figure_of_eight(arm, opponent, work_space(7), action)
        forward_kinematics(arm, action[0], positions, axes)
        assert np.linalg.norm(positions[-1] - target(step)) < 1e-4
        np.testing.assert_allclose(action[1], (action[0] - before) / 0.02, atol=1e-12)
        before = action[0].copy()


def test_its_mallet_is_seen_on_the_figure_after_every_reset():
    env = envs.make("7dof-hit")
    for seed in (1, 2):
        env.reset(seed=seed)
        for step in range(1, 60):
            observation = env.step(standing(env))[0]
            seen = observation[20:23]
            # in its own frame, and as late as the joint controller is
            in_its_frame = np.array([3.02 - seen[0], -seen[1], seen[2]])
            assert np.linalg.norm(in_its_frame - target(step)) < 0.03

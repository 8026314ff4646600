"""Every environment of a batch is to the bit what it would be alone: any task, any N, any number of threads."""

import numpy as np
import pytest

from airhockey import envs
from airhockey.envs.tasks.game import points_reward

STEPS = 90
EVERY = [(name, "2023") for name in envs.ENVIRONMENTS] + [("hit", "2025"), ("hit_single", "2025")]


def moves(single, count, steps, seed=0):
    """Random walks of set-points about the start, quick enough to meet the puck."""
    random = np.random.default_rng(seed)
    start = np.array(single.simulation.robot.start)
    shape = (steps, count, *((2,) if single.n_players == 2 else ()), start.size)
    speed = 2.0 * np.sin(0.1 * np.arange(steps).reshape(-1, *(1,) * (len(shape) - 1)) + random.uniform(0, 6, shape[1:]))
    position = start + 0.02 * np.cumsum(speed, axis=0)
    return np.stack((position, speed), axis=-2)


class Alone:
    """What a batch promises of each of its environments, told by `Environment` itself."""

    def __init__(self, name, edition, seed, disturbances, horizon):
        self.env = envs.make(name, 3, disturbances, edition)
        self.env.horizon, self.steps = horizon, 0
        self.observation = self.env.reset(seed=seed)

    def step(self, action):
        env, before = self.env, self.env.score
        observation, _, over, info = env.step(action)
        self.steps += 1
        late = self.steps >= env.horizon and (env.n_players == 2 or not over)
        values = env.constraint_values.ravel()
        reward = points_reward(before, env.score) if env.n_players == 2 else info["success"] * (over or late)
        told = [observation, reward, over, late, env.succeeded, env.verdict, values]
        if over or late:
            if late and env.n_players == 2:
                env.new_game()
            observation = env.reset()
            if late or env.n_players == 1:
                self.steps = 0
        return [observation, *told[1:], told[0]]


CASES = [(*which, profile) for which in EVERY for profile in ("ideal", "server")] + [("7dof-prepare", "2023", "harsh")]


@pytest.mark.parametrize(("name", "edition", "disturbances"), CASES)
def test_a_batch_is_its_environments(name, edition, disturbances):
    alone = [Alone(name, edition, 5 + i, disturbances, 40) for i in range(8)]
    actions = moves(alone[0].env, 8, STEPS)
    starts = [one.observation for one in alone]
    expected = [[one.step(action) for one, action in zip(alone, row, strict=True)] for row in actions]
    assert any(over for row in expected for _, _, over, *_ in row) or any(
        late for row in expected for late in row[0][3:4]
    )
    for count, threads in [(1, 1), (1, 2), (3, 1), (3, 2), (8, 1), (8, 2)]:
        vec = envs.make_vec(name, count, threads, 5, disturbances=disturbances, edition=edition)
        vec.single.horizon = 40
        for env in vec._environments:
            env.horizon = 40
        batch = vec.reset(seed=5)
        assert batch.observations.tobytes() == np.array(starts[:count]).tobytes()
        for row, step in zip(expected, actions, strict=True):
            batch = vec.step(step[:count], batch)
            for field, told in zip(batch, zip(*row[:count], strict=True), strict=True):
                assert field.tobytes() == np.array(told, field.dtype).tobytes()
        vec.close()

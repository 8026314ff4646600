"""Starts: the official draws of `np.random.seed(s)`, written out from the challenge's section 4, and their ranges."""

import numpy as np
import pytest
from arms import ALL

from airhockey import envs

HIT_WIDTH = 1.038 / 2 - 0.03165 - 2 * 0.04815


def hit():
    x, y = np.random.uniform(-0.7, -0.2), np.random.uniform(-HIT_WIDTH, HIT_WIDTH)
    return [x, y, 0, 0, 0, 0]


def moving_hit():
    x, y = np.random.uniform(-0.7, -0.2), np.random.uniform(-HIT_WIDTH, HIT_WIDTH)
    speed, angle = np.random.uniform(0, 0.5), np.random.uniform(-np.pi / 2 - 0.1, np.pi / 2 + 0.1)
    return [x, y, 0, -np.cos(angle) * speed, np.sin(angle) * speed, np.random.uniform(-2, 2)]


def defend():
    x, y = np.random.uniform(0.29, 0.65), np.random.uniform(-0.4, 0.4)
    speed, angle = np.random.uniform(1, 3), np.random.uniform(-0.5, 0.5)
    return [x, y, 0, -np.cos(angle) * speed, np.sin(angle) * speed, np.random.uniform(-10, 10)]


def prepare():
    side = np.array([[-0.8, -0.2], [0.39105, 0.48535]])
    bottom = np.array([[-0.94, -0.8], [0.125, 0.48535]])
    side_area, bottom_area = (np.prod(area[:, 1] - area[:, 0]) for area in (side, bottom))
    area = bottom if np.random.uniform(0, 1) >= side_area / (side_area + bottom_area) else side
    x, y = np.random.rand(2) * (area[:, 1] - area[:, 0]) + area[:, 0]
    return [x, y * [1, -1][np.random.randint(2)], 0, 0, 0, 0]


def serve():
    side = np.random.choice([1, -1])
    x, *rest = hit()
    return [x * side, *rest]


OFFICIAL = {
    "3dof-hit": hit,
    "3dof-defend": defend,
    "7dof-hit": moving_hit,
    "7dof-defend": defend,
    "7dof-prepare": prepare,
    "tournament": serve,
}


@pytest.fixture
def global_random():
    """NumPy's global generator, put back afterwards."""
    before = np.random.get_state()
    yield np.random
    np.random.set_state(before)


@ALL
def test_a_seed_gives_the_official_start(name, global_random):
    env = envs.make(name)
    for seed in range(40):
        env.reset(seed=seed)
        global_random.seed(seed)
        expected = OFFICIAL[name]()
        np.testing.assert_allclose(env.base_observation[:6], expected, rtol=0, atol=1e-15)
        robot = env.simulation.robot
        np.testing.assert_array_equal(env.base_observation[6 : 6 + robot.n_joints], robot.start)
        assert np.all(env.simulation.data.qvel[:-3] == 0.0)


def hit_2025():
    x, y = np.random.uniform(-0.7, -0.2), np.random.uniform(-HIT_WIDTH, HIT_WIDTH)
    while True:
        speed, angle = np.random.uniform(0, 0.5), np.random.uniform(-np.pi / 2 - 0.1, np.pi / 2 + 0.1)
        rate, vy = np.random.uniform(-2, 2), np.sin(angle) * speed
        if abs(vy * 1.0 + y) < 0.43:
            return [x, y, 0, -np.cos(angle) * speed, vy, rate]


def defend_2025():
    x, y = np.random.uniform(0.4, 0.75), np.random.uniform(-0.4, 0.4)
    speed, angle = np.random.uniform(1, 5), np.random.uniform(-0.75, 0.75)
    return [x, y, 0, -np.cos(angle) * speed, np.sin(angle) * speed, np.random.uniform(-10, 10)]


def prepare_2025():
    areas = np.array([[[-0.8, -0.2], [0.41105, 0.47535]], [[-0.94, -0.8], [0.125, 0.47535]]])
    side, bottom = np.prod(areas[:, :, 1] - areas[:, :, 0], axis=1)
    area = areas[int(np.random.uniform(0, 1) >= side / (side + bottom))]
    x, y = np.random.rand(2) * (area[:, 1] - area[:, 0]) + area[:, 0]
    return [x, y * [1, -1][np.random.randint(2)], 0, 0, 0, 0]


OFFICIAL_2025 = {
    "hit": hit_2025,
    "hit_single": hit_2025,
    "defend": defend_2025,
    "prepare": prepare_2025,
    "tournament": serve,
}


@pytest.mark.parametrize("name", OFFICIAL_2025)
def test_a_seed_gives_the_official_start_of_2025(name, global_random):
    env = envs.make(name, edition="2025")
    wrapper = envs.AirHockeyChallengeWrapper(name, edition="2025")
    for seed in range(60):
        env.reset(seed=seed)
        global_random.seed(seed)
        expected = OFFICIAL_2025[name]()
        np.testing.assert_allclose(env.base_observation[:6], expected, rtol=0, atol=1e-15)
        if name != "tournament":  # whose wrapper draws the side when it is made
            global_random.seed(seed)
            assert wrapper.reset()[:6].tobytes() == env.true_observation[:6].tobytes()


def test_the_hits_of_2025_are_drawn_again_until_they_stay_clear_of_the_side(global_random):
    env = envs.make("hit", edition="2025")
    again = 0
    for seed in range(300):
        env.reset(seed=seed)
        y, vy = env.base_observation[1], env.base_observation[4]
        assert abs(y + vy) < 0.43
        global_random.seed(seed)
        first = moving_hit()
        again += abs(first[1] + first[4]) >= 0.43
    assert again > 20


@ALL
def test_episodes_after_a_seed_go_on_in_the_official_stream(name, global_random):
    env = envs.make(name)
    env.reset(seed=11)
    global_random.seed(11)
    OFFICIAL[name]()
    for _ in range(5):
        env.reset()
        expected = hit() if name == "tournament" else OFFICIAL[name]()
        if name == "tournament":
            expected[0] = np.copysign(expected[0], env.base_observation[0])  # the same side serves again
        np.testing.assert_allclose(env.base_observation[:6], expected, rtol=0, atol=1e-15)


@ALL
def test_nothing_is_drawn_from_the_global_generator(name, global_random):
    global_random.seed(1)
    before = global_random.get_state()[1].tobytes(), global_random.get_state()[2]
    env = envs.make(name, disturbances="harsh")
    env.reset(seed=3)
    env.reset()
    assert (global_random.get_state()[1].tobytes(), global_random.get_state()[2]) == before


@ALL
def test_a_state_is_restored_after_the_start_was_drawn(name, global_random):
    env, other = envs.make(name), envs.make(name)
    env.reset(seed=8)
    state = env.base_observation
    other.reset(seed=9)
    other.reset(state=state)
    np.testing.assert_array_equal(other.base_observation[: state.size], state)
    other.reset()
    global_random.seed(9)
    OFFICIAL[name]()
    for _ in range(2):
        expected = hit() if name == "tournament" else OFFICIAL[name]()
    np.testing.assert_allclose(np.abs(other.base_observation[:2]), np.abs(expected[:2]), rtol=0, atol=1e-15)


def starts(name, count=400):
    env = envs.make(name)
    drawn = []
    for seed in range(count):
        env.reset(seed=np.random.SeedSequence(seed))
        drawn.append(env.base_observation[:6])
    return np.array(drawn).T


def spread_over(values, low, high):
    """Within the range, and all of it: mean and deviation as of a uniform distribution."""
    assert np.all((values >= low) & (values <= high))
    deviation = (high - low) / np.sqrt(12.0)
    assert abs(values.mean() - (low + high) / 2) < 5.0 * deviation / np.sqrt(values.size)
    assert values.std() == pytest.approx(deviation, rel=0.15)


@pytest.mark.parametrize(
    ("name", "x", "y", "speed", "angle", "spin"),
    [
        ("3dof-hit", (-0.7, -0.2), HIT_WIDTH, None, None, None),
        ("7dof-hit", (-0.7, -0.2), HIT_WIDTH, (0.0, 0.5), np.pi / 2 + 0.1, 2.0),
        ("3dof-defend", (0.29, 0.65), 0.4, (1.0, 3.0), 0.5, 10.0),
        ("7dof-defend", (0.29, 0.65), 0.4, (1.0, 3.0), 0.5, 10.0),
    ],
)
def test_the_ranges_of_hit_and_defend(name, x, y, speed, angle, spin):
    px, py, yaw, vx, vy, rate = starts(name)
    spread_over(px, *x)
    spread_over(py, -y, y)
    assert np.all(yaw == 0.0)
    if speed is None:
        assert not np.any([vx, vy, rate])
        return
    spread_over(np.hypot(vx, vy), *speed)
    spread_over(np.arctan2(vy, -vx), -angle, angle)
    spread_over(rate, -spin, spin)


def test_the_areas_of_prepare_are_chosen_by_their_size():
    px, py, *rest = starts("7dof-prepare", 800)
    assert not np.any(rest)
    bottom = px < -0.8
    spread_over(px[bottom], -0.94, -0.8)
    spread_over(np.abs(py[bottom]), 0.125, 0.48535)
    spread_over(px[~bottom], -0.8, -0.2)
    spread_over(np.abs(py[~bottom]), 0.39105, 0.48535)
    share = 0.14 * 0.36035 / (0.14 * 0.36035 + 0.6 * 0.0943)
    for happened, expected in ((bottom.mean(), share), ((py > 0).mean(), 0.5)):
        assert abs(happened - expected) < 5.0 * np.sqrt(0.25 / px.size)


def test_the_first_serve_of_a_game_is_on_either_side():
    px, py, *rest = starts("tournament", 400)
    spread_over(np.abs(px), 0.2, 0.7)
    spread_over(py, -HIT_WIDTH, HIT_WIDTH)
    assert abs((px > 0).mean() - 0.5) < 5.0 * 0.5 / 20.0
    assert not np.any(rest)

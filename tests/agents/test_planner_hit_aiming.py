"""Aiming, shots and the opponent's swing of the planner's hit: hand-computed cases and definitions."""

import math

import numpy as np
import pytest

from airhockey.agents.control.parameters import control_parameters
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.estimation.motion import advance
from airhockey.agents.planner.estimation.opponent import OpponentTrack, figure_of_eight
from airhockey.agents.planner.motion.strike import run_up
from airhockey.agents.planner.shots.aiming import after_strike, mirrored, strike_normal
from airhockey.agents.planner.shots.flight import FLIGHT_STEP, coast, fly
from airhockey.agents.planner.shots.kinds import FULL, KINDS, OPEN, Kind
from airhockey.agents.planner.shots.parameters import smash_parameters
from airhockey.agents.planner.shots.shot_model import ShotModel, make_shot_model
from airhockey.agents.planner.shots.shot_search import search
from airhockey.agents.planner.shots.shots import Attempt, Keeper, Shot, judge, room_speed, turned
from airhockey.agents.table import CONTACT, HALF_LENGTH, to_robot
from airhockey.envs.compiled import pack
from airhockey.envs.specs import IIWA

NOBODY = np.full((2, 2), 10.0)
TIP = np.array([-0.86, 0.0])
NO_SHOT = Shot(0.0, 0.0, 0.0, 0.0, 0.0, np.zeros(2), np.zeros(2))


@pytest.fixture(scope="module")
def model() -> ShotModel:
    workspace = Workspace(to_robot(np.array([-0.918, -0.463])), to_robot(np.array([0.918, 0.463])), 6.0)
    assert control_parameters(IIWA).edge_margin == pytest.approx(0.008)
    return make_shot_model(smash_parameters(IIWA), workspace)._replace(turn=0.0, bounce_spread=0.06)


def shot_at(
    model: ShotModel, puck: list[float], aim: float = 0.0, wall: float = 0.0, opponent: np.ndarray = NOBODY
) -> Shot:
    return judge(np.array(puck), Attempt(3.0, aim, wall, 0.0), TIP, Keeper(opponent, 0.0, OPEN.heeds), OPEN.pace, model)


def test_a_puck_at_rest_leaves_along_the_normal() -> None:
    assert after_strike(np.zeros(2), np.array([0.6, 0.8]), 1.0, 1.5) == pytest.approx([0.9, 1.2])


def test_a_puck_that_runs_away_faster_than_the_mallet_is_not_touched() -> None:
    assert after_strike(np.array([1.2, 0.1]), np.array([1.0, 0.0]), 1.0, 1.5) == pytest.approx([1.2, 0.1])


def test_the_puck_leaves_in_the_wanted_direction() -> None:
    rng = np.random.default_rng(0)
    for _ in range(100):
        angle, velocity = rng.uniform(-0.6, 0.6), rng.uniform(-0.4, 0.4, 2)
        direction = np.array([math.cos(angle), math.sin(angle)])
        normal = strike_normal(velocity, direction, 1.0, 1.5)
        assert np.hypot(*normal) == pytest.approx(1.0)
        left = after_strike(velocity, normal, 1.0, 1.5)
        assert left[0] * direction[1] - left[1] * direction[0] == pytest.approx(0.0, abs=1e-4)
        assert left @ direction > 0.5


def test_the_mirror_of_an_elastic_wall_is_the_mirror_image() -> None:
    assert mirrored(0.1, 0.5, 1, 1.0) == pytest.approx(0.9)
    assert mirrored(0.1, -0.5, 1, 1.0) == pytest.approx(-1.1)


@pytest.mark.parametrize("rims", [1, 2, 3])
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("restitution", [1.0, 0.75])
def test_a_puck_aimed_at_the_mirrored_target_arrives_at_the_target(rims: int, side: float, restitution: float) -> None:
    """Followed from wall to wall: at each the lateral velocity turns round and shrinks."""
    y, line, target, way = 0.1, 0.49, -0.05, 1.4
    lateral = (mirrored(target, side * line, rims, restitution) - y) / way  # per unit of x
    assert lateral * side > 0.0
    for _ in range(rims):
        wall = math.copysign(line, lateral)
        way -= (wall - y) / lateral
        y, lateral = wall, -restitution * lateral
    assert y + lateral * way == pytest.approx(target)


def test_the_mallet_touches_the_puck_opposite_to_where_it_shall_go(model: ShotModel) -> None:
    shot = shot_at(model, [-0.5, 0.2, 0.0, 0.0, 0.0], aim=0.03)
    way = np.array([HALF_LENGTH + 0.5, 0.03 - 0.2])
    assert shot.normal == pytest.approx(way / np.hypot(*way))
    assert shot.mallet == pytest.approx(np.array([-0.5, 0.2]) - CONTACT * shot.normal)
    assert shot.value > 0.8


@pytest.mark.sampled(2)
@pytest.mark.parametrize("wall", [-1.0, 1.0])
def test_a_bounced_shot_flies_to_where_it_is_aimed(model: ShotModel, wall: float) -> None:
    puck = np.array([-0.5, 0.1, 0.0, 0.0, 0.0])
    shot = shot_at(model, list(puck), aim=0.02, wall=wall)
    assert shot.value > 0.2
    assert np.sign(shot.normal[1]) == wall
    puck[2:4] = after_strike(puck[2:4], shot.normal, shot.speed, model.gain)
    assert fly(puck, NOBODY, 0.0, model)[0] == pytest.approx(0.02, abs=0.015)


@pytest.mark.long
@pytest.mark.parametrize("wall", [-2.0, 2.0])
def test_a_shot_off_two_rims_flies_to_where_it_is_aimed(wall: float) -> None:
    workspace = Workspace(to_robot(np.array([-0.918, -0.463])), to_robot(np.array([0.918, 0.463])), 6.0)
    model = make_shot_model(smash_parameters(IIWA, in_game=True), workspace)._replace(turn=0.0, bounce_spread=0.06)
    puck = np.array([-0.5, 0.0, 0.0, 0.0, 0.0])
    shot = shot_at(model, list(puck), aim=0.05, wall=wall)
    assert shot.value > 0.1
    assert np.sign(shot.normal[1]) == np.sign(wall)
    puck[2:4] = after_strike(puck[2:4], shot.normal, shot.speed, model.gain)
    assert fly(puck, NOBODY, 0.0, model)[0] == pytest.approx(0.05, abs=0.015)


@pytest.mark.long
@pytest.mark.parametrize("post", [-1, 1])
@pytest.mark.parametrize("rims", [1, 2])
def test_a_kind_of_shot_is_aimed_at_its_post(rims: int, post: int) -> None:
    workspace = Workspace(to_robot(np.array([-0.918, -0.463])), to_robot(np.array([0.918, 0.463])), 6.0)
    parameters = smash_parameters(IIWA, in_game=True)
    model = pack(make_shot_model(parameters, workspace))
    path = np.tile([-0.5, 0.05, 0.0, 0.0, 0.0], (150, 1))
    kind = Kind("post", rims, FULL, 0.06, post, False)
    for first in (0, 100, 200):
        shot = search(path, 0.02, TIP, NOBODY, 0.1, NO_SHOT, first, 60, 2.5, 0.0, *kind[1:], model)
        last_side = shot.wall if rims == 1 else -shot.wall
        assert round(abs(shot.wall)) == rims
        assert abs(shot.aim) >= 0.06 - 1e-9
        assert np.sign(shot.aim) == post * np.sign(last_side)


def test_the_opponent_in_the_way_costs_the_goal(model: ShotModel) -> None:
    puck = [-0.5, 0.0, 0.0, 0.0, 0.0]
    assert shot_at(model, puck, opponent=np.tile([0.86, 0.0], (2, 1))).value < 0.02
    assert shot_at(model, puck, opponent=np.tile([0.86, 0.17], (2, 1))).value > 0.75


def test_the_opponent_counts_where_it_is_when_the_puck_passes(model: ShotModel) -> None:
    puck = [-0.5, 0.0, 0.0, 0.0, 0.0]
    away = np.tile([0.86, 0.3], (round(8.0 / FLIGHT_STEP), 1))
    early, late = away.copy(), away.copy()
    early[: round(3.5 / FLIGHT_STEP), 1] = 0.0  # the strike is after 3 s, the flight takes about one second
    late[round(3.5 / FLIGHT_STEP) : round(4.5 / FLIGHT_STEP), 1] = 0.0
    assert shot_at(model, puck, opponent=early).value > 0.75
    assert shot_at(model, puck, opponent=late).value < 0.02


@pytest.mark.parametrize("puck", [[-0.5, 0.485], [-0.93, 0.3], [0.1, 0.0]], ids=["side", "back", "theirs"])
def test_there_is_no_straight_shot_from_a_bad_place(model: ShotModel, puck: list[float]) -> None:
    assert shot_at(model, [*puck, 0.0, 0.0, 0.0]).value == 0.0


def test_there_is_no_shot_without_the_time_for_the_way(model: ShotModel) -> None:
    puck = np.array([-0.4, -0.35, 0.0, 0.0, 0.0])
    assert judge(puck, Attempt(0.3, 0.0, 0.0, 0.0), TIP, Keeper(NOBODY, 0.0, OPEN.heeds), OPEN.pace, model).value == 0.0


def test_the_speed_that_the_room_allows_uses_up_the_room(model: ShotModel) -> None:
    normal = np.array([1.0, 0.0])
    speed = room_speed(np.array([model.lower[0] + 0.051, 0.0]), normal, model)
    assert run_up(speed, model.acceleration, model.steady)[0] == pytest.approx(0.05)


def test_turned_changes_the_sine_by_a_share() -> None:
    assert turned(np.array([0.8, 0.6]), 0.05) == pytest.approx([math.sqrt(1 - 0.63**2), 0.63])


def test_the_known_figure_of_eight() -> None:
    """World (0.86 − 0.1 sin φ cos φ, −0.16 cos φ), φ = π/2 + 3 t, from its coefficients at another time."""
    at, later = 0.7, 1.9
    phase = math.pi / 2 + 3.0 * later
    expected = [0.86 - 0.1 * math.sin(phase) * math.cos(phase), -0.16 * math.cos(phase)]
    turn = 3.0 * (later - at)
    basis = np.array([1.0, math.cos(turn), math.sin(turn), math.cos(2 * turn), math.sin(2 * turn)])
    assert basis @ figure_of_eight(3.0 * at) == pytest.approx(expected)


@pytest.mark.parametrize("rate", [3.0, 2.25, 5.0])
def test_a_swing_is_recognised_and_continued(rate: float) -> None:
    track = OpponentTrack({"dt": 0.02, "env_name": "tournament"})
    rng = np.random.default_rng(1)

    def place(time: float) -> np.ndarray:
        return np.array([0.8 + 0.05 * math.sin(2 * rate * time + 1.0), 0.05 + 0.14 * math.cos(rate * time)])

    for step in range(140):
        track.update(place(0.02 * step) + rng.normal(0.0, 0.003, 2), step)
    assert track.swinging
    assert track.predict(np.array([0.0, 1.0])) == pytest.approx(np.array([place(2.78), place(3.78)]), abs=0.012)


def test_before_it_is_seen_for_long_the_figure_of_the_challenge_is_expected() -> None:
    track = OpponentTrack({"dt": 0.02, "env_name": "7dof-hit", "n_agents": 2})
    track.update(np.array([0.86, 0.0]), 0)
    assert track.predict(np.array([0.5]))[0] == pytest.approx(
        [0.86 + 0.05 * math.sin(3.0), 0.16 * math.sin(1.5)], abs=0.01
    )


def test_a_restless_opponent_is_expected_where_it_is() -> None:
    track = OpponentTrack({"dt": 0.02, "env_name": "tournament"})
    rng = np.random.default_rng(2)
    for step in range(100):
        seen = rng.uniform(-0.2, 0.2, 2)
        track.update(seen, step)
    assert not track.swinging
    assert track.predict(np.array([1.0]))[0] == pytest.approx(seen)


@pytest.mark.parametrize("velocity", [[0.7, -0.4], [-0.8, 0.9]])
def test_the_puck_coasts_as_it_does_in_small_pieces(model: ShotModel, velocity: list[float]) -> None:
    puck = np.array([-0.6, 0.2, *velocity, 1.0])
    path = coast(puck, 0.02, 100, model.motion)
    for k in range(100):
        expected = path[k].copy()
        advance(expected, 0.02, model.motion)
        assert path[k + 1] == pytest.approx(expected, abs=1e-12)


def test_the_time_since_the_last_bounce_is_that_of_the_way_from_the_rim(model: ShotModel) -> None:
    puck = np.array([0.0, 0.0, 1.5, 1.5, 0.0])
    path = coast(puck, 0.001, 2000, model.motion)
    turned_round = int(np.argmax(path[:, 3] < 0.0))
    there = int(np.argmax(path[:, 0] > HALF_LENGTH))
    assert fly(puck, NOBODY, 0.0, model)[4] == pytest.approx(0.001 * (there - turned_round), abs=0.006)
    assert fly(np.array([0.0, 0.0, 1.5, 0.0, 0.0]), NOBODY, 0.0, model)[4] == pytest.approx(0.785, abs=0.005)


def test_a_shot_across_the_table_is_worth_more_than_one_along_the_rim_that_it_comes_off() -> None:
    """The keeper has least time after the bounce where the puck comes from the other side."""
    workspace = Workspace(to_robot(np.array([-0.918, -0.463])), to_robot(np.array([0.918, 0.463])), 6.0)
    in_game = make_shot_model(smash_parameters(IIWA, True), workspace)
    near = next(kind for kind in KINDS if kind.name == "near rim")

    def worth(y: float) -> float:
        attempt = Attempt(2.4, 0.085, 1.0, 0.0)
        return judge(
            np.array([-0.5, y, 0.0, 0.0, 0.0]), attempt, TIP, Keeper(NOBODY, 0.0, near.heeds), near.pace, in_game
        ).value

    assert worth(-0.25) > 1.5 * worth(0.0) > 1.5 * worth(0.2) > 0.0

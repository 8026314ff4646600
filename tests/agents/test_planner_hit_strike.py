"""The motions of the planner's hit, its choice of skills, and whole episodes."""

import numpy as np
import pytest

from airhockey import envs
from airhockey.agents import build_agent
from airhockey.agents.base import AgentBase
from airhockey.agents.control.inverse_kinematics import inverse_kinematics
from airhockey.agents.control.joint_controller import JointController
from airhockey.agents.control.kinematics import ArmKinematics
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.estimation.kalman import PuckEstimate
from airhockey.agents.parameters import convert
from airhockey.agents.planner.motion.approach import Pace, approach
from airhockey.agents.planner.motion.strike import Strike, run_up
from airhockey.agents.planner.shots.parameters import SmashParameters, smash_parameters
from airhockey.agents.planner.tactics import Playing, choose
from airhockey.agents.skill import Situation
from airhockey.agents.table import CONTACT, to_robot, to_table
from airhockey.envs.specs import IIWA, PLANAR, SOFT_LIMIT, RobotSpec
from airhockey.errors import ConfigurationError

DT = 0.02


def strike_of(spec: RobotSpec, contact: list[float], angle: float, offset: tuple[float, float] = (0.0, 0.0)) -> Strike:
    p = smash_parameters(spec)
    speed = float(np.interp(contact[0], p.speed_places, p.speeds))
    normal = np.array([np.cos(angle), np.sin(angle)])
    return Strike(
        np.array(contact), normal, speed, p.acceleration, p.braking, p.steady, p.follow, np.array(offset), np.zeros(2)
    )


def test_a_strike_goes_through_the_contact_at_full_speed_and_ends_at_rest() -> None:
    strike = strike_of(IIWA, [-0.6, 0.1], 0.2, offset=(0.01, -0.02))
    position, velocity = strike.at(0.0)
    assert position == pytest.approx(strike.start + strike.offset)
    assert velocity == pytest.approx([0.0, 0.0])
    position, velocity = strike.at(strike.contact_time)
    assert position == pytest.approx(strike.contact)
    assert velocity == pytest.approx(strike.speed * strike.normal)
    assert strike.at(strike.duration)[1] == pytest.approx([0.0, 0.0], abs=1e-9)
    length, time = run_up(strike.speed, strike.acceleration, strike.steady)
    assert strike.contact - strike.start == pytest.approx(length * strike.normal)
    assert time == strike.contact_time


def test_the_velocity_of_a_strike_is_the_derivative_of_its_position() -> None:
    base = strike_of(IIWA, [-0.6, 0.1], 0.2, offset=(0.01, -0.02))
    strike = Strike(**{**vars(base), "drift": np.array([0.05, 0.1])})
    for time in np.arange(0.005, strike.duration, 0.0071):
        h = 1e-6
        slope = (strike.at(time + h)[0] - strike.at(time - h)[0]) / (2 * h)
        assert slope == pytest.approx(strike.at(time)[1], abs=1e-4)


@pytest.mark.parametrize(
    ("spec", "contact", "angle"),
    [(IIWA, [-0.75, 0.0], 0.0), (IIWA, [-0.6, 0.3], -0.2), (IIWA, [-0.35, -0.2], 0.15), (PLANAR, [-0.6, -0.3], 0.2)],
    ids=["iiwa-near", "iiwa-side", "iiwa-far", "planar"],
)
def test_the_arm_can_follow_a_strike_within_its_limits(spec: RobotSpec, contact: list[float], angle: float) -> None:
    kinematics = ArmKinematics(spec)
    workspace = Workspace(to_robot(np.array([-0.918, -0.463])), to_robot(np.array([0.918, 0.463])), 6.0)
    controller = JointController(kinematics, workspace, DT)
    strike = strike_of(spec, contact, angle)
    point = np.array([*to_robot(strike.start), spec.desired_height])
    q = inverse_kinematics(kinematics, point, np.array(spec.start))
    assert q is not None
    controller.reset(q)
    across = np.array([-strike.normal[1], strike.normal[0]])
    time = 0.0
    while time < strike.contact_time:
        time += DT
        position, velocity = strike.at(time)
        before = controller.state.velocity
        controller.step(to_robot(position), velocity)
        assert np.all(np.abs(controller.state.velocity) <= SOFT_LIMIT * spec.joint_velocity_limit[1])
        assert np.all(np.abs(controller.state.velocity - before) <= DT * spec.joint_acceleration_limit[1] + 1e-9)
        error = to_table(controller.tip_position()) - position
        assert abs(error @ across) < 0.002
    assert controller.tip_velocity() @ strike.normal > 0.85 * strike.speed


def test_the_approach_gets_there_round_the_puck_without_touching_it() -> None:
    tip, velocity, place, puck = np.array([-0.4, 0.02]), np.zeros(2), np.array([-0.75, 0.0]), np.array([-0.58, 0.0])
    for _ in range(200):
        before = velocity
        tip, velocity = approach(tip, velocity, place, Pace(0.8, 3.0, 0.02), DT, puck)
        assert np.hypot(*(velocity - before)) <= 3.0 * DT + 1e-9
        assert np.hypot(*(tip - puck)) > CONTACT
    assert tip == pytest.approx(place, abs=0.002)


def situation(x: float, velocity: tuple[float, float], tip: tuple[float, float] = (-0.86, 0.0)) -> Situation:
    kinematics = ArmKinematics(PLANAR)
    controller = JointController(kinematics, Workspace(np.array([0.5, -0.5]), np.array([2.5, 0.5]), 3.0))
    q = inverse_kinematics(kinematics, np.array([*to_robot(np.array(tip)), 0.1]), np.array(PLANAR.start))
    assert q is not None
    controller.reset(q)
    puck = PuckEstimate(np.array([x, 0.0, *velocity, 0.0]), np.eye(5), 0)
    return Situation(
        puck, np.array(tip), controller.tip_velocity(), None, DT, 0, controller.move, controller.state.position
    )


@pytest.mark.parametrize(
    ("task", "now", "finished", "committed", "stroke", "x", "speed", "expected"),
    [
        ("hit", "smash", False, True, None, 0.3, -2.0, "smash"),  # a strike under way goes on
        ("hit", "ready", True, False, "smash", -0.5, 0.0, "smash"),
        ("hit", "ready", True, False, None, -0.5, 0.0, "prepare"),
        ("hit", "ready", True, False, None, -0.5, -0.3, "defend"),
        ("hit", "prepare", False, False, None, -0.5, -0.3, "prepare"),
        ("hit", "prepare", False, False, "smash", -0.5, 0.0, "smash"),
        ("tournament", "ready", True, False, None, 0.5, -0.5, "defend"),
        ("tournament", "ready", True, False, "smash", 0.5, -0.5, "defend"),  # first stop it
        ("tournament", "ready", True, False, None, 0.5, -2.5, "repel"),
        ("tournament", "defend", False, False, None, 0.5, -2.5, "defend"),  # no change of mind on the way
        ("tournament", "ready", True, False, None, 0.5, 0.5, "ready"),
        ("tournament", "ready", True, False, None, 0.5, -0.05, "ready"),  # it will not come over
        ("tournament", "drop", False, True, "drop", -0.5, 0.0, "drop"),
        ("tournament", "ready", True, False, "drop", -0.5, 0.0, "drop"),
        ("defend", "ready", True, False, "smash", -0.5, 0.0, "defend"),
        ("prepare", "ready", True, False, "smash", -0.5, 0.0, "prepare"),
    ],
)
def test_the_choice_of_a_skill(
    task: str, now: str, finished: bool, committed: bool, stroke: str | None, x: float, speed: float, expected: str
) -> None:
    assert choose(task, Playing(now, finished, committed), stroke, "repel", situation(x, (speed, 0.0))) == expected


def test_a_puck_that_is_being_touched_is_not_shot_at() -> None:
    touching = situation(-0.5, (0.0, 0.0), tip=(-0.5 - CONTACT - 0.005, 0.0))
    assert choose("hit", Playing("prepare", False, False), "smash", "repel", touching) == "prepare"


def test_a_puck_that_was_prepared_is_shot_at_even_where_the_mallet_touches_it() -> None:
    touching = situation(-0.5, (0.0, 0.0), tip=(-0.5 - CONTACT - 0.005, 0.0))
    assert choose("hit", Playing("prepare", True, False), "smash", "repel", touching) == "smash"


def test_a_fast_puck_gets_the_answer_that_was_chosen() -> None:
    fast = situation(0.5, (-2.5, 0.0))
    assert choose("tournament", Playing("ready", True, False), None, "defend", fast) == "defend"


def test_parameters_are_checked() -> None:
    good = {
        key: list(value) if isinstance(value, tuple) else value for key, value in vars(smash_parameters(IIWA)).items()
    }
    assert convert(SmashParameters, good, "here") == smash_parameters(IIWA)
    with pytest.raises(ConfigurationError, match="gian"):
        convert(SmashParameters, {**good, "gian": 1.0}, "here")


def play(env: envs.Environment, agent: AgentBase, seed: int) -> tuple[int, set[str], list[np.ndarray]]:
    violated: set[str] = set()
    actions: list[np.ndarray] = []
    success = 0
    observation = env.reset(seed=seed)
    agent.episode_start()
    for _ in range(env.horizon):
        action = agent.draw_action(observation)
        actions.append(action)
        observation, _, absorbing, info = env.step(action)
        violated |= {name for name, value in info["constraints_value"].items() if value.max() > 0}
        success = info["success"]
        if absorbing:
            break
    return success, violated, actions


@pytest.mark.parametrize("name", ["7dof-hit", "3dof-hit"])
def test_it_scores_without_violations_and_the_same_way_every_time(name: str) -> None:
    env = envs.make(name)
    agent = build_agent("planner", env.env_info)
    results = [play(env, agent, seed) for seed in (0, 1, 2, 0)]
    assert [success for success, _, _ in results] == [1, 1, 1, 1]
    assert not set().union(*(violated for _, violated, _ in results))
    assert np.array_equal(np.array(results[0][2]), np.array(results[3][2]))
    assert agent.phase.startswith("smash") or agent.phase.startswith("ready")

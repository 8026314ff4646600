"""How fast a legal stroke can be: what the joints' velocity limits allow at the contact, and what share the planner asks for.

    python benchmarks/strokes.py

For a puck at x on the table and a direction from the x axis: the linear programme over the joint velocities (95 % of the limits,
beyond which a violation is counted) in the posture that the planner strokes from, and in the best of many; the mallet's speed
that the planner asks for, at the y that leaves most room for run-up and braking; and with how much the puck leaves then, and
would leave at the bound. All in [m]/[s].
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from airhockey.agents.control.inverse_kinematics import inverse_kinematics
from airhockey.agents.control.kinematics import ArmKinematics
from airhockey.agents.control.speed_limit import largest_speed
from airhockey.agents.control.workspace import Workspace
from airhockey.agents.planner.shots.parameters import smash_parameters
from airhockey.agents.planner.shots.shot_model import ShotModel, make_shot_model
from airhockey.agents.planner.shots.shots import gain_at, room_speed
from airhockey.agents.table import CONTACT
from airhockey.envs import make
from airhockey.envs.specs import IIWA, SOFT_LIMIT

Array = NDArray[np.float64]

PLACES = (-0.75, -0.6, -0.45, -0.3, -0.15)
"""x of the puck, in [m]."""
ANGLES = (0.0, 30.0, 50.0, 65.0)
"""Of the stroke from the x axis, in [°]."""
SIDES = np.linspace(-0.4, 0.4, 17)
"""y of the puck that are tried, in [m]."""
POSTURES, SPREAD = 200, 0.5
"""How many postures the best is looked for among, and their spread about the stroke's, in [rad]."""
COLUMNS = (
    "puck's x [m]", "direction [°]", "bound, stroke's posture", "bound, best posture", "asked for", "share", "puck",
    "puck at the bound",
)  # fmt: skip


def asked_for(place: Array, direction: Array, model: ShotModel) -> float:
    """The mallet's speed that the planner's model gives a stroke, 0 where there is no room for one; in [m]/[s]."""
    mallet = place - CONTACT * direction
    speed = float(np.interp(mallet[0], model.speed_places, model.speeds)) * (1.0 + model.diagonal * direction[1] ** 2)
    speed = min(speed, model.fastest, room_speed(mallet, direction, model))
    after = mallet + (speed * model.follow + 0.5 * speed * speed / model.braking) * direction
    return speed if np.all(after < model.upper) and np.all(after > model.lower) else 0.0


def bounds(place: Array, direction: Array, posture: Array) -> tuple[float, float]:
    """The linear programme's largest speed in the stroke's posture and in the best one found, in [m]/[s]."""
    kinematics, limits = ArmKinematics(IIWA), SOFT_LIMIT * IIWA.joint_velocity_limit
    mallet = place - CONTACT * direction
    point = np.array([mallet[0] - IIWA.base_positions[0][0], mallet[1], IIWA.desired_height])
    along = np.array([*direction, 0.0])
    rng, found = np.random.default_rng(0), []
    for trial in range(POSTURES):
        first = posture if trial == 0 else posture + rng.normal(0.0, SPREAD, IIWA.n_joints)
        joints = inverse_kinematics(kinematics, point, first)
        if joints is not None:
            found.append(float(largest_speed(kinematics.jacobian(joints)[:3], along, limits[0], limits[1])))
    return found[0], max(found)


@cache
def lines() -> list[str]:
    """The table, as Markdown."""
    parameters = smash_parameters(IIWA, in_game=True)
    model = make_shot_model(parameters, Workspace.of(make("tournament").env_info))
    rows = ["| " + " | ".join(COLUMNS) + " |", "|---" * len(COLUMNS) + "|"]
    for x in PLACES:
        for angle in np.radians(ANGLES):
            direction = np.array([np.cos(angle), np.sin(angle)])
            speed, place = max((asked_for(np.array([x, y]), direction, model), y) for y in SIDES)
            stroke, best = bounds(np.array([x, place]), direction, np.array(parameters.posture))
            cells = [f"{x:g}", f"{np.degrees(angle):.0f}", f"{stroke:.2f}", f"{best:.2f}"]
            if speed >= model.least_speed:
                cells += [f"{speed:.2f}", f"{100 * speed / best:.0f} %", f"{gain_at(speed, model) * speed:.2f}"]
            else:
                cells += ["no room", "—", "—"]
            rows.append("| " + " | ".join([*cells, f"{gain_at(best, model) * best:.2f}"]) + " |")
    return rows


if __name__ == "__main__":
    print("\n".join(lines()))

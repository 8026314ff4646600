"""Goals per shot: each kind of shot against each keeper, as a table with 95 % intervals.

    python benchmarks/shots.py [--keepers planner thesis benchmarks/opponents/wall] [--shots 100] [--disturbances server]

The puck is launched in our half, aimed at a point inside the goal, straight or by one, two or three rims, at a speed, with a
spin; the keeper (player 2) stands at home, where a shot of its own has left it, or beside. So these are the odds of a shot
without the arm that plays it: the bound of what a player can get out of its kind. The keeper plays on until the puck is in,
has come back over the middle or lies still.
"""

import argparse
import copy
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey import envs
from airhockey.agents import build_agent
from airhockey.agents.control.inverse_kinematics import inverse_kinematics
from airhockey.agents.control.kinematics import ArmKinematics
from airhockey.agents.estimation.motion import advance, puck_motion
from airhockey.envs.specs import IIWA, PUCK, TABLE
from airhockey.envs.tasks import verdicts
from airhockey.evaluator.judging.tasks import wilson_interval

Array = NDArray[np.float64]

SPEEDS = (1.2, 1.6, 2.0, 2.5, 3.0, 4.0)
RIMS = (0, 1, 2, 3)
SPINS = (-40.0, 0.0, 40.0)
STATES = {"home": (-0.86, 0.0), "after its shot": (-0.40, 0.10), "beside": (-0.62, 0.33)}
"""Where the keeper's mallet is when the puck leaves, in its own table frame, in [m]."""
LONGEST = 200
"""Control steps that a shot is followed."""
_STEP = 0.005


@dataclass(frozen=True)
class Kind:
    """What is varied: number of rims, speed [m]/[s], yaw rate [rad]/[s], and the keeper's state, a key of `STATES`."""

    rims: int
    speed: float
    spin: float
    state: str


def launch(start: Array, kind: Kind, aim: float, side: float) -> Array | None:
    """The puck's state that flies to y = aim on the goal line off so many rims, the first at side · y > 0; None: there is none.

    Directions are scanned, then bisected; a flight is `estimation.motion`. Shape (5,).
    """
    constants = puck_motion().constants

    def flight(angle: float) -> tuple[float, int]:
        state = np.array([*start, kind.speed * np.cos(angle), kind.speed * np.sin(angle), kind.spin])
        bounces = 0
        for _ in range(1000):
            x, y = state[0], state[1]
            bounces += advance(state, _STEP, constants)
            if state[0] >= TABLE.length / 2 - PUCK.radius:
                share = (TABLE.length / 2 - PUCK.radius - x) / (state[0] - x) if state[0] > x else 0.0
                return float(y + share * (state[1] - y)), bounces
            if state[2] < 0.05:
                break
        return np.nan, bounces

    before: tuple[float, float] | None = None
    for angle in side * np.linspace(-0.2 if kind.rims == 0 else 0.05, 1.45, 120):
        y, bounces = flight(angle)
        if bounces != kind.rims or not np.isfinite(y):
            before = None
            continue
        if before is not None and (before[1] - aim) * (y - aim) <= 0.0:
            low, high = before[0], float(angle)
            for _ in range(25):
                middle = 0.5 * (low + high)
                reached = flight(middle)[0]
                low, high = (middle, high) if (reached - aim) * (before[1] - aim) > 0.0 else (low, middle)
            return np.array([*start, kind.speed * np.cos(low), kind.speed * np.sin(low), kind.spin])
        before = float(angle), y
    return None


class Range:
    """A table with a keeper at its right end, and nobody at the left."""

    def __init__(self, keeper: str, disturbances: str) -> None:
        self._env = envs.make("tournament", disturbances=disturbances)
        self._agent = build_agent(keeper, copy.deepcopy(self._env.env_info), 2)
        order = getattr(self._agent, "interpolation_order", 3)
        if order != 3:
            self._env = envs.make("tournament", (3, order), disturbances=disturbances)
        self._kinematics = ArmKinematics(IIWA)

    def goes_in(self, puck: Array, state: str, seed: int) -> bool:
        """Whether a puck launched like this ends in the goal. State (5,)."""
        env, n = self._env, IIWA.n_joints
        env.reset(seed=seed)
        base = env.base_observation
        rows = base.reshape(2, -1)
        for row in rows:
            row[:6] = [puck[0], puck[1], 0.0, puck[2], puck[3], puck[4]]
        place = np.array([STATES[state][0] - IIWA.base_positions[0][0], STATES[state][1], IIWA.desired_height])
        joints = inverse_kinematics(self._kinematics, place, np.array(IIWA.start))
        assert joints is not None
        rows[1, 6 : 6 + n] = joints
        observation = env.reset(state=base)
        still = np.stack([np.array(IIWA.start), np.zeros(n)])
        half = observation.size // 2
        self._agent.episode_start()
        for _ in range(LONGEST):
            action = self._agent.draw_action(observation[half:].copy())
            observation, _, over, _ = env.step((still, action))
            if over:
                return bool(env.verdict == verdicts.GOAL_HOME)
            x, speed = env.base_observation[0], env.base_observation[3]
            if speed < 0.02 and x < 0.0:
                break
        return False


def odds(keeper: str, kinds: list[Kind], shots: int, disturbances: str, seed: int) -> dict[Kind, tuple[int, int]]:
    """Goals and shots of every kind against a keeper."""
    table, found = Range(keeper, disturbances), {}
    for kind in kinds:
        rng = np.random.default_rng([seed, kind.rims, int(10 * kind.speed), int(kind.spin) + 100])
        goals, count = 0, 0
        for number in range(shots):
            start = np.array([rng.uniform(-0.6, -0.3), rng.uniform(-0.3, 0.3)])
            aim, side = rng.uniform(-0.085, 0.085), rng.choice([-1.0, 1.0])
            puck = launch(start, kind, aim, side)
            if puck is not None:
                count += 1
                goals += table.goes_in(puck, kind.state, seed + number)
        found[kind] = goals, count
    return found


def rows_of(options: argparse.Namespace) -> list[Kind]:
    """What the options ask for: everything at home; of the other states and spins, one speed in two."""
    kinds = [Kind(rims, speed, 0.0, state) for state, rims, speed in product(options.states, RIMS, options.speeds)]
    return kinds + [
        Kind(rims, options.speeds[-1], spin, "home") for rims in (0, 1) for spin in SPINS if spin and options.spin
    ]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--keepers", nargs="+", default=["planner", "thesis"])
    parser.add_argument("--shots", type=int, default=50)
    parser.add_argument("--speeds", nargs="+", type=float, default=list(SPEEDS))
    parser.add_argument("--states", nargs="+", choices=list(STATES), default=list(STATES))
    parser.add_argument("--spin", action="store_true", help="also shots that spin")
    parser.add_argument("--disturbances", default="ideal")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    kinds = rows_of(options)
    print(
        f"goals per 100 shots (95 % interval), {options.disturbances}, {options.shots} shots per cell, seed {options.seed}"
    )
    print("| keeper | its mallet | rims | spin | " + " | ".join(f"{speed:g} m/s" for speed in options.speeds) + " |")
    print("|---" * (4 + len(options.speeds)) + "|")
    for keeper in options.keepers:
        found: dict[Any, tuple[int, int]] = odds(keeper, kinds, options.shots, options.disturbances, options.seed)
        lines = dict.fromkeys((kind.state, kind.rims, kind.spin) for kind in kinds)
        for state, rims, spin in lines:
            cells = []
            for speed in options.speeds:
                goals, count = found.get(Kind(rims, speed, spin, state), (0, 0))
                low, high = wilson_interval(goals, count) if count else (0.0, 1.0)
                cells.append(f"{100 * goals / count:.0f} ({100 * low:.0f}–{100 * high:.0f})" if count else "—")
            print(
                f"| {keeper.rpartition('/')[2]} | {state} | {rims} | {spin:g} | " + " | ".join(cells) + " |", flush=True
            )


if __name__ == "__main__":
    main()

"""Identify the puck's bounces off the rims from the simulator, and write them where the estimation reads them.

    python scripts/identify_bounces.py [--bounces 400] [--seed 0] [--write]

Pucks are shot at the rims of an otherwise quiet table. The free flights before and after a bounce are extrapolated to
where they meet: that instant gives the velocities of the instantaneous bounce (`airhockey.agents.estimation.motion`)
and how far the rim gives. Spreads are those under the profile `server`, whose rims differ from episode to episode.
"""

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import airhockey.agents.estimation as estimation
from airhockey import envs
from airhockey.agents.estimation.motion import puck_motion, slide
from airhockey.envs.specs import PUCK, TABLE

Array = NDArray[np.float64]
LIMITS = (TABLE.length / 2 - PUCK.radius, TABLE.width / 2 - PUCK.radius)


def shoot(env: envs.Environment, axis: int, state: Array, steps: int = 60) -> Array:
    """States of the puck at every control step until well after its bounce. Shape (k, 5)."""
    base = env.base_observation
    base[:6] = [state[0], state[1], 0.0, state[2], state[3], state[4]]
    env.reset(state=base)
    joints = env.base_observation[6 : 6 + env.env_info["robot"]["n_joints"]]
    action, states, after = np.stack([joints, np.zeros_like(joints)]), [state], 0
    for _ in range(steps):
        env.step(action)
        states.append(env.base_observation[[0, 1, 3, 4, 5]])
        after += states[-1][2 + axis] * state[2 + axis] < 0
        if after > 3:
            break
    return np.array(states)


def free_flight(state: Array, duration: float) -> Array:
    """A state some time later, or earlier. Shape (5,)."""
    moved = state.copy()
    slide(moved, duration, puck_motion().constants)
    return moved


def bounce_of(states: Array, axis: int, dt: float) -> tuple[Array, Array, float] | None:
    """States just before and after the bounce, and how far beyond the rim's edge it took place, in [m]."""
    turned = np.flatnonzero(states[:, 2 + axis] * states[0, 2 + axis] < 0)
    if len(turned) < 3 or turned[0] < 3:
        return None
    before, after = turned[0] - 2, turned[0] + 2  # a contact lasts at most two steps
    gap = (after - before) * dt
    low, high = 0.0, gap
    for _ in range(60):  # where do the two flights meet along the normal?
        middle = 0.5 * (low + high)
        ahead = free_flight(states[before], middle)[axis] - free_flight(states[after], middle - gap)[axis]
        low, high = (middle, high) if ahead * states[0, 2 + axis] < 0 else (low, middle)
    into, out = free_flight(states[before], low), free_flight(states[after], low - gap)
    return into, out, abs(into[axis]) - LIMITS[axis]


def collect(env: envs.Environment, bounces: int, random: np.random.Generator) -> tuple[Array, ...]:
    """Normal velocities in and out, slips, tangential and spin changes, and gives of many bounces."""
    rows = []
    while len(rows) < bounces:
        axis = len(rows) % 2
        side = random.choice([-1.0, 1.0]) if axis == 1 else 1.0
        speed, angle, spin = random.uniform(0.3, 3.0), random.uniform(-1.1, 1.1), random.uniform(-20.0, 20.0)
        normal, tangential = side * speed * np.cos(angle), speed * np.sin(angle)
        state = np.array([0.6, random.uniform(0.18, 0.4) * random.choice([-1, 1]), normal, tangential, spin])
        if axis == 1:
            state[:4] = [random.uniform(0.2, 0.6), side * 0.25, tangential, normal]
        found = bounce_of(shoot(env, axis, state), axis, env.dt)
        if found is None:
            continue
        into, out, give = found
        other = 1 - axis
        turn = side if axis == 0 else -side
        slip = into[2 + other] + turn * PUCK.radius * into[4]
        change = out[2 + other] - into[2 + other]
        spin_change = turn * PUCK.radius * (out[4] - into[4])
        rows.append([abs(into[2 + axis]), abs(out[2 + axis]), slip, change, spin_change, give])
    return tuple(np.array(rows).T)


def identify(env: envs.Environment, bounces: int, seed: int) -> dict[str, float]:
    """The parameters of `PuckMotion`. Medians: one bounce in ten is odd (a corner, or an early end of the contact)."""
    into, out, slip, change, spin_change, give = collect(env, bounces, np.random.default_rng(seed))
    slipping = np.abs(slip) > 0.1
    impulses = np.concatenate([-change[slipping] / slip[slipping], -0.5 * spin_change[slipping] / slip[slipping]])
    return {
        "restitution": float(np.median(out / into)),
        "slip_impulse": float(np.median(impulses)),
        "rim_give": float(np.median(give)),
        "restitution_spread": central_spread(out / into),
        "slip_spread": central_spread(impulses),
    }


def central_spread(values: Array) -> float:
    """Half the width of the middle 68 %: the standard deviation, if the values were normal."""
    low, high = np.quantile(values, [0.16, 0.84])
    return float(0.5 * (high - low))


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bounces", type=int, default=400)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--write", action="store_true", help="write bounces.yaml of airhockey.agents.estimation")
    arguments = parser.parse_args()
    ideal = identify(envs.make("7dof-prepare"), arguments.bounces, arguments.seed)
    server = identify(envs.make("7dof-prepare", disturbances="server"), arguments.bounces, arguments.seed)
    spreads = {key: max(ideal[key], server[key]) for key in ("restitution_spread", "slip_spread")}
    lines = [f"{key}: {value:.4f}" for key, value in (ideal | spreads).items()]
    print("\n".join(lines))
    if arguments.write:
        header = (
            f"# Bounces of the puck off the rims, by scripts/identify_bounces.py --bounces {arguments.bounces} "
            f"--seed {arguments.seed}.\n# MuJoCo {envs.versions()['mujoco']}; spreads under the profile server. "
            "What each key means: motion.py.\n"
        )
        path = Path(str(estimation.__file__)).parent / "bounces.yaml"
        path.write_text(header + "\n".join(lines) + "\n", encoding="utf-8")
        print(f"written to {path.name}")


if __name__ == "__main__":
    main()

"""Make the recordings that guard the simulation: tests/data/recordings/*.npz, replayed by tests/envs/test_recordings.py.

    python scripts/record.py [--folder tests/data/recordings] [--edition 2025]

Make them anew only when the simulation is meant to change, and say why. A recording holds the start, the actions and what
came of them. A mallet that meets a puck amplifies rounding, so each one also carries `chaos`: how far the same actions,
changed in their last bit, lead away from it at every step. A replay may differ by that much, and hardly more.
"""

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey import envs

Array = NDArray[np.float64]
Puck = tuple[float, float, float, float, float, float]
NO_ORDER = -99
"""Stands for the interpolation order `None` in a recording."""
PERTURBATIONS = 3
SPARSE = 50
"""Long games keep every so many observations; the others are NaN."""


@dataclass(frozen=True)
class Plan:
    """What to record.

    Attributes:
        kind: How the players move: "sweep", "wild", "strike"; with any other kind they stand still.
        steps: At most so many control steps in each serve; one that ends earlier is over.
        pucks: Start of each serve in world coordinates: position, yaw and their rates; none: a start drawn with the seed.
        sparse: Keep few observations.
        edition: The year whose rules apply.
    """

    env: str
    kind: str
    order: int | None = 3
    seed: int = 1
    steps: int = 15
    pucks: tuple[Puck, ...] = ()
    sparse: bool = False
    edition: str = "2023"

    @property
    def name(self) -> str:
        """Of the file."""
        year = "" if self.edition == "2023" else f"{self.edition}-"
        return f"{year}{self.env}_{self.kind}_o{'none' if self.order is None else self.order}_s{self.seed}"


BEFORE_THE_MALLET = ((-0.72, 0.02, 0.0, 0.0, 0.0, 0.0),)
SERVES = (
    (0.85, 0.088, 0.3, 3.0, 0.0, 1.0),  # a goal for player 1
    (-0.85, -0.088, 0.0, -2.0, 0.0, 0.0),  # a goal for player 2
    (0.14, 0.3, 0.0, -2.0, -1.0, 0.0),  # over the middle line
    (0.1, 0.2, 0.0, 0.01, 0.0, 0.0),  # stuck in the middle
    (0.7, 0.4, 0.0, 1.5, 1.8, -20.0),  # into a corner
)
PLANS = (
    *(Plan(env, "hold") for env in envs.ENVIRONMENTS),
    *(Plan(env, "sweep", order) for env in ("3dof-defend", "7dof-prepare") for order in (1, 2, 3, 4, 5, -1)),
    *(Plan(env, "sweep", None, steps=4) for env in ("3dof-defend", "7dof-prepare")),
    *(Plan(env, "sweep", seed=2) for env in ("3dof-hit", "7dof-hit", "7dof-defend", "tournament")),
    *(Plan(env, "wild", order, steps=12) for env in ("3dof-hit", "7dof-prepare", "tournament") for order in (-1, 3, 5)),
    Plan("7dof-hit", "strike", steps=40, pucks=BEFORE_THE_MALLET),
    Plan("3dof-hit", "strike", steps=20, pucks=BEFORE_THE_MALLET),
    Plan("7dof-defend", "rims", steps=40, pucks=((-0.7, 0.35, 0.1, -2.0, 1.5, 5.0),)),
    Plan("3dof-hit", "ends", pucks=((0.85, 0.05, 0.0, 3.0, 0.0, 0.0), (0.9, 0.3, 0.0, 2.0, 0.0, 0.0))),
    Plan("7dof-defend", "ends", pucks=((-0.5, 0.2, 0.0, -0.105, 0.0, 0.0), (-0.1, 0.2, 0.0, 1.0, 0.0, 0.0))),
    Plan("7dof-prepare", "ends", pucks=((-0.5, 0.1, 0.0, 0.0, -0.8, 0.0), (-0.05, 0.2, 0.0, 0.8, 0.0, 0.0))),
    Plan("tournament", "serves", pucks=SERVES),
    *(Plan(env, "sweep", seed=2, edition="2025") for env in envs.edition("2025").environments),
    Plan("hit", "strike", steps=40, pucks=BEFORE_THE_MALLET, edition="2025"),
    Plan("defend", "rims", -1, steps=40, pucks=((-0.7, 0.35, 0.1, -2.0, 1.5, 5.0),), edition="2025"),
    Plan("prepare", "sweep", None, steps=4, edition="2025"),
    Plan("hit_single", "wild", 5, steps=12, edition="2025"),
    Plan("tournament", "strike", steps=40, pucks=((-0.72, 0.0, 0.0, 0.0, 0.0, 0.0), SERVES[0]), edition="2025"),
    Plan("tournament", "fault", steps=752, pucks=((-0.5, 0.2, 0.0, 0.0, 0.0, 0.0),), sparse=True),
)


def actions(plan: Plan, env: envs.Environment) -> Iterator[Array]:
    """Actions without end, in the format of the plan's order."""
    set_point = _set_points(plan, env)
    rows: dict[int, Any] = {1: 0, 2: 0, 3: slice(2), 4: slice(2), 5: slice(3), -1: slice(2)}
    for step in count(1):
        if plan.order is None:
            action = np.array([set_point(env.dt * (step - 1) + 0.001 * k) for k in range(1, 21)])
        else:
            action = set_point(env.dt * step)[rows[plan.order]]
        action = action.astype(np.float32).astype(np.float64)  # numbers with few digits need little room in a file
        yield action if env.n_players == 1 else np.stack([action, action])


def _set_points(plan: Plan, env: envs.Environment) -> Callable[[float], Array]:
    """Position, velocity and acceleration of the joints over time, in [rad] and [s]. Shape (3, n)."""
    random = np.random.default_rng(plan.seed)
    n = env.env_info["robot"]["n_joints"]
    start = env.true_observation[6 : 6 + n]
    still = np.stack([start, np.zeros(n), np.zeros(n)])
    if plan.kind == "wild":
        return lambda _: random.uniform(-20.0, 20.0, (3, n)) * [[1.0], [5.0], [100.0]]
    if plan.kind == "strike":
        stroke = list(_stroke(env, start))
        return lambda t: stroke[min(round(t / env.dt), len(stroke)) - 1]
    if plan.kind == "sweep":
        phase, w = random.uniform(0.0, 2.0 * np.pi, n), 5.0

        def swing(t: float) -> Array:
            sine, cosine = np.sin(w * t + phase), np.cos(w * t + phase)
            return still + 0.1 * np.stack([sine - np.sin(phase), w * cosine, -w * w * sine])

        return swing
    return lambda _: still


def _stroke(env: envs.Environment, start: Array) -> Iterator[Array]:
    """Set-points that drive the mallet forward and stop it."""
    position, n = start.copy(), start.size
    constraint = env.env_info["constraints"].get("ee_constr")
    for k in range(1, 16):
        rows = constraint.jacobian(position, np.zeros(n))[:, :n]
        jacobian = np.stack([-rows[0], rows[2], rows[4]])  # of the end-effector's x, y, z
        velocity = np.linalg.pinv(jacobian) @ [0.9 * np.sin(np.pi * k / 15) ** 2, 0.0, 0.0]
        position = position + velocity * env.dt
        yield np.stack([position, velocity, np.zeros(n)])


def make(plan: Plan) -> envs.Environment:
    """The plan's environment."""
    return envs.make(plan.env, interpolation_order=plan.order, edition=plan.edition)


def play(plan: Plan, starts: list[Array], script: tuple[Array, Array] | None = None) -> dict[str, Array]:
    """Play the plan from the base observations `starts`; what came of it, step by step.

    Args:
        plan: What to play.
        starts: Base observation at the beginning of each serve.
        script: Play these actions instead, with the serves beginning at these steps.
    """
    env = make(plan)
    rows: dict[str, list[Any]] = {"obs0": [env.reset(state=starts[0])], "serves": [0]}
    moves = actions(plan, env) if script is None else iter(script[0])
    for serve, start in enumerate(starts):
        if serve:
            env.reset(state=start)
        ends = np.inf if script is None else np.append(script[1], len(script[0]))[serve + 1] - rows["serves"][-1]
        for step in count(1):
            action = next(moves)
            observation, _, absorbing, info = env.step(action)
            happened = {
                "actions": action,
                "obs": observation,
                "absorbing": absorbing,
                "constraints": env.constraint_values,
            }
            for key, value in (happened | info).items():
                rows.setdefault(key, []).append(value)
            if step == ends or (script is None and (absorbing or step == plan.steps)):
                break
        rows["serves"].append(len(rows["obs"]))
    del rows["constraints_value"]
    return {key: np.array(values) for key, values in rows.items()} | {"serves": np.array(rows["serves"][:-1])}


def starts_of(plan: Plan) -> list[Array]:
    """The base observation at the beginning of every serve."""
    env = make(plan)
    env.reset(seed=plan.seed)
    base = env.base_observation
    starts = []
    for puck in plan.pucks:
        rows = base.reshape(env.n_agents, -1).copy()
        rows[:, :6] = puck
        starts.append(rows.flatten())
    return starts or [base]


def record(plan: Plan) -> dict[str, Any]:
    """Play a plan, and again with other last bits; the arrays of its file."""
    starts = starts_of(plan)
    arrays = play(plan, starts)
    serves, values = arrays.pop("serves"), arrays.pop("constraints")
    arrays["chaos"] = chaos(plan, starts, arrays, serves).astype(np.float32)
    if plan.sparse:
        dropped = np.arange(len(values)) % SPARSE != 0
        dropped[-2:] = False
        arrays["obs"][dropped] = values[dropped] = arrays["jerk"][dropped] = np.nan
    arrays["jerk"] = arrays["jerk"].astype(np.float32)
    arrays |= {"env": np.array(plan.env), "order": np.array(NO_ORDER if plan.order is None else plan.order)}
    if plan.edition != "2023":
        arrays["edition"] = np.array(plan.edition)
    arrays |= {"init_base_obs": starts[0], "obs0": arrays["obs0"][0]}
    arrays |= {"reset_steps": serves[1:], "reset_base_obs": np.array(starts[1:])}
    return arrays | constraint_arrays(plan, values.astype(np.float32))


def chaos(plan: Plan, starts: list[Array], played: dict[str, Array], serves: Array) -> Array:
    """Largest difference in each step's observation when the actions differ in their last bit. Shape (steps,)."""
    random = np.random.default_rng(0)
    result = np.zeros(len(played["obs"]))
    for _ in range(PERTURBATIONS):
        towards = random.choice([-np.inf, np.inf], played["actions"].shape)
        moved = play(plan, starts, (np.nextafter(played["actions"], towards), serves))
        result = np.maximum(result, np.abs(moved["obs"] - played["obs"]).max(axis=1))
    return result


def constraint_arrays(plan: Plan, values: Array) -> dict[str, Array]:
    """The constraint values by name, and player in the tournament."""
    parts = make(plan).constraint_slices.items()
    if values.ndim == 2:
        return {f"c_{name}": values[:, part] for name, part in parts}
    return {f"c_{player}_{name}": values[:, player, part] for player in range(2) for name, part in parts}


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=Path("tests/data/recordings"))
    parser.add_argument("--edition", help="record only those of this edition")
    given = parser.parse_args()
    folder: Path = given.folder
    folder.mkdir(parents=True, exist_ok=True)
    for plan in PLANS:
        if given.edition not in (None, plan.edition):
            continue
        arrays = record(plan)
        path = folder / f"{plan.name}.npz"
        np.savez_compressed(path, **arrays)
        ends = np.flatnonzero(arrays["absorbing"])
        print(
            f"{path.name:36s} {path.stat().st_size / 1000:6.1f} kB, chaos {arrays['chaos'].max():.0e}, ends at {ends[:6]}"
        )


if __name__ == "__main__":
    main()

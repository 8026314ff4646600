"""What chapter 5 of the thesis prints: its tables as they stand there, and what its figures show, in a sentence each."""

from dataclasses import dataclass


@dataclass(frozen=True)
class TaskTable:
    """A table of an evaluation on the organisers' server.

    Attributes:
        caption: As printed.
        success: Environment -> share of successes.
        penalty: Environment -> penalty points; of 1000 episodes.
    """

    caption: str
    success: dict[str, float]
    penalty: dict[str, float]


@dataclass(frozen=True)
class GameTable:
    """A table of one whole game against the organisers' baseline.

    Attributes:
        caption: As printed.
        violations: Constraint -> how often it was violated; 0 where the table has no column for it.
        points: Penalty points.
    """

    caption: str
    violations: dict[str, int]
    points: float


WARM_UP = TaskTable(
    "Warm-up, planar robot, server (table 5.1)",
    {"3dof-hit": 0.850, "3dof-defend": 0.122},
    {"3dof-hit": 4402.0, "3dof-defend": 3096.0},
)
QUALIFYING = TaskTable(
    "Qualifying, iiwa, server (tables 5.2 and 5.3)",
    {"7dof-hit": 0.227, "7dof-defend": 0.616, "7dof-prepare": 0.362},
    {"7dof-hit": 920.0, "7dof-defend": 1.5, "7dof-prepare": 329.0},
)
COLUMNS = {
    "joint_vel_constr": "joint velocity",
    "joint_pos_constr": "joint position",
    "ee_constr": "end-effector",
    "link_constr": "link",
    "computation_time": "computation time",
}
"""Constraint -> the tables' word for it."""


def _game(caption: str, counts: tuple[int, int, int, int, int], points: float) -> GameTable:
    return GameTable(caption, dict(zip(COLUMNS, counts, strict=True)), points)


GAMES = {
    "table-5.4": _game("Switcher alone (table 5.4)", (22, 14, 7, 1, 0), 81.0),
    "table-5.5": _game("Switcher and state machine (table 5.5)", (13, 3, 9, 1, 0), 49.0),
    "table-5.6": _game("Switcher, state machine and rule-based way home (table 5.6)", (15, 0, 5, 0, 2), 31.0),
    "table-5.7": _game(
        "Switcher, state machine and a way home trained with ATACOM (table 5.7)", (12, 0, 4, 0, 1), 24.5
    ),
}
FIGURES = {
    "figure-5.1": "Training all four θ of the hit with the sparse reward (5.1): the return stays where it is, noisy.",
    "figure-5.2": "Training one θ of the hit with the others fixed: some improvement of the moving average, much noise.",
    "figure-5.3": "Updates of mean and σ of a single θ: nearly symmetric, with slightly more positive ones. With the "
    "puck's starting position, velocity or both fixed, the return oscillates as before (5.2).",
    "figure-5.4": "Training with the dense reward, γ = 0.997, learning rate 10⁻⁴: the return grows over about 1,000 updates.",
    "figure-5.5": "Means and σ of the four θ in that training move in a coherent direction.",
}
"""What the thesis says of its figures, which hold no numbers."""

"""What a training run is, in records."""

from typing import Literal

import msgspec


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What decides a run's result.

    Attributes:
        task: Which skill.
        robot: "3dof" or "7dof".
        algorithm: SAC, or the optimistic actor critic.
        steps: Actions in all; the learning rate falls linearly to a tenth over them.
        seed: Of everything.
        disturbances: Profile that is trained in.
        optimism: δ of the optimistic actor critic.
        hidden: Units of each of the two hidden layers.
        batch: Transitions of an update.
        updates: Updates per action; they are made after each episode.
        learning_rate: Of actor, critics and entropy coefficient, at the beginning.
        discount: γ.
        warm_up: Actions before the first update, drawn at random.
        log_every: Episodes of a line in the log.
        save_every: Episodes of a checkpoint.
    """

    task: Literal["defend", "home"] = "defend"
    robot: Literal["3dof", "7dof"] = "7dof"
    algorithm: Literal["sac", "oac"] = "sac"
    steps: int = 200_000
    seed: int = 0
    disturbances: str = "ideal"
    optimism: float = 0.5
    hidden: int = 128
    batch: int = 256
    updates: float = 0.5
    learning_rate: float = 1e-3
    discount: float = 0.98
    warm_up: int = 2000
    log_every: int = 50
    save_every: int = 250


class Line(msgspec.Struct, frozen=True):
    """A line of the log.

    Attributes:
        episode, steps, control_steps: Counts since the beginning: episodes, actions, steps of the simulation.
        mean_return, success: Means over the episodes since the last line.
        violations: Share of the control steps since the last line that violated a constraint.
        entropy: Its coefficient.
        steps_per_second: Actions.
    """

    episode: int
    steps: int
    control_steps: int
    mean_return: float
    success: float
    violations: float
    entropy: float
    steps_per_second: float

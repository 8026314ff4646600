"""What a training run is, in records."""

from typing import Literal

import msgspec


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What decides a run's result.

    Attributes:
        task: Name of the environment.
        actions: What an action means (`airhockey.agents.learned.actions`).
        reward: See `airhockey.learning.envs.batch`.
        steps: Actions in all, rounded up to whole iterations; the learning rate falls linearly to a tenth over them.
        seed: Of everything.
        disturbances: Profile that is trained in.
        envs: Environments that are played at the same time.
        rollout: Actions in each of them between updates.
        epochs: Passes over these.
        batch: Actions of an update.
        hidden: Units of each of the two hidden layers, of policy and value.
        learning_rate: At the beginning.
        discount, trace: γ, and λ of the advantages.
        repeat: Control steps that an action lasts.
        save_every: Iterations of a checkpoint.
    """

    task: str = "7dof-defend"
    actions: Literal["joints", "tip", "mallet"] = "tip"
    reward: Literal["shaped", "progress", "success"] = "shaped"
    steps: int = 1_000_000
    seed: int = 0
    disturbances: str = "ideal"
    envs: int = 32
    rollout: int = 128
    epochs: int = 6
    batch: int = 512
    hidden: int = 128
    learning_rate: float = 5e-4
    discount: float = 0.99
    trace: float = 0.95
    repeat: int = 2
    save_every: int = 10


class Line(msgspec.Struct, frozen=True):
    """A line of the log.

    Attributes:
        iteration, steps, control_steps: Counts since the beginning: iterations, actions, steps of the simulation.
        mean_return, success: Means over the latest hundred episodes.
        violations: Share of all control steps so far that violated a constraint.
        steps_per_second: Actions.
    """

    iteration: int
    steps: int
    control_steps: int
    mean_return: float
    success: float
    violations: float
    steps_per_second: float

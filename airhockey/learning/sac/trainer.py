"""The training loop: an episode, its updates, a line in the log; and a checkpoint from which a killed run goes on.

Every episode starts from a seed of its own, and a checkpoint holds all random states, so that a run that was resumed is
the run that was not interrupted, step for step.
"""

import csv
import os
import pickle
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3 import SAC
from stable_baselines3.common.logger import Logger

from airhockey.agents.atacom.features import ACTION_MIRROR
from airhockey.agents.atacom.skill import SKILLS
from airhockey.errors import AirHockeyError
from airhockey.learning.sac.algorithms import OAC, MirroredReplay
from airhockey.learning.sac.skill_tasks import TASKS

COLUMNS = ("episode", "steps", "control_steps", "return", "success", "violations", "entropy", "steps_per_second")
"""Of the log: counts so far; mean return and share of successes of the episodes since the last line; share of control
steps since then that violated a constraint; entropy coefficient; actions per second."""


@dataclass(frozen=True)
class SacOptions:
    """What a run is made of.

    Attributes:
        task: "defend" or "home".
        robot: "3dof" or "7dof".
        algorithm: "sac" or "oac".
        steps: Actions in all.
        seed: Of the run.
        disturbances: Profile that is trained in.
        optimism: δ of OAC.
        hidden: Units of each of the two hidden layers.
        batch: Transitions of an update.
        updates: Gradient steps per action.
        learning_rate: Of actor, critics and entropy, at the beginning; it falls linearly to a tenth.
        discount: γ.
        warm_up: Actions before the first update, drawn at random.
        log_every: Episodes of a line in the log.
        save_every: Episodes of a checkpoint.
    """

    task: str = "defend"
    robot: str = "7dof"
    algorithm: str = "sac"
    steps: int = 300_000
    seed: int = 0
    disturbances: str = "ideal"
    optimism: float = 5.0
    hidden: int = 128
    batch: int = 128
    updates: float = 1.0
    learning_rate: float = 1e-3
    discount: float = 0.98
    warm_up: int = 2000
    log_every: int = 50
    save_every: int = 500


@dataclass
class Progress:
    """Where a run stands.

    Attributes:
        episode, steps: Finished episodes, and actions.
        owed: Gradient steps that are due.
    """

    episode: int = 0
    steps: int = 0
    owed: float = 0.0


class Diverged(AirHockeyError):
    """A return or a parameter is not finite."""


class Trainer:
    """One run in one folder: `log.csv`, `checkpoint.pkl`, and `model.zip` as Stable-Baselines3 stores it.

    A checkpoint is this program's own file; like any pickle it must not be taken from strangers.
    """

    def __init__(self, options: SacOptions, folder: Path) -> None:
        """Begin.

        Args:
            options: Of the run.
            folder: Exists.
        """
        self.options, self.folder, self.progress = options, folder, Progress()
        torch.set_num_threads(1)
        self.env = TASKS[options.task](options.robot, options.disturbances)
        self._rows: list[list[float]] = []
        self.model = self._make_model()
        self._since = (0, 0)

    def run(self, on_line: Callable[[dict[str, float]], None] | None = None) -> None:
        """Train to the end of the run; a checkpoint is written on the way, at the end, and when interrupted.

        Raises:
            Diverged: The last checkpoint is the last good one.
        """
        for line in self._lines():
            if on_line is not None:
                on_line(line)
        self.save()

    def _make_model(self) -> SAC:
        o = self.options
        keywords: dict[str, Any] = {
            "learning_rate": o.learning_rate,
            "buffer_size": min(o.steps + 1000, 500_000),
            "batch_size": o.batch,
            "gamma": o.discount,
            "ent_coef": "auto_0.1",
            "policy_kwargs": {"net_arch": [o.hidden, o.hidden]},
            "replay_buffer_class": MirroredReplay,
            "replay_buffer_kwargs": {
                "observation_mirror": SKILLS[o.task].mirror,
                "action_mirror": ACTION_MIRROR,
            },
            "seed": o.seed,
            "device": "cpu",
        }
        if o.algorithm == "oac":
            model: SAC = OAC("MlpPolicy", self.env, optimism=o.optimism, **keywords)
        else:
            model = SAC("MlpPolicy", self.env, **keywords)
        model.set_logger(Logger(None, []))
        return model

    def _lines(self) -> Iterator[dict[str, float]]:
        """Play and learn; yields a line of the log from time to time."""
        o, p = self.options, self.progress
        started, steps = time.perf_counter(), p.steps
        while p.steps < o.steps:
            self._rows.append(self._episode())
            self._learn()
            if p.episode % o.log_every == 0 or p.steps >= o.steps:
                seconds, started = time.perf_counter() - started, time.perf_counter()
                line = self._line((p.steps - steps) / seconds)
                steps = p.steps
                self._log(line)
                yield line
            if p.episode % o.save_every == 0:
                self.save()

    def _episode(self) -> list[float]:
        """One episode into the replay buffer. Returns its return, success, control steps and violations."""
        p, env, before = self.progress, self.env, (self.env.steps, self.env.violations)
        seed = np.random.SeedSequence(self.options.seed, spawn_key=(p.episode,))
        observation, _ = env.reset(options={"seed": seed})
        total, over, info = 0.0, False, {}
        while not over:
            action = self._act(observation)
            after, reward, terminated, truncated, info = env.step(action)
            over = terminated or truncated
            notes = [{"TimeLimit.truncated": truncated and not terminated}]
            self.model.replay_buffer.add(  # type: ignore[union-attr]
                observation[None], after[None], action[None], np.array([reward]), np.array([over]), notes
            )
            observation, total = after, total + reward
            p.steps += 1
            if p.steps > self.options.warm_up:
                p.owed += self.options.updates
        p.episode += 1
        if not np.isfinite(total):
            raise Diverged(f"the return of episode {p.episode} is {total}; the last checkpoint is the last good one")
        return [total, float(info["success"]), env.steps - before[0], env.violations - before[1]]

    def _act(self, observation: Any) -> Any:
        if self.progress.steps < self.options.warm_up:
            return np.random.uniform(-1.0, 1.0, 2).astype(np.float32)
        return self.model.predict(observation, deterministic=False)[0]

    def _learn(self) -> None:
        """The updates that are due."""
        p, o = self.progress, self.options
        due = int(p.owed)
        if due:
            p.owed -= due
            share = 1.0 - 0.9 * min(p.steps / o.steps, 1.0)
            self.model.lr_schedule = lambda _: o.learning_rate * share
            self.model.train(due, o.batch)
            if not torch.isfinite(next(self.model.actor.parameters())).all():
                raise Diverged(f"a parameter is not finite after {p.steps} actions; the last checkpoint is the last good one")

    def _line(self, speed: float) -> dict[str, float]:
        rows, self._rows = np.array(self._rows), []
        entropy = float(self.model.log_ent_coef.detach().exp()) if self.model.log_ent_coef is not None else 0.0
        p = self.progress
        means = (rows[:, 0].mean(), rows[:, 1].mean(), rows[:, 3].sum() / rows[:, 2].sum())
        return dict(zip(COLUMNS, (p.episode, p.steps, self.env.steps, *means, entropy, speed), strict=True))

    def _log(self, line: dict[str, float]) -> None:
        path = self.folder / "log.csv"
        new = not path.exists()
        with path.open("a", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            if new:
                writer.writerow(COLUMNS)
            writer.writerow([f"{value:.6g}" if isinstance(value, float) else value for value in line.values()])

    def save(self) -> None:
        """Write the checkpoint; a reader sees the old one or the new one, never half of one."""
        state = {
            "options": asdict(self.options),
            "progress": asdict(self.progress),
            "rows": self._rows,
            "counts": (self.env.steps, self.env.violations),
            "parameters": self.model.get_parameters(),
            "updates": self.model._n_updates,
            "replay": self.model.replay_buffer,
            "torch": torch.get_rng_state(),
            "numpy": np.random.get_state(),
            "log": _size(self.folder / "log.csv"),
        }
        path = self.folder / "checkpoint.pkl"
        part = path.with_suffix(".part")
        with part.open("wb") as file:
            pickle.dump(state, file, protocol=5)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)

    @classmethod
    def resume(cls, folder: Path) -> "Trainer":
        """Take up the run of a folder at its last checkpoint."""
        with (folder / "checkpoint.pkl").open("rb") as file:
            state = pickle.load(file)
        trainer = cls(SacOptions(**state["options"]), folder)
        trainer.progress, trainer._rows = Progress(**state["progress"]), state["rows"]
        trainer.env.steps, trainer.env.violations = state["counts"]
        trainer.model.set_parameters(state["parameters"], exact_match=True, device="cpu")
        trainer.model._n_updates, trainer.model.replay_buffer = state["updates"], state["replay"]
        torch.set_rng_state(state["torch"])
        np.random.set_state(state["numpy"])
        log = folder / "log.csv"
        if log.exists():
            os.truncate(log, min(state["log"], _size(log)))
        return trainer


def _size(path: Path) -> int:
    return path.stat().st_size if path.exists() else 0

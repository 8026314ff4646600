"""The training loop: an episode, its updates, a line in the log; and a checkpoint from which a killed run goes on.

Every episode starts from a seed of its own, and a checkpoint holds all random states, so that a run that was resumed is
the run that was not interrupted, step for step.
"""

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np
import torch
from stable_baselines3 import SAC
from stable_baselines3.common.logger import Logger

from airhockey.agents.atacom.features import ACTION_MIRROR
from airhockey.agents.atacom.network import Network
from airhockey.agents.atacom.skill import SKILLS
from airhockey.envs.disturbances import Disturbances
from airhockey.learning.diverged import DivergedError
from airhockey.learning.sac.algorithms import OAC, MirroredReplay
from airhockey.learning.sac.folder import SkillFolder
from airhockey.learning.sac.records import Line, Settings
from airhockey.learning.sac.skill_env import SkillEnv
from airhockey.learning.sac.skill_tasks import TASKS

LARGEST_BUFFER = 500_000
"""Transitions; older ones are forgotten."""


@dataclass
class Progress:
    """Where a run stands.

    Attributes:
        episode, steps: Finished episodes, and actions.
        owed: Updates that are due.
    """

    episode: int = 0
    steps: int = 0
    owed: float = 0.0


def make_env(settings: Settings, profile: Disturbances) -> SkillEnv:
    """The environment of a run, with the disturbances that it began with."""
    return TASKS[settings.task](settings.robot, profile)


def make_model(settings: Settings, env: SkillEnv) -> SAC:
    """Stable-Baselines3's SAC, or OAC."""
    optimistic = settings.algorithm == "oac"
    kind: Callable[..., SAC] = partial(OAC, optimism=settings.optimism) if optimistic else SAC
    model = kind(
        "MlpPolicy",
        env,
        learning_rate=settings.learning_rate,
        buffer_size=min(settings.steps + 1000, LARGEST_BUFFER),
        batch_size=settings.batch,
        gamma=settings.discount,
        ent_coef="auto_0.1",
        policy_kwargs={"net_arch": [settings.hidden, settings.hidden]},
        replay_buffer_class=MirroredReplay,
        replay_buffer_kwargs={"observation_mirror": SKILLS[settings.task].mirror, "action_mirror": ACTION_MIRROR},
        seed=settings.seed,
        device="cpu",
    )
    model.set_logger(Logger(None, []))
    return model


class Trainer:
    """One run in one folder.

    Attributes:
        settings: Of the run.
        env: Where it is played.
        model: What learns.
        progress: Where it stands.
    """

    def __init__(self, folder: SkillFolder) -> None:
        """Begin, or go on at the folder's last checkpoint.

        Args:
            folder: Of the run.
        """
        torch.set_num_threads(1)
        self._folder, self.settings, self.progress = folder, folder.manifest.options, Progress()
        self.env = make_env(self.settings, folder.manifest.profile)
        self.model = make_model(self.settings, self.env)
        self._rows: list[tuple[float, float, int, int]] = []
        state = folder.load()
        if state is not None:
            self._restore(state)

    @property
    def network(self) -> Network:
        """The policy's mean, for play."""
        actor = self.model.actor
        layers = [layer for layer in actor.latent_pi if isinstance(layer, torch.nn.Linear)] + [actor.mu]
        weights = {}
        for k, layer in enumerate(layers):
            weights[f"weight_{k}"] = layer.weight.detach().numpy().copy()
            weights[f"bias_{k}"] = layer.bias.detach().numpy().copy()
        return Network(weights)

    def run(self, on_line: Callable[[Line], None] | None = None) -> None:
        """Train to the end of the run, with checkpoints on the way and at the end.

        Raises:
            DivergedError: The last checkpoint is the last good one.
        """
        s, p = self.settings, self.progress
        since = time.perf_counter(), p.steps
        while p.steps < s.steps:
            self._rows.append(self._episode())
            self._learn()
            if p.episode % s.log_every == 0 or p.steps >= s.steps:
                now = time.perf_counter(), p.steps
                line = self._line((now[1] - since[1]) / (now[0] - since[0]))
                since = now
                self._folder.add(line)
                if on_line is not None:
                    on_line(line)
            if p.episode % s.save_every == 0 or p.steps >= s.steps:
                self.save()

    def _episode(self) -> tuple[float, float, int, int]:
        """One episode into the replay buffer. Returns return, success, control steps and how many violated."""
        p, env, before = self.progress, self.env, (self.env.steps, self.env.violations)
        seed = np.random.SeedSequence(self.settings.seed, spawn_key=(p.episode,))
        observation, info = env.reset(options={"seed": seed})
        total, over = 0.0, False
        while not over:
            action = self._act(observation)
            after, reward, terminated, truncated, info = env.step(action)
            over = terminated or truncated
            assert self.model.replay_buffer is not None
            self.model.replay_buffer.add(
                observation[None],
                after[None],
                action[None],
                np.array([reward]),
                np.array([over]),
                [{"TimeLimit.truncated": truncated and not terminated}],
            )
            observation, total = after, total + reward
            p.steps += 1
            if p.steps > self.settings.warm_up:
                p.owed += self.settings.updates
        p.episode += 1
        if not np.isfinite(total):
            raise DivergedError(f"the return of episode {p.episode} is {total}")
        return total, float(info["success"]), env.steps - before[0], env.violations - before[1]

    def _act(self, observation: Any) -> Any:
        if self.progress.steps < self.settings.warm_up:
            return np.random.uniform(-1.0, 1.0, 2).astype(np.float32)
        return self.model.predict(observation, deterministic=False)[0]

    def _learn(self) -> None:
        """The updates that are due."""
        p, s = self.progress, self.settings
        due = int(p.owed)
        if not due:
            return
        p.owed -= due
        rate = s.learning_rate * (1.0 - 0.9 * min(p.steps / s.steps, 1.0))
        self.model.lr_schedule = lambda _: rate
        self.model.train(due, s.batch)
        if not all(torch.isfinite(parameter).all() for parameter in self.model.actor.parameters()):
            raise DivergedError(f"a parameter is not finite after {p.steps} actions")

    def _line(self, speed: float) -> Line:
        rows, self._rows = np.array(self._rows), []
        p, entropy = self.progress, self.model.log_ent_coef
        return Line(
            p.episode, p.steps, self.env.steps, float(rows[:, 0].mean()), float(rows[:, 1].mean()),
            float(rows[:, 3].sum() / rows[:, 2].sum()), float(entropy.detach().exp()) if entropy is not None else 0.0,
            speed,
        )  # fmt: skip

    def save(self) -> None:
        """Write a checkpoint."""
        state = {
            "progress": asdict(self.progress),
            "rows": self._rows,
            "counts": (self.env.steps, self.env.violations),
            "parameters": self.model.get_parameters(),
            "updates": self.model._n_updates,
            "replay": self.model.replay_buffer,
            "torch": torch.get_rng_state(),
            "numpy": np.random.get_state(),
        }
        self._folder.save(state, self.network)

    def _restore(self, state: dict[str, Any]) -> None:
        self.progress, self._rows = Progress(**state["progress"]), state["rows"]
        self.env.steps, self.env.violations = state["counts"]
        self.model.set_parameters(state["parameters"], exact_match=True, device="cpu")
        self.model._n_updates, self.model.replay_buffer = state["updates"], state["replay"]
        torch.set_rng_state(state["torch"])
        np.random.set_state(state["numpy"])

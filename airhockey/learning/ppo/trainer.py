"""The training loop: a rollout, its updates, a line in the log; and a checkpoint from which a killed run goes on.

A checkpoint holds the environments' moments and all random states: a run that was resumed is the run that was not
interrupted, step for step, whatever the number of threads.
"""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import torch

from airhockey.agents.atacom.network import Network
from airhockey.envs.disturbances import Disturbances
from airhockey.envs.vector.stable_baselines3 import BatchVecEnv
from airhockey.learning.diverged import DivergedError
from airhockey.learning.envs.batch import LearningBatch
from airhockey.learning.envs.gymnasium import learning_vector_env
from airhockey.learning.ppo.folder import PolicyFolder
from airhockey.learning.ppo.policy import make_model, network_of
from airhockey.learning.ppo.records import Line, Settings

UNSEEN = 1
"""Second entry of the spawn key of an evaluation's seeds; those of training have one entry only."""


def choice_of(settings: Settings, profile: Disturbances) -> dict[str, Any]:
    """What the environments of a run are made with."""
    s = settings
    kinds = {"actions": s.actions, "reward": s.reward, "repeat": s.repeat, "discount": s.discount}
    return {**kinds, "disturbances": profile}


class Trainer:
    """One run in one folder.

    Attributes:
        settings: Of the run.
        vec: Where it is played.
        model: What learns.
        iteration: How many rollouts there were.
    """

    def __init__(self, folder: PolicyFolder, threads: int = 1) -> None:
        """Begin, or go on at the folder's last checkpoint.

        Args:
            folder: Of the run.
            threads: That step the environments; no result depends on it.
        """
        torch.set_num_threads(1)
        self._folder, self.settings, self.iteration = folder, folder.manifest.options, 0
        s = self.settings
        env = learning_vector_env(s.task, s.envs, threads=threads, **choice_of(s, folder.manifest.profile))
        self.batch: Any = env.batch
        self.vec = BatchVecEnv(env)
        self.model = make_model(s, self.vec)
        self.vec.seed_from([np.random.SeedSequence(s.seed, spawn_key=(i,)) for i in range(s.envs)])
        _, self._callback = self.model._setup_learn(s.steps, None)
        state = folder.load()
        if state is not None:
            self._restore(state)

    @property
    def network(self) -> Network:
        """The policy's mean, for play."""
        return network_of(self.model)

    def run(self, on_line: Callable[[Line], None] | None = None) -> None:
        """Train to the end of the run, with checkpoints on the way and at the end.

        Raises:
            DivergedError: The last checkpoint is the last good one.
        """
        s, model = self.settings, self.model
        while model.num_timesteps < s.steps:
            begin = time.perf_counter()
            model.collect_rollouts(self.vec, self._callback, model.rollout_buffer, s.rollout)
            model._update_current_progress_remaining(model.num_timesteps, s.steps)
            model._current_progress_remaining = max(0.0, model._current_progress_remaining)
            model.train()
            self.iteration += 1
            if not all(torch.isfinite(values).all() for values in model.policy.parameters()):
                raise DivergedError(f"a parameter is not finite after {model.num_timesteps} actions")
            line = self._line(s.envs * s.rollout / (time.perf_counter() - begin))
            self._folder.add(line)
            if on_line is not None:
                on_line(line)
            if self.iteration % s.save_every == 0 or model.num_timesteps >= s.steps:
                self.save()

    def _line(self, speed: float) -> Line:
        episodes, successes = list(self.model.ep_info_buffer or ()), list(self.model.ep_success_buffer or ())
        return Line(
            self.iteration, self.model.num_timesteps, int(self.batch.learner.played.sum()),
            float(np.mean([one["r"] for one in episodes])) if episodes else 0.0,
            float(np.mean(successes)) if successes else 0.0, self.batch.violations, speed,
        )  # fmt: skip

    def save(self) -> None:
        """Write a checkpoint, and the player of this moment."""
        model = self.model
        state = {
            "iteration": self.iteration,
            "steps": model.num_timesteps,
            "parameters": model.get_parameters(),
            "updates": model._n_updates,
            "environments": self.vec.get_state(),
            "observations": model._last_obs,
            "starts": model._last_episode_starts,
            "episodes": (model.ep_info_buffer, model.ep_success_buffer),
            "torch": torch.get_rng_state(),
            "numpy": np.random.get_state(),
        }
        self._folder.save(state, self.network)

    def _restore(self, state: dict[str, Any]) -> None:
        model: Any = self.model
        self.iteration, model.num_timesteps = state["iteration"], state["steps"]
        model.set_parameters(state["parameters"])
        model._n_updates = state["updates"]
        self.vec.set_state(state["environments"])
        model._last_obs, model._last_episode_starts = state["observations"], state["starts"]
        model.ep_info_buffer, model.ep_success_buffer = state["episodes"]
        torch.set_rng_state(state["torch"])
        np.random.set_state(state["numpy"])


def evaluate_policy(
    settings: Settings, profile: Disturbances, network: Network, episodes: int, envs: int = 16
) -> dict[str, float]:
    """Play the policy's mean on episodes that it was not trained on.

    Args:
        settings, profile: Of the run.
        network: The policy.
        episodes: How many, each with a seed of its own.
        envs: Played at the same time.

    Returns:
        Share of successes, mean return, and share of control steps that violated a constraint.
    """
    seeds = [np.random.SeedSequence(settings.seed, spawn_key=(k, UNSEEN)) for k in range(episodes)]
    batch = LearningBatch(settings.task, min(envs, episodes), seed=0, **choice_of(settings, profile))
    returns, successes = np.zeros(episodes), np.zeros(episodes, np.bool_)
    for first in range(0, episodes, batch.num_envs):
        numbers = np.arange(first, min(first + batch.num_envs, episodes))
        told = batch.reset([seeds[min(first + i, episodes - 1)] for i in range(batch.num_envs)])
        going = np.arange(batch.num_envs) < numbers.size
        while going.any():
            told = batch.step(np.array([network(row) for row in told.observations]))
            returns[numbers] += np.where(going, told.rewards, 0.0)[: numbers.size]
            ended = going & (told.terminated | told.truncated)
            successes[first + np.flatnonzero(ended)] = told.success[ended]
            going &= ~ended
    return {
        "episodes": episodes,
        "success": float(successes.mean()),
        "mean_return": round(float(returns.mean()), 4),
        "violations": batch.violations,
    }

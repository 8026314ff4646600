"""A training run: ask for parameters, play episodes with them, tell what they were worth, keep everything."""

import contextlib
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from airhockey.agents.settings import plain
from airhockey.agents.thesis.parameters import ThesisParameters
from airhockey.errors import AirHockeyError, ConfigurationError
from airhockey.evaluator.engines.engine import InProcess
from airhockey.evaluator.engines.pool import JobFailed, Pool
from airhockey.evaluator.engines.processes import Processes
from airhockey.evaluator.play.blame import machine_ended
from airhockey.evaluator.runs.journal import NAME as JOURNAL
from airhockey.inputs.broken import reading_errors
from airhockey.learning.diverged import DivergedError
from airhockey.learning.pgpe.folder import TrainingFolder
from airhockey.learning.pgpe.hyperpolicy import Hyperpolicy
from airhockey.learning.pgpe.penalty_budget import PenaltyBudget
from airhockey.learning.pgpe.records import Iteration, Outcome, RolloutJob, Settings
from airhockey.learning.pgpe.rollouts import Rollouts
from airhockey.learning.pgpe.schedule import learning_rate
from airhockey.learning.pgpe.search import Pgpe, Search, check_progress
from airhockey.learning.pgpe.trainable import bounds

Array = NDArray[np.float64]
OnEpisode = Callable[[Outcome], None]
OnIteration = Callable[[Iteration], None]
Play = Callable[[int, Array], list[list[Outcome]]]

_SEARCH = 1
"""Key of the seeds of what is tried; episodes have another."""


def begin(settings: Settings, parameters: ThesisParameters, path: Path) -> TrainingFolder:
    """Begin a run; nothing is written when anything about it is wrong.

    Raises:
        ConfigurationError: A setting has no meaning, or the folder holds something or cannot be written.
    """
    return TrainingFolder.begin(settings, path, parameters=plain(parameters))


def resume(path: Path, asked: Mapping[str, Any] | None = None) -> TrainingFolder:
    """Take up a run that was interrupted, or let a finished one go on.

    Args:
        path: Its folder.
        asked: Fields of `Settings` that the user repeated; they must be the run's, but for the number of iterations.

    Raises:
        ConfigurationError: There is no run, it is another than the one asked for, or the software is.
    """
    asked = dict(asked or {})
    iterations = asked.pop("iterations", None)
    folder = TrainingFolder.resume(path, asked)
    settings = folder.manifest.options
    if iterations is None or iterations == settings.iterations:
        return folder
    with folder.released_on_error():
        if settings.schedule in ("linear", "cosine"):
            raise ConfigurationError(
                f"the run's learning rate ends after {settings.iterations} iterations ({settings.schedule}): "
                f"it cannot have {iterations}"
            )
        folder.change(msgspec.structs.replace(settings, iterations=iterations))
    return folder


def train(
    folder: TrainingFolder,
    engine: InProcess | Processes | None = None,
    on_episode: OnEpisode | None = None,
    on_iteration: OnIteration | None = None,
) -> None:
    """Do the iterations of a run that are not done yet.

    The search itself is not stored: it is made again from the journal, by asking and telling what was told.

    Args:
        folder: From `begin` or `resume`; it is closed afterwards.
        engine: Where episodes are played; here, one by one, if not given.
        on_episode: Called with every outcome as it comes.
        on_iteration: Called with every iteration that is finished.

    Raises:
        DivergedError: The search went astray; the folder holds everything up to the last good iteration.
        AirHockeyError: The disk is full.
        EnvironmentFault: The environment, its disturbances or this machine failed.
        KeyboardInterrupt: The user's; the finished iterations are kept.
    """
    settings = folder.manifest.options
    with folder, (engine or InProcess()).pool(Rollouts(folder.manifest)) as pool:
        stand = _Stand(pool, settings, on_episode)
        learner = _Learner(settings, search_of(settings), PenaltyBudget(settings.max_penalty, settings.multiplier_rate))
        for done in folder.records:
            with reading_errors(folder.path / JOURNAL):
                is_ours = learner.repeat(done)
            if not is_ours:
                raise AirHockeyError(
                    f"iteration {done.iteration} of the journal is not what this search would have tried and learned"
                )
        for number in range(len(folder.records), settings.iterations):
            iteration = _iterate(learner, number, stand.play)
            folder.add(iteration)
            if on_iteration is not None:
                on_iteration(iteration)


class _Stand:
    """Where the episodes of a run are played."""

    def __init__(self, pool: Pool[RolloutJob, Outcome], settings: Settings, on_episode: OnEpisode | None) -> None:
        self._pool, self._episodes, self._on_episode = pool, settings.episodes, on_episode

    def play(self, number: int, theta: Array) -> list[list[Outcome]]:
        """The outcomes of each candidate's episodes, in order. θ of shape (N, d)."""
        jobs = [
            RolloutJob(number, candidate, episode, tuple(map(float, row)))
            for candidate, row in enumerate(theta)
            for episode in range(self._episodes)
        ]
        outcomes: dict[tuple[int, int], Outcome] = {}
        with contextlib.closing(self._pool.run(jobs)) as results:
            for job, result in results:
                if isinstance(result, JobFailed):
                    raise machine_ended(result.reason)
                outcomes[job.candidate, job.episode] = result
                if self._on_episode is not None:
                    self._on_episode(result)
        return [[outcomes[candidate, episode] for episode in range(self._episodes)] for candidate in range(len(theta))]


def search_of(settings: Settings) -> Search:
    """The search that the settings ask for, at its start."""
    mean, sigma = np.array(settings.mean), np.array(settings.sigma)
    lower, upper = bounds(settings.names)
    if settings.optimizer == "cma":
        from airhockey.learning.pgpe.evolution import CmaSearch

        return CmaSearch(mean, sigma, lower, upper, settings.candidates)
    return Pgpe(
        Hyperpolicy(mean, np.log(sigma)),
        lower,
        upper,
        natural=settings.natural,
        baseline=settings.baseline,
        normalize=settings.normalize,
        symmetric=settings.symmetric,
        sigma_share=settings.sigma_share,
        sigma_rule=settings.sigma_rule,
    )


@dataclass(frozen=True)
class _Learner:
    """A search with the budget of penalty points that its values are charged for."""

    settings: Settings
    search: Search
    budget: PenaltyBudget

    def ask(self, number: int) -> Array:
        """What an iteration tries; its generator depends on nothing that happened before. Shape (N, d)."""
        sequence = np.random.SeedSequence(self.settings.seed, spawn_key=(_SEARCH, number))
        return self.search.ask(np.random.default_rng(sequence), self.settings.candidates)

    def learn(self, number: int, theta: Array, returns: Array, penalties: Array) -> float:
        """One update; gives the learning rate."""
        settings = self.settings
        rate = learning_rate(settings.schedule, settings.learning_rate, number, settings.iterations)
        self.search.tell(theta, self.budget.values(returns, penalties), rate)
        self.budget.update(penalties)
        return rate

    def repeat(self, done: Iteration) -> bool:
        """Do an iteration again from its record; whether the record is of this search."""
        theta = self.ask(done.iteration)
        if not np.array_equal(theta, np.array(done.theta)) or not len(done.returns) == len(done.penalties) == len(
            theta
        ):
            return False
        self.learn(done.iteration, theta, np.array(done.returns), np.array(done.penalties))
        return np.array_equal(self.search.mean, done.mean) and np.array_equal(self.search.sigma, done.sigma)

    def check_progress(self, returns: Array) -> None:
        """See `search.check_progress`."""
        check_progress(self.search, np.array(self.settings.sigma), returns)


def _iterate(learner: _Learner, number: int, play: Play) -> Iteration:
    """One iteration of algorithm 2.1 or 2.2."""
    began = time.monotonic()
    theta = learner.ask(number)
    outcomes = play(number, theta)
    returns, penalties, successes = (
        np.array([np.mean([getattr(one, field) for one in of_one]) for of_one in outcomes])
        for field in ("value", "penalty", "success")
    )
    flat = [one for of_one in outcomes for one in of_one]
    errors = [one.error for one in flat if one.error is not None]
    if errors:
        raise DivergedError(f"iteration {number}: the player failed {len(errors)} of {len(flat)} episodes; {errors[0]}")
    learner.check_progress(returns)
    multiplier = learner.budget.multiplier
    rate = learner.learn(number, theta, returns, penalties)
    learner.check_progress(returns)
    violated = sorted({name for one in flat for name in one.violated})
    return Iteration(
        iteration=number,
        theta=tuple(tuple(map(float, row)) for row in theta),
        returns=tuple(map(float, returns)),
        penalties=tuple(map(float, penalties)),
        successes=tuple(map(float, successes)),
        violations={name: sum(name in one.violated for one in flat) / len(flat) for name in violated},
        mean=tuple(map(float, learner.search.mean)),
        sigma=tuple(map(float, learner.search.sigma)),
        learning_rate=rate,
        multiplier=multiplier,
        steps=sum(one.steps for one in flat),
        seconds=time.monotonic() - began,
    )

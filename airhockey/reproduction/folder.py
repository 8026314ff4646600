"""A reproduction's folder: a run's folder for every experiment, so that it can be killed at any moment and goes on.

reproduction.json   the manifest
journal.jsonl       a line per finished experiment
table-5.1-printed/  …  the experiments, each as its own command would leave it
thesis.html         the page
"""

from collections.abc import Callable
from pathlib import Path

import msgspec

from airhockey.agents.thesis.parameters import thesis_parameters
from airhockey.errors import ConfigurationError
from airhockey.evaluator import evaluation, match
from airhockey.evaluator.checks import check_seed
from airhockey.evaluator.engines.engine import InProcess
from airhockey.evaluator.engines.processes import Processes
from airhockey.evaluator.runs.folder import RunFolder
from airhockey.evaluator.runs.manifest import MATCH, REPRODUCTION, RUN, TRAINING
from airhockey.evaluator.runs.records import Options
from airhockey.learning.pgpe import training
from airhockey.learning.pgpe.folder import TrainingFolder
from airhockey.learning.pgpe.records import Settings
from airhockey.reproduction.experiments import Experiment, ReproductionOptions

PAGE = "thesis.html"
OnProgress = Callable[[int], None]


class Finished(msgspec.Struct, frozen=True, kw_only=True):
    """One line of the journal.

    Attributes:
        experiment: Its key.
    """

    experiment: str

    @property
    def key(self) -> str:
        """Of the experiment."""
        return self.experiment


class ReproductionFolder(RunFolder[ReproductionOptions, Finished]):
    """The folder of a reproduction, opened for writing."""

    name, options_type, record_type = REPRODUCTION, ReproductionOptions, Finished

    @classmethod
    def check(cls, options: ReproductionOptions) -> None:
        """Find the mistakes in its options; raises `ConfigurationError`."""
        check_seed(options.seed)
        for name in ("episodes", "games", "steps", "iterations", "rollouts", "seeds"):
            if getattr(options, name) < 1:
                raise ConfigurationError(f"the number of {name} must be positive, not {getattr(options, name)}")

    def play(self, experiment: Experiment, engine: InProcess | Processes, on_progress: OnProgress) -> None:
        """Run what is missing of an experiment.

        Args:
            experiment: Which.
            engine: Where.
            on_progress: Called with how much more of `Experiment.size` is done.
        """
        path, options = self.path / experiment.key, experiment.options
        if isinstance(options, Options):
            run = evaluation.resume(path) if (path / RUN).exists() else evaluation.begin(options, path)
            on_progress(len(run.records))
            evaluation.evaluate(run, engine, lambda _: on_progress(1))
        elif isinstance(options, Settings):
            trained = training.resume(path) if (path / TRAINING).exists() else _begin(options, path)
            on_progress(len(trained.records) * options.candidates * options.episodes)
            training.train(trained, engine, lambda _: on_progress(1))
        else:
            each = experiment.size // options.games
            games = match.resume_match(path) if (path / MATCH).exists() else match.begin_match(options, path)
            on_progress(len(games.records) * each)
            match.play_match(games, engine, lambda _: on_progress(each))
        self.keep(Finished(experiment=experiment.key))


def _begin(settings: Settings, path: Path) -> TrainingFolder:
    """A training of the player as the thesis prints it."""
    return training.begin(settings, thesis_parameters("thesis"), path)

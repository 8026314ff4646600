"""A training run's folder, written so that it can be killed at any moment.

train.json          the manifest
journal.jsonl       a line per finished iteration, with everything needed to go on
progress.csv        the same for people: iteration, return, success, penalty, multiplier, μ and σ of every θ
parameters.yaml     the player with the newest μ, as `hockey evaluate --parameters` reads it
checkpoints/        the same every so many iterations
"""

from pathlib import Path
from typing import cast

from airhockey.agents.parameters import convert
from airhockey.agents.thesis.parameters import ThesisParameters
from airhockey.evaluator.runs.disk import disk_errors, replace_file
from airhockey.evaluator.runs.folder import RunFolder
from airhockey.evaluator.runs.manifest import TRAINING
from airhockey.learning.pgpe.checks import check
from airhockey.learning.pgpe.records import Iteration, PgpeManifest, Settings
from airhockey.learning.pgpe.trainable import as_yaml, replaced

PROGRESS, PARAMETERS = "progress.csv", "parameters.yaml"
CHECKPOINT_EVERY = 10  # iterations


class TrainingFolder(RunFolder[Settings, Iteration]):
    """The folder of a training by PGPE, opened for writing."""

    name, options_type, record_type = TRAINING, Settings, Iteration
    manifest_type = PgpeManifest
    manifest: PgpeManifest[Settings]

    @classmethod
    def check(cls, options: Settings) -> None:
        """See `checks.check`."""
        check(options)

    @classmethod
    def read(cls, path: Path) -> PgpeManifest[Settings]:
        """The manifest in a folder, see `read_manifest`."""
        return cast(PgpeManifest[Settings], super().read(path))

    def recover(self) -> list[Iteration]:
        """The finished iterations; the table for people is made to say what the journal says."""
        iterations = super().recover()
        rows = [_row(one) for one in iterations]
        replace_file(self.path / PROGRESS, "".join([_header(self.manifest.options), *rows]).encode())
        return iterations

    def add(self, iteration: Iteration) -> None:
        """Keep an iteration: the journal's line makes it finished, the rest follows from it."""
        self.keep(iteration)
        with disk_errors(self.path):
            with (self.path / PROGRESS).open("a", encoding="utf-8") as progress:
                progress.write(_row(iteration))
            content = self.parameter_file(iteration).encode()
            replace_file(self.path / PARAMETERS, content)
            if (iteration.iteration + 1) % CHECKPOINT_EVERY == 0:
                (self.path / "checkpoints").mkdir(exist_ok=True)
                replace_file(self.path / "checkpoints" / f"{iteration.iteration + 1:06d}.yaml", content)

    def parameter_file(self, iteration: Iteration) -> str:
        """The player after an iteration, as YAML with where it comes from."""
        settings = self.manifest.options
        start = convert(ThesisParameters, self.manifest.parameters, TRAINING)
        values = dict(zip(settings.names, iteration.mean, strict=True))
        done = iteration.iteration + 1
        versions = ", ".join(f"{name} {version}" for name, version in self.manifest.versions.items())
        comment = (
            f"Trained by hockey train pgpe on {settings.robot}-{settings.task}, disturbances {settings.disturbances}, "
            f"seed {settings.seed}:",
            f"{settings.optimizer}, {done} iterations of {settings.candidates} x {settings.episodes} episodes, "
            f"reward {settings.reward}.",
            f"Trained: {', '.join(settings.names)}.",
            f"{versions}.",
        )
        return as_yaml(replaced(start, values), comment)


def _header(settings: Settings) -> str:
    names = settings.names
    columns = ["iteration", "return", "success", "penalty", "multiplier", "learning_rate", "steps", "seconds"]
    return ",".join([*columns, *(f"mean:{name}" for name in names), *(f"sigma:{name}" for name in names)]) + "\n"


def _row(one: Iteration) -> str:
    numbers = [one.mean_return, one.mean_success, one.mean_penalty, one.multiplier, one.learning_rate]
    ends = [*one.mean, *one.sigma]
    cells = [*(f"{x:.6g}" for x in numbers), str(one.steps), f"{one.seconds:.2f}", *(f"{x:.8g}" for x in ends)]
    return ",".join([str(one.iteration), *cells]) + "\n"

"""A training run's folder, written so that it can be killed at any moment.

train.json          the manifest
journal.jsonl       a line per finished iteration, with everything needed to go on
progress.csv        the same for people: iteration, return, success, penalty, multiplier, μ and σ of every θ
parameters.yaml     the player with the newest μ, as `hockey evaluate --parameters` reads it
checkpoints/        the same every so many iterations
"""

import contextlib
import os
from pathlib import Path
from typing import Self

import msgspec

from airhockey.agents.parameters import convert
from airhockey.agents.thesis.parameters import ThesisParameters
from airhockey.errors import ConfigurationError
from airhockey.evaluator.runs.disk import JSON, begin_folder, disk_errors, lock_folder, replace_file, write_record
from airhockey.learning.pgpe.records import Iteration, Manifest
from airhockey.learning.pgpe.trainable import as_yaml, replaced

MANIFEST, JOURNAL, PROGRESS, PARAMETERS = "train.json", "journal.jsonl", "progress.csv", "parameters.yaml"
CHECKPOINT_EVERY = 10  # iterations


class TrainingFolder:
    """A run's folder, opened for writing by one process at a time.

    Attributes:
        path: The folder.
        manifest: What the run is.
        iterations: The finished ones.
    """

    def __init__(self, path: Path, manifest: Manifest) -> None:
        """Use `create` or `open`."""
        self.path, self.manifest = path, manifest
        self._lock = lock_folder(path)
        with disk_errors(path):
            self.iterations = read_iterations(path)
            # A line that a kill tore is cut off, and the table for people says what the journal says.
            replace_file(path / JOURNAL, JSON.encode_lines(self.iterations))
            rows = [_row(one) for one in self.iterations]
            replace_file(path / PROGRESS, "".join([_header(manifest), *rows]).encode())

    @classmethod
    def create(cls, path: Path, manifest: Manifest) -> Self:
        """Begin a run in a folder that does not exist or is empty; raises `ConfigurationError`."""
        begin_folder(path, MANIFEST, manifest)
        return cls(path, manifest)

    @classmethod
    def open(cls, path: Path, manifest: Manifest) -> Self:
        """Take up a run; its manifest may ask for more iterations than it did."""
        folder = cls(path, manifest)
        with disk_errors(path):
            write_record(path / MANIFEST, manifest)
        return folder

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self._lock)

    def add(self, iteration: Iteration) -> None:
        """Keep an iteration: the journal's line makes it finished, the rest follows from it."""
        with disk_errors(self.path):
            with (self.path / JOURNAL).open("ab") as journal:
                journal.write(JSON.encode_lines([iteration]))
                journal.flush()
                os.fsync(journal.fileno())
            with (self.path / PROGRESS).open("a", encoding="utf-8") as progress:
                progress.write(_row(iteration))
            self.iterations.append(iteration)
            content = self.parameter_file(iteration).encode()
            replace_file(self.path / PARAMETERS, content)
            if (iteration.iteration + 1) % CHECKPOINT_EVERY == 0:
                (self.path / "checkpoints").mkdir(exist_ok=True)
                replace_file(self.path / "checkpoints" / f"{iteration.iteration + 1:06d}.yaml", content)

    def parameter_file(self, iteration: Iteration) -> str:
        """The player after an iteration, as YAML with where it comes from."""
        settings = self.manifest.settings
        start = convert(ThesisParameters, self.manifest.parameters, MANIFEST)
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


def read_training(path: Path) -> Manifest:
    """The manifest of the run in a folder.

    Raises:
        ConfigurationError: There is no run, or its manifest cannot be read.
    """
    try:
        return msgspec.json.decode((path / MANIFEST).read_bytes(), type=Manifest)
    except OSError:
        raise ConfigurationError(f"there is no training run in {str(path)!r}: it has no {MANIFEST}") from None
    except (msgspec.MsgspecError, ValueError) as error:
        raise ConfigurationError(f"cannot read {str(path / MANIFEST)!r}: {error}") from error


def read_iterations(path: Path) -> list[Iteration]:
    """The finished iterations of a run; a torn last line is left out."""
    journal = path / JOURNAL
    iterations: list[Iteration] = []
    for line in journal.read_bytes().splitlines() if journal.exists() else []:
        with contextlib.suppress(msgspec.MsgspecError):
            iterations.append(msgspec.json.decode(line, type=Iteration))
    return iterations


def _header(manifest: Manifest) -> str:
    names = manifest.settings.names
    columns = ["iteration", "return", "success", "penalty", "multiplier", "learning_rate", "steps", "seconds"]
    return ",".join([*columns, *(f"mean:{name}" for name in names), *(f"sigma:{name}" for name in names)]) + "\n"


def _row(one: Iteration) -> str:
    numbers = [one.mean_return, one.mean_success, one.mean_penalty, one.multiplier, one.learning_rate]
    ends = [*one.mean, *one.sigma]
    cells = [*(f"{x:.6g}" for x in numbers), str(one.steps), f"{one.seconds:.2f}", *(f"{x:.8g}" for x in ends)]
    return ",".join([str(one.iteration), *cells]) + "\n"

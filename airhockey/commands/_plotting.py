"""What `hockey plot` does once its options are read."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import rich_click as click

from airhockey.commands._evaluation import cpus
from airhockey.errors import ConfigurationError
from airhockey.evaluator.engines.engine import engine_for
from airhockey.evaluator.runs.journal import read_journal
from airhockey.learning.pgpe.folder import TrainingFolder
from airhockey.learning.pgpe.plots import draw_sweep, plot_run, save
from airhockey.learning.pgpe.records import Iteration
from airhockey.learning.pgpe.sweep import sweep
from airhockey.learning.pgpe.trainable import resolve
from airhockey.learning.sac.plots import LOG, plot_training


def run(folder: str, given: Mapping[str, Any]) -> None:
    """Draw what was asked for, and name the files."""
    path = Path(folder).expanduser()
    out = Path(given["out"]) if given["out"] is not None else path / "plots"
    if (path / LOG).exists():
        _draw_skill(path, out, given)
        return
    manifest = TrainingFolder.read(path)
    names = [resolve(one, manifest.options.names) for one in given["sweep"]]
    try:
        for picture in plot_run(path, out, given["form"]):
            click.echo(picture)
        mean = read_journal(path, Iteration).records[-1].mean
        for name in names:
            click.echo(f"hockey: playing {given['points']} values of {name}", err=True)
            jobs = engine_for(given["jobs"] or cpus())
            points = sweep(manifest, mean, name, given["points"], given["episodes"], jobs)
            trained = mean[manifest.options.names.index(name)]
            draw = partial(draw_sweep, name=name, start=trained, points=points)
            click.echo(save(draw, out / f"sweep-{name}.{given['form']}"))
    except OSError as error:
        raise ConfigurationError(f"cannot write to {str(out)!r}: {error.strerror}") from error


def _draw_skill(path: Path, out: Path, given: Mapping[str, Any]) -> None:
    """A run of `hockey train sac` has a log and no θ."""
    if given["sweep"]:
        raise ConfigurationError(f"the run in {str(path)!r} trained a network: there is no θ to sweep")
    try:
        click.echo(plot_training(path, out, given["form"]))
    except OSError as error:
        raise ConfigurationError(f"cannot write to {str(out)!r}: {error.strerror}") from error

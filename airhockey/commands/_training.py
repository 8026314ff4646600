"""What `hockey train pgpe` does once its options are read."""

import contextlib
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import rich_click as click

from airhockey.agents.thesis.parameters import thesis_parameters
from airhockey.commands._evaluation import INTERRUPTED, RUNS, cpus, from_anywhere
from airhockey.commands._training_progress import training_progress
from airhockey.envs.disturbances import available
from airhockey.errors import ConfigurationError
from airhockey.evaluator.engines.engine import engine_for
from airhockey.learning.pgpe.folder import PARAMETERS, TrainingFolder
from airhockey.learning.pgpe.records import Settings
from airhockey.learning.pgpe.search import DivergedError
from airhockey.learning.pgpe.trainable import names_of, ranges, read, replaced
from airhockey.learning.pgpe.training import begin, resume, train

DIVERGED = 4
_START = {"init", "overrides", "asked", "fix", "only", "sigma"}
"""Options that say where a run starts, which a resumed one cannot be asked again."""
_OPTION = {"overrides": "set", "asked": "train"}


def run(given: Mapping[str, Any], typed: set[str]) -> int:
    """Do what the options say; returns the exit status."""
    folder = _open_run(given, typed)
    settings, finished = folder.manifest.options, False
    status = 0
    with contextlib.suppress(KeyboardInterrupt):
        try:
            with training_progress(settings, folder.records, given["quiet"]) as (on_episode, on_iteration):
                train(folder, engine_for(given["jobs"] or cpus()), on_episode, on_iteration)
        except DivergedError as error:
            click.echo(f"hockey: the training diverged: {error}", err=True)
            status = DIVERGED
        finished = True
    done = len(folder.records)
    if not finished:
        click.echo(
            f"hockey: interrupted after {done} of {settings.iterations} iterations; continue with:\n"
            f"  hockey train pgpe --resume --out {shlex.quote(str(folder.path))}",
            err=True,
        )
        return INTERRUPTED
    _say(folder, good="last good " if status else "")
    return status


def _say(folder: TrainingFolder, good: str) -> None:
    """What the run ended with."""
    if not folder.records:
        click.echo("no iteration was finished: there are no parameters", err=True)
        return
    last = folder.records[-1]
    settings = folder.manifest.options
    click.echo(
        f"{good}iteration {last.iteration + 1}: return {last.mean_return:.4g}, success {last.mean_success:.1%}, "
        f"penalty {last.mean_penalty:.3g} points per episode"
    )
    width = max(map(len, settings.names))
    for name, before, mean, sigma in zip(settings.names, settings.mean, last.mean, last.sigma, strict=True):
        click.echo(f"  {name:{width}}  {before:10.4g} -> {mean:10.4g}   sigma {sigma:.3g}")
    click.echo(f"{good}parameters: {folder.path / PARAMETERS}")


def _open_run(given: Mapping[str, Any], typed: set[str]) -> TrainingFolder:
    """The run to take up, or a new one."""
    fields = set(Settings.__struct_fields__) & set(given)
    if given["resume"]:
        if typed & _START:
            again = ", ".join(sorted(f"--{_OPTION.get(name, name)}" for name in typed & _START))
            raise ConfigurationError(f"a run that is resumed goes on from where it is: leave out {again}")
        asked = {name: _value(given, name) for name in sorted(fields & typed)}
        return resume(Path(given["out"]), asked)
    parameters = replaced(thesis_parameters(given["init"]), _overrides(given["overrides"]))
    names = names_of(given["task"], given["asked"], given["fix"], given["only"])
    if not given["sigma"] > 0.0:
        raise ConfigurationError(f"the factor on sigma must be positive, not {given['sigma']:g}")
    settings = Settings(
        **{name: _value(given, name) for name in fields - {"sigma"}},
        names=tuple(names),
        mean=tuple(map(float, read(parameters, names))),
        sigma=tuple(given["sigma"] * ranges()[name].sigma for name in names),
    )
    path = Path(given["out"]) if given["out"] is not None else _new_folder(settings)
    return begin(settings, parameters, path)


def _value(given: Mapping[str, Any], name: str) -> Any:
    return from_anywhere(given[name], available()) if name == "disturbances" else given[name]


def _overrides(given: tuple[str, ...]) -> dict[str, float]:
    """NAME=VALUE pairs as numbers."""
    values: dict[str, float] = {}
    for pair in given:
        name, _, value = pair.partition("=")
        try:
            values[name] = float(value)
        except ValueError:
            raise ConfigurationError(f"--set takes NAME=VALUE with a number, not {pair!r}") from None
    return values


def _new_folder(settings: Settings) -> Path:
    """A folder under runs/ that says what is trained and is not there yet."""
    name = f"{settings.optimizer}-{settings.robot}-{settings.task}-s{settings.seed}"
    number = 1
    while (RUNS / (name if number == 1 else f"{name}-{number}")).exists():
        number += 1
    return RUNS / (name if number == 1 else f"{name}-{number}")

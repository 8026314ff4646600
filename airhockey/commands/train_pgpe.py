"""`hockey train pgpe`: the rule-based player's parameters by PGPE or CMA-ES."""

import itertools
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import rich_click as click

from airhockey.commands import HELP_PAGE
from airhockey.commands import _options as common

if TYPE_CHECKING:
    from airhockey.learning.pgpe.folder import TrainingFolder
    from airhockey.learning.pgpe.records import Iteration, Settings

_HEAD = "iteration      return   success   penalty    lambda   sigma/start   seconds"


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.option(
    "--task",
    type=click.Choice(["hit", "defend", "prepare", "home", "switcher"]),
    default="hit",
    show_default=True,
    help="What is trained.",
)
@common.options(common.robot)
@click.option(
    "--init",
    metavar="NAME|FILE",
    default="tuned",
    show_default=True,
    help="Parameters to start from: tuned, thesis, or a YAML file like them.",
)
@click.option("--set", "overrides", metavar="NAME=VALUE", multiple=True, help="Start this parameter elsewhere.")
@click.option(
    "--train",
    "asked",
    metavar="NAME",
    multiple=True,
    help="Train this parameter, or all that begin so (hit.), instead of the task's θ.",
)
@click.option("--fix", metavar="INDEX|NAME", multiple=True, help="Leave this θ as it is.")
@click.option("--only", metavar="INDEX|NAME", help="Train this θ alone, with all others fixed.")
@common.options(common.seed, common.jobs, common.disturbances)
@click.option(
    "--optimizer", type=click.Choice(["pgpe", "cma"]), default="pgpe", show_default=True, help="PGPE, or CMA-ES."
)
@click.option("--iterations", type=click.IntRange(min=1), default=40, show_default=True, help="Updates.")
@click.option("--candidates", type=click.IntRange(min=2), default=12, show_default=True, help="Tried in each, N.")
@click.option("--episodes", type=click.IntRange(min=1), default=5, show_default=True, help="Played with each, M.")
@click.option("--learning-rate", type=float, default=1.0, show_default=True, help="Of μ, α.")
@click.option("--sigma-share", type=float, default=0.5, show_default=True, help="Learning rate of log σ, in α.")
@click.option(
    "--sigma-rule",
    type=click.Choice(["log", "thesis"]),
    default="log",
    show_default=True,
    help="What is updated: log σ, or σ itself as the thesis has it.",
)
@click.option("--sigma", type=float, default=1.0, show_default=True, help="Factor on the σ to start with.")
@click.option(
    "--schedule",
    type=click.Choice(["constant", "linear", "sqrt", "cosine"]),
    default="constant",
    show_default=True,
    help="Of the learning rate.",
)
@click.option("--natural/--plain", default=True, show_default=True, help="Gradient.")
@click.option(
    "--baseline",
    type=click.Choice(["none", "mean", "moving", "optimal"]),
    default="optimal",
    show_default=True,
    help="What returns are compared with; moving is the thesis's.",
)
@click.option("--normalize/--raw", default=True, show_default=True, help="Divide J - b by the deviation of J.")
@click.option("--symmetric", is_flag=True, help="Sample parameters in pairs on either side of μ.")
@click.option("--common-random-numbers", is_flag=True, help="All candidates of an iteration play the same episodes.")
@click.option("--discount", type=float, default=0.997, show_default=True, help="γ of the return.")
@click.option(
    "--reward",
    type=click.Choice(["thesis", "sparse", "success"]),
    default="thesis",
    show_default=True,
    help="The thesis's dense one, its first one for the end alone (5.1), or 1 for a success and 0 for a failure.",
)
@click.option(
    "--fixed-start",
    type=click.Choice(["none", "position", "velocity", "both"]),
    default="none",
    show_default=True,
    help="What of the puck's start is the same in all episodes.",
)
@click.option("--max-penalty", type=float, help="Hold the penalty points per episode below this budget.")
@click.option("--multiplier-rate", type=float, default=0.5, show_default=True, help="Of the budget's multiplier.")
@common.options(*common.RUN)
@click.pass_context
def pgpe(ctx: click.RichContext, /, **given: Any) -> None:
    """Train the parameters of the rule-based player, by PGPE (thesis 2.2.3) or CMA-ES.

    Parameters come from a Gaussian over θ; each set of them plays some episodes, and the Gaussian moves towards those
    that were worth more. The run folder holds a journal, progress.csv, and parameters.yaml, which plays with
    `hockey evaluate --parameters`. Results depend on the options, not on --jobs; a run that was interrupted, or
    killed, goes on with --resume.

    For example:

    \b
    hockey train pgpe --task hit --robot 3dof --init thesis
    hockey train pgpe --task hit --only 2 --reward success
    hockey train pgpe --task hit --disturbances server --max-penalty 0.1
    hockey train pgpe --task switcher --optimizer cma
    hockey train pgpe --resume --out runs/pgpe-7dof-hit-s0 --iterations 80
    """
    typed = common.typed_options(ctx, given)
    if given["only"] is not None and given["fix"]:
        raise click.UsageError("--only fixes all other parameters already: leave out --fix")
    from airhockey.commands import _progress
    from airhockey.commands._session import INTERRUPTED, NOBODYS_FAULT, Session, cpus
    from airhockey.evaluator.engines.engine import engine_for
    from airhockey.learning.pgpe.training import resume, train

    session, (settings, begin) = Session("train pgpe", given, typed - _start(given, typed)), _settings(given)
    name = f"{settings.optimizer}-{settings.robot}-{settings.task}-s{settings.seed}"
    folder = session.open(settings, name, begin, resume)
    settings, done = folder.manifest.options, len(folder.records)
    each = settings.candidates * settings.episodes

    warned: set[str] = set()

    def tell_of(tell: _progress.Tell, one: "Iteration") -> None:
        tell(_line(settings, one))
        for warning in _bound_warnings(settings, one, warned):
            tell(warning)

    def play(tell: _progress.Tell) -> None:
        for one in folder.records:
            tell_of(tell, one)
        played = itertools.count(done * each + 1)
        engine = engine_for(given["jobs"] or cpus())
        train(folder, engine, lambda _: tell(completed=next(played)), lambda one: tell_of(tell, one))

    head = f"θ: {', '.join(settings.names)}\n{_HEAD}"
    progress = _progress.of_training(head, "episodes", settings.iterations * each, done * each, given["quiet"])
    status = session.run(folder, f"{settings.iterations} iterations", progress, play, lambda _: 0)
    if status != INTERRUPTED:
        _print_parameters(folder, good="last good " if status == NOBODYS_FAULT else "")
    ctx.exit(status)


def _start(given: dict[str, Any], typed: set[str]) -> set[str]:
    """Options that say where a run starts, which a resumed one cannot be asked again."""
    from airhockey.errors import ConfigurationError

    options = {"init": "init", "overrides": "set", "asked": "train", "fix": "fix", "only": "only", "sigma": "sigma"}
    if given["resume"] and typed & options.keys():
        again = ", ".join(sorted(f"--{options[name]}" for name in typed & options.keys()))
        raise ConfigurationError(f"a run that is resumed goes on from where it is: leave out {again}")
    return set(options)


def _settings(given: dict[str, Any]) -> "tuple[Settings, Callable[[Settings, Path], TrainingFolder]]":
    """What is asked for, and how to begin it; where a run starts counts only for a new one."""
    from airhockey.agents.thesis.parameters import thesis_parameters
    from airhockey.commands._session import disturbances_of
    from airhockey.errors import ConfigurationError
    from airhockey.learning.pgpe.records import Settings
    from airhockey.learning.pgpe.trainable import names_of, ranges, read, replaced
    from airhockey.learning.pgpe.training import begin

    fields = (set(Settings.__struct_fields__) & set(given)) - {"sigma"}
    values = {name: given[name] for name in fields} | {"disturbances": disturbances_of(given)}
    parameters = replaced(thesis_parameters(given["init"]), _overrides(given["overrides"]))
    if not given["resume"]:
        names = names_of(given["task"], given["asked"], given["fix"], given["only"])
        if not given["sigma"] > 0.0:
            raise ConfigurationError(f"the factor on sigma must be positive, not {given['sigma']:g}")
        values["names"], values["mean"] = tuple(names), tuple(map(float, read(parameters, names)))
        values["sigma"] = tuple(given["sigma"] * ranges()[name].sigma for name in names)
    return Settings(**values), lambda settings, path: begin(settings, parameters, path)


def _overrides(given: tuple[str, ...]) -> dict[str, float]:
    """NAME=VALUE pairs as numbers."""
    from airhockey.errors import ConfigurationError

    values: dict[str, float] = {}
    for pair in given:
        name, _, value = pair.partition("=")
        try:
            values[name] = float(value)
        except ValueError:
            raise ConfigurationError(f"--set takes NAME=VALUE with a number, not {pair!r}") from None
    return values


def _line(settings: "Settings", one: "Iteration") -> str:
    """One iteration: σ as the range of its shares of the start."""
    shares = [now / start for now, start in zip(one.sigma, settings.sigma, strict=True)]
    return (
        f"{one.iteration + 1:>4}/{settings.iterations:<4} {one.mean_return:>10.4g} {one.mean_success:>9.1%} "
        f"{one.mean_penalty:>9.3g} {one.multiplier:>9.3g}   {min(shares):.2f} – {max(shares):.2f} {one.seconds:>9.1f}"
    )


def _bound_warnings(settings: "Settings", one: "Iteration", warned: set[str]) -> list[str]:
    """A line for each parameter that has come to sit on a bound, once; it is then among the warned."""
    import numpy as np

    from airhockey.learning.pgpe.trainable import bounds, on_bounds

    new = [name for name in on_bounds(settings.names, np.array(one.mean)) if name not in warned]
    warned.update(new)
    lines = []
    for name in new:
        (low,), (high,) = bounds([name])
        lines.append(f"warning: μ of {name} sits on a bound ({low:g} … {high:g}): the best value may lie beyond")
    return lines


def _print_parameters(folder: "TrainingFolder", good: str) -> None:
    """What the run ended with."""
    import numpy as np

    from airhockey.learning.pgpe.folder import PARAMETERS
    from airhockey.learning.pgpe.trainable import on_bounds

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
    stopped = on_bounds(settings.names, np.array(last.mean))
    for name, before, mean, sigma in zip(settings.names, settings.mean, last.mean, last.sigma, strict=True):
        limit = "   on its bound" if name in stopped else ""
        click.echo(f"  {name:{width}}  {before:10.4g} -> {mean:10.4g}   sigma {sigma:.3g}{limit}")
    click.echo(f"{good}parameters: {folder.path / PARAMETERS}")

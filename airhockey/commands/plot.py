"""`hockey plot`: pictures of a training run."""

from functools import partial
from pathlib import Path
from typing import Any

import rich_click as click

from airhockey.commands import HELP_PAGE
from airhockey.commands import _options as common


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.argument("run")
@click.option("--out", metavar="FOLDER", help="Where the pictures go.  [default: plots/ in the run's folder]")
@click.option(
    "--format", "form", type=click.Choice(["png", "svg"]), default="png", show_default=True, help="Of the pictures."
)
@click.option("--sweep", metavar="INDEX|NAME", multiple=True, help="Also play through the range of this θ.")
@click.option("--points", type=click.IntRange(min=2), default=9, show_default=True, help="Values in a sweep.")
@click.option("--episodes", type=click.IntRange(min=1), default=20, show_default=True, help="Played with each value.")
@common.options(common.jobs)
@click.pass_context
def plot(ctx: click.RichContext, /, run: str, **given: Any) -> None:
    """Draw a training run: learning curve, μ and σ of every θ, histogram of the updates; of `train sac` its log.

    A sweep plays new episodes with one θ at values over its range and the others as they were trained.

    For example:

    \b
    hockey plot runs/pgpe-3dof-hit-s0
    hockey plot runs/pgpe-3dof-hit-s0 --format svg --out figures
    hockey plot runs/pgpe-3dof-hit-s0 --sweep hit.theta.2 --points 11
    hockey plot runs/sac-7dof-defend-s0
    """
    common.typed_options(ctx, given)
    from airhockey.errors import ConfigurationError
    from airhockey.learning.sac.plots import LOG

    path = Path(run).expanduser()
    out = Path(given["out"]) if given["out"] is not None else path / "plots"
    draw = _draw_skill if (path / LOG).exists() else _draw_parameters
    try:
        draw(path, out, given)
    except OSError as error:
        raise ConfigurationError(f"cannot write to {str(out)!r}: {error.strerror}") from error


def _draw_parameters(path: Path, out: Path, given: dict[str, Any]) -> None:
    """A run of `hockey train pgpe`, and sweeps of its θ."""
    from airhockey.commands._session import cpus
    from airhockey.evaluator.engines.engine import engine_for
    from airhockey.evaluator.runs.journal import read_journal
    from airhockey.learning.pgpe.folder import TrainingFolder
    from airhockey.learning.pgpe.plots import draw_sweep, plot_run, save
    from airhockey.learning.pgpe.records import Iteration
    from airhockey.learning.pgpe.sweep import sweep
    from airhockey.learning.pgpe.trainable import resolve

    manifest = TrainingFolder.read(path)
    names = [resolve(one, manifest.options.names) for one in given["sweep"]]
    for picture in plot_run(path, out, given["form"]):
        click.echo(picture)
    mean = read_journal(path, Iteration).records[-1].mean
    for name in names:
        click.echo(f"hockey: playing {given['points']} values of {name}", err=True)
        engine = engine_for(given["jobs"] or cpus())
        points = sweep(manifest, mean, name, given["points"], given["episodes"], engine)
        trained = mean[manifest.options.names.index(name)]
        draw = partial(draw_sweep, name=name, start=trained, points=points)
        click.echo(save(draw, out / f"sweep-{name}.{given['form']}"))


def _draw_skill(path: Path, out: Path, given: dict[str, Any]) -> None:
    """A run of `hockey train sac` has a log and no θ."""
    from airhockey.errors import ConfigurationError
    from airhockey.learning.sac.plots import plot_training

    if given["sweep"]:
        raise ConfigurationError(f"the run in {str(path)!r} trained a network: there is no θ to sweep")
    click.echo(plot_training(path, out, given["form"]))

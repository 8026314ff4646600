"""`hockey plot`: pictures of a training run."""

from typing import Any

import rich_click as click

from airhockey.commands import HELP_PAGE
from airhockey.commands._options import typed_options


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
@click.option("--jobs", type=click.IntRange(min=1), help="Processes that play.  [default: one per CPU]")
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
    typed_options(ctx, given)
    from airhockey.commands._plotting import run as draw

    draw(run, given)

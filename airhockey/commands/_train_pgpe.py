"""`hockey train pgpe`: the rule-based player's parameters by PGPE or CMA-ES."""

from typing import Any

import rich_click as click

from airhockey.commands import HELP_PAGE
from airhockey.commands._options import typed_options


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.option(
    "--task",
    type=click.Choice(["hit", "defend", "prepare", "home", "switcher"]),
    default="hit",
    show_default=True,
    help="What is trained.",
)
@click.option("--robot", type=click.Choice(["7dof", "3dof"]), default="7dof", show_default=True, help="Who plays it.")
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
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of everything.")
@click.option("--jobs", type=click.IntRange(min=1), help="Processes that play.  [default: one per CPU]")
@click.option(
    "--disturbances",
    metavar="NAME|PATH",
    default="ideal",
    show_default=True,
    help="Profile ideal, server or harsh, or a YAML file.",
)
@click.option(
    "--optimizer", type=click.Choice(["pgpe", "cma"]), default="pgpe", show_default=True, help="PGPE, or CMA-ES."
)
@click.option("--iterations", type=click.IntRange(min=1), default=40, show_default=True, help="Updates.")
@click.option("--candidates", type=click.IntRange(min=2), default=12, show_default=True, help="Tried in each, N.")
@click.option("--episodes", type=click.IntRange(min=1), default=5, show_default=True, help="Played with each, M.")
@click.option("--learning-rate", type=float, default=1.0, show_default=True, help="Of μ, α.")
@click.option("--sigma-share", type=float, default=0.5, show_default=True, help="Learning rate of log σ, in α.")
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
    type=click.Choice(["thesis", "success"]),
    default="thesis",
    show_default=True,
    help="The thesis's, or 1 for a success and 0 for a failure.",
)
@click.option("--max-penalty", type=float, help="Hold the penalty points per episode below this budget.")
@click.option("--multiplier-rate", type=float, default=0.5, show_default=True, help="Of the budget's multiplier.")
@click.option("--out", metavar="FOLDER", help="Run folder.  [default: a new one under runs/]")
@click.option("--resume", is_flag=True, help="Continue the run in --out; its options need not be repeated.")
@click.option("--quiet", is_flag=True, help="No progress, only the result.")
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
    typed = typed_options(ctx, given)
    if given["resume"] and given["out"] is None:
        raise click.UsageError("--resume needs the run's folder: --out FOLDER")
    if given["only"] is not None and given["fix"]:
        raise click.UsageError("--only fixes all other parameters already: leave out --fix")
    from airhockey.commands._training import run

    ctx.exit(run(given, typed))

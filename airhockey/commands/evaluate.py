"""`hockey evaluate`: an agent on the challenge's tasks, judged by the challenge's rules."""

from typing import Any

import rich_click as click

from airhockey.commands import HELP_PAGE
from airhockey.commands._isolation import isolation_options
from airhockey.commands._options import cluster_option, typed_options


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.option(
    "--task",
    type=click.Choice(["hit", "defend", "prepare", "all"]),
    default="all",
    show_default=True,
    help="What to play.",
)
@click.option("--robot", type=click.Choice(["7dof", "3dof"]), default="7dof", show_default=True, help="Who plays it.")
@click.option("--env", metavar="NAME", help="Task and robot in one name, as in 7dof-prepare.")
@click.option(
    "--agent",
    metavar="NAME|PATH|tcp://…",
    help="One of `hockey agents`, the folder or archive of a submission, or tcp://HOST:PORT.  "
    "[default: planner; thesis where --parameters are given]",
)
@click.option(
    "--parameters",
    metavar="NAME|FILE",
    help="Parameters of the rule-based player: tuned, thesis, or a YAML file, as `hockey train pgpe` leaves it.",
)
@click.option("--episodes", type=click.IntRange(min=1), default=1000, show_default=True, help="Episodes of each task.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the whole run.")
@click.option("--jobs", type=click.IntRange(min=1), help="Processes that play.  [default: one per CPU]")
@cluster_option
@click.option(
    "--disturbances",
    metavar="NAME|PATH",
    default="ideal",
    show_default=True,
    help="Profile ideal, server or harsh, or a YAML file.",
)
@click.option(
    "--interpolation-order",
    type=click.Choice(["1", "2", "3", "4", "5", "-1", "none"]),
    help="How actions become set-points.  [default: what the agent wants]",
)
@isolation_options
@click.option("--out", metavar="FOLDER", help="Run folder.  [default: a new one under runs/]")
@click.option("--resume", is_flag=True, help="Continue the run in --out; its options need not be repeated.")
@click.option(
    "--clock",
    type=click.Choice(["wall", "cpu"]),
    default="wall",
    show_default=True,
    help="What the agent's computation time is measured with; cpu does not mind a busy machine.",
)
@click.option("--official-dataset", is_flag=True, help="Also write the files of an official evaluation.")
@click.option("--json", "as_json", is_flag=True, help="Print the result as one JSON object, and nothing else.")
@click.option("--quiet", is_flag=True, help="No progress, only the result.")
@click.pass_context
def evaluate(ctx: click.RichContext, /, **given: Any) -> None:
    """Evaluate an agent: success, violations, penalty and computation time over many episodes.

    Results depend on the options, not on --jobs: each episode has seeds of its own. A run that was interrupted, or
    killed, goes on with --resume. Exit status 3: the agent failed episodes; their reasons are in the run's journal.

    For example:

    \b
    hockey evaluate --task prepare
    hockey evaluate --task all --disturbances server --clock cpu
    hockey evaluate --env 3dof-hit --agent submissions/my_agent --episodes 100 --jobs 1
    hockey evaluate --resume --out runs/7dof-prepare-planner-s0
    """
    typed = typed_options(ctx, given)
    if given["env"] is not None and typed & {"task", "robot"}:
        raise click.UsageError("--env names task and robot already: leave out --task and --robot")
    if given["resume"] and given["out"] is None:
        raise click.UsageError("--resume needs the run's folder: --out FOLDER")
    from airhockey.commands._evaluation import run

    ctx.exit(run(given, typed))

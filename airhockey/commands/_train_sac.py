"""`hockey train sac`: a skill by Soft Actor Critic, under constraints by ATACOM."""

from typing import Any

import rich_click as click

from airhockey.commands import HELP_PAGE
from airhockey.commands._options import typed_options


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.option(
    "--task", type=click.Choice(["defend", "home"]), default="defend", show_default=True, help="What is trained."
)
@click.option("--robot", type=click.Choice(["7dof", "3dof"]), default="7dof", show_default=True, help="Who plays it.")
@click.option(
    "--algorithm",
    type=click.Choice(["sac", "oac"]),
    default="sac",
    show_default=True,
    help="Soft, or optimistic actor critic.",
)
@click.option("--steps", type=click.IntRange(min=1), default=200_000, show_default=True, help="Actions in all.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of everything.")
@click.option(
    "--disturbances",
    metavar="NAME|PATH",
    default="ideal",
    show_default=True,
    help="Profile ideal, server or harsh, or a YAML file.",
)
@click.option("--optimism", type=click.FloatRange(min=0.0), default=0.5, show_default=True, help="δ of oac; 0 is sac.")
@click.option("--hidden", type=click.IntRange(min=1), default=128, show_default=True, help="Units of a hidden layer.")
@click.option("--batch", type=click.IntRange(min=1), default=256, show_default=True, help="Transitions of an update.")
@click.option(
    "--updates", type=click.FloatRange(min=0.0, min_open=True), default=0.5, show_default=True, help="Per action."
)
@click.option(
    "--learning-rate",
    type=click.FloatRange(min=0.0, min_open=True),
    default=1e-3,
    show_default=True,
    help="To begin with; it falls to a tenth.",
)
@click.option("--warm-up", type=click.IntRange(min=1), default=2000, show_default=True, help="Random actions first.")
@click.option(
    "--episodes", type=click.IntRange(min=1), default=100, show_default=True, help="Played in the end, unseen ones."
)
@click.option("--out", metavar="FOLDER", help="Run folder.  [default: a new one under runs/]")
@click.option("--resume", is_flag=True, help="Continue the run in --out; its options need not be repeated.")
@click.option("--quiet", is_flag=True, help="No progress, only the result.")
@click.pass_context
def sac(ctx: click.RichContext, /, **given: Any) -> None:
    """Train a skill by SAC (thesis 2.2.4) on the tangent space of the constraints (ATACOM, thesis chapter 6).

    An action is the mallet's velocity, and whatever it is, the command stays within the constraints, from the first random
    action on. The run folder holds log.csv, network.npz, which plays without torch, and card.yaml. Results depend on the
    options; a run that was interrupted, or killed, goes on with --resume as if nothing had happened.

    For example:

    \b
    hockey train sac --task defend
    hockey train sac --task home --steps 40000
    hockey train sac --task defend --robot 3dof --algorithm oac --disturbances server
    hockey train sac --resume --out runs/sac-7dof-defend-s0
    """
    typed = typed_options(ctx, given)
    if given["resume"] and given["out"] is None:
        raise click.UsageError("--resume needs the run's folder: --out FOLDER")
    if given["algorithm"] == "sac" and "optimism" in typed and not given["resume"]:
        raise click.UsageError("--optimism is for --algorithm oac")
    from airhockey.commands._skill_training import run

    ctx.exit(run(given, typed))

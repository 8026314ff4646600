"""`hockey train sac`: a skill by Soft Actor Critic, under constraints by ATACOM."""

from typing import TYPE_CHECKING, Any

import rich_click as click

from airhockey.commands import HELP_PAGE
from airhockey.commands import _options as common
from airhockey.commands import _training as training

if TYPE_CHECKING:
    from airhockey.learning.sac.folder import SkillFolder
    from airhockey.learning.sac.records import Line

_HEAD = f"episode {training.HEAD}   entropy  actions/s"


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.option(
    "--task", type=click.Choice(["defend", "home"]), default="defend", show_default=True, help="What is trained."
)
@common.options(common.robot)
@click.option(
    "--algorithm",
    type=click.Choice(["sac", "oac"]),
    default="sac",
    show_default=True,
    help="Soft, or optimistic actor critic.",
)
@training.steps(200_000)
@common.options(common.seed, common.disturbances)
@click.option("--optimism", type=click.FloatRange(min=0.0), default=0.5, show_default=True, help="δ of oac; 0 is sac.")
@training.hidden
@click.option("--batch", type=click.IntRange(min=1), default=256, show_default=True, help="Transitions of an update.")
@click.option(
    "--updates", type=click.FloatRange(min=0.0, min_open=True), default=0.5, show_default=True, help="Per action."
)
@training.learning_rate(1e-3)
@click.option("--warm-up", type=click.IntRange(min=1), default=2000, show_default=True, help="Random actions first.")
@training.episodes
@common.options(*common.RUN)
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
    typed = common.typed_options(ctx, given)
    if given["algorithm"] == "sac" and "optimism" in typed and not given["resume"]:
        raise click.UsageError("--optimism is for --algorithm oac")
    from airhockey.commands import _progress
    from airhockey.commands._session import Session
    from airhockey.learning.sac.folder import SkillFolder
    from airhockey.learning.sac.records import Settings

    with training.learning_packages():
        from airhockey.learning.sac.evaluation import evaluate_skill
        from airhockey.learning.sac.trainer import Trainer
    session = Session("train sac", given, typed)
    settings = training.settings_of(Settings, given)
    name = f"{settings.algorithm}-{settings.robot}-{settings.task}-s{settings.seed}"
    folder = session.open(settings, name, SkillFolder.begin, SkillFolder.resume)

    def play(tell: _progress.Tell) -> dict[str, float]:
        with folder:
            trainer = Trainer(folder)
            tell(completed=trainer.progress.steps)
            trainer.run(lambda line: tell(_line(line), line.steps))
            figures = evaluate_skill(trainer.settings, folder.manifest.profile, trainer.network, given["episodes"])
            folder.write_card({"actions": trainer.progress.steps, "control_steps": trainer.env.steps, **figures})
        return figures

    steps = folder.manifest.options.steps
    progress = _progress.of_training(_HEAD, "actions", steps, 0, given["quiet"])
    ctx.exit(session.run(folder, "", progress, play, lambda figures: _print_figures(figures, folder)))


def _line(line: "Line") -> str:
    """A line of the log."""
    return f"{line.episode:>7} {training.columns(line)} {line.entropy:>9.3g} {line.steps_per_second:>10.0f}"


def _print_figures(figures: dict[str, float], folder: "SkillFolder") -> int:
    from airhockey.learning.sac.folder import CARD, NETWORK

    training.say_figures(figures)
    click.echo(f"network: {folder.path / NETWORK}, its card: {folder.path / CARD}")
    return 0

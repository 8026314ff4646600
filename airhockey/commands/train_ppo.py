"""`hockey train ppo`: a whole task by Proximal Policy Optimisation, under constraints by ATACOM."""

from typing import TYPE_CHECKING, Any

import rich_click as click

from airhockey.commands import HELP_PAGE
from airhockey.commands import _options as common
from airhockey.commands import _training as training

if TYPE_CHECKING:
    from airhockey.learning.ppo.folder import PolicyFolder
    from airhockey.learning.ppo.records import Line

_HEAD = f"iteration {training.HEAD}  actions/s"
_TASKS = ("3dof-hit", "3dof-defend", "7dof-hit", "7dof-defend", "7dof-prepare")
_WHOLE = click.IntRange(min=1)


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.option("--task", type=click.Choice(_TASKS), default="7dof-defend", show_default=True, help="What is trained.")
@click.option(
    "--actions",
    type=click.Choice(["joints", "tip", "mallet"]),
    default="tip",
    show_default=True,
    help="Velocities of the joints or of the mallet, or where the mallet shall go.",
)
@click.option(
    "--reward",
    type=click.Choice(["shaped", "progress", "success"]),
    default="shaped",
    show_default=True,
    help="On the way (differences of a potential, or what it rises), or only for a success.",
)
@training.steps(1_000_000)
@common.options(common.seed, common.disturbances)
@click.option("--envs", type=_WHOLE, default=32, show_default=True, help="Environments played at the same time.")
@click.option("--rollout", type=_WHOLE, default=128, show_default=True, help="Actions in each between updates.")
@click.option("--epochs", type=_WHOLE, default=6, show_default=True, help="Passes over a rollout.")
@click.option("--batch", type=click.IntRange(min=2), default=512, show_default=True, help="Actions of an update.")
@training.hidden
@training.learning_rate(5e-4)
@click.option("--threads", type=_WHOLE, help="That play; no result depends on it.  [default: the CPUs]")
@training.episodes
@common.options(*common.RUN)
@click.pass_context
def ppo(ctx: click.RichContext, /, **given: Any) -> None:
    """Train a network for a task by PPO, many environments at once, on the tangent space of the constraints (ATACOM).

    Commands are built to stay within the constraints, from the first random action on. The run's folder is
    itself an agent, from the first checkpoint on and without torch: name it wherever an agent is asked for. Results depend
    on the options; a run that was interrupted, or killed, goes on with --resume as if nothing had happened.

    For example:

    \b
    hockey train ppo --task 7dof-defend
    hockey train ppo --task 7dof-hit --actions mallet --disturbances server
    hockey train ppo --resume --out runs/ppo-7dof-defend-tip-s0
    hockey evaluate --agent runs/ppo-7dof-defend-tip-s0 --env 7dof-defend
    """
    typed = common.typed_options(ctx, given)
    from airhockey.commands import _progress
    from airhockey.commands._session import Session, cpus

    with training.learning_packages():
        from airhockey.learning.ppo.trainer import Trainer, evaluate_policy
    from airhockey.learning.ppo.folder import PolicyFolder
    from airhockey.learning.ppo.records import Settings

    session = Session("train ppo", given, typed)
    settings = training.settings_of(Settings, given)
    name = f"ppo-{settings.task}-{settings.actions}-s{settings.seed}"
    folder = session.open(settings, name, PolicyFolder.begin, PolicyFolder.resume)

    def play(tell: _progress.Tell) -> dict[str, float]:
        with folder:
            trainer = Trainer(folder, given["threads"] or cpus())
            tell(completed=trainer.model.num_timesteps)
            trainer.run(lambda line: tell(_line(line), line.steps))
            figures = evaluate_policy(trainer.settings, folder.manifest.profile, trainer.network, given["episodes"])
            folder.write_card({"actions": trainer.model.num_timesteps, **figures})
        return figures

    progress = _progress.of_training(_HEAD, "actions", folder.manifest.options.steps, 0, given["quiet"])
    ctx.exit(session.run(folder, "", progress, play, lambda figures: _print_figures(figures, folder)))


def _line(line: "Line") -> str:
    """A line of the log."""
    return f"{line.iteration:>9} {training.columns(line)} {line.steps_per_second:>10.0f}"


def _print_figures(figures: dict[str, float], folder: "PolicyFolder") -> int:
    training.say_figures(figures)
    click.echo(
        f"the run's folder is an agent: hockey evaluate --agent {folder.path} --env {folder.manifest.options.task}"
    )
    return 0

"""`hockey evaluate`: an agent on the challenge's tasks, judged by the challenge's rules."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import rich_click as click

from airhockey.commands import HELP_PAGE
from airhockey.commands import _options as common

if TYPE_CHECKING:
    from airhockey.evaluator import Options


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.option(
    "--task",
    type=click.Choice(["hit", "defend", "prepare", "all"]),
    default="all",
    show_default=True,
    help="What to play.",
)
@common.options(common.robot, common.env, common.edition)
@click.option(
    "--agent",
    multiple=True,
    metavar="NAME|PATH|tcp://…",
    help="One of `hockey agents`, the folder or archive of a submission, or tcp://HOST:PORT; several are compared.  "
    "[default: planner; thesis where --parameters are given]",
)
@click.option(
    "--parameters",
    metavar="NAME|FILE",
    help="Parameters of the rule-based player: tuned, thesis, or a YAML file, as `hockey train pgpe` leaves it.",
)
@common.options(common.settings)
@click.option("--episodes", type=click.IntRange(min=1), default=1000, show_default=True, help="Episodes of each task.")
@common.options(common.seed)
@click.option(
    "--seeds",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="Play with so many: --seed and the next ones.",
)
@common.options(common.agent_seed, common.jobs, common.cluster)
@click.option(
    "--disturbances",
    multiple=True,
    metavar="NAME|PATH",
    default=("ideal",),
    show_default="ideal",
    help="Profile ideal, server or harsh, or a YAML file; several are played one after the other.",
)
@click.option(
    "--interpolation-order",
    type=click.Choice(["1", "2", "3", "4", "5", "-1", "none"]),
    help="How actions become set-points.  [default: what the agent wants]",
)
@common.options(*common.PLAY, common.python, common.clock)
@click.option("--official-dataset", is_flag=True, help="Also write the files of an official evaluation.")
@common.options(common.trajectories, *common.RUN, common.as_json)
@click.pass_context
def evaluate(ctx: click.RichContext, /, **given: Any) -> None:
    """Evaluate an agent: success, violations, penalty and computation time over many episodes.

    Results depend on the options, not on --jobs: each episode has seeds of its own. A run that was interrupted, or
    killed, goes on with --resume. Exit status 3: the agent failed episodes; their reasons are in the run's journal.

    For example:

    \b
    hockey evaluate --task prepare
    hockey evaluate --task all --disturbances server
    hockey evaluate --edition 2025 --episodes 100
    hockey evaluate --env 3dof-hit --agent submissions/my_agent --episodes 100 --jobs 1
    hockey evaluate --resume --out runs/7dof-prepare-planner-s0
    hockey evaluate --task hit --agent planner --agent thesis --disturbances ideal --disturbances server --seeds 5

    Several agents, disturbances or seeds are a sweep: one run, whose parts are runs themselves, with one table of success, its
    intervals, and tests of agents in pairs over the same episodes (exact McNemar, adjusted by Holm).
    """
    typed = common.typed_options(ctx, given)
    if given["env"] is not None and typed & {"task", "robot"}:
        raise click.UsageError("--env names task and robot already: leave out --task and --robot")
    if given["official_dataset"] and given["trajectories"] == "none":
        raise click.UsageError("--official-dataset is made of trajectories: --trajectories full or actions")
    from airhockey.commands import _progress, _sweep, _tables

    if _sweep.asked_for(given):
        ctx.exit(_sweep.run(given, typed, _options))
    given = _sweep.alone(given)
    from airhockey.commands._session import AGENT_FAILED, Session
    from airhockey.evaluator import evaluation
    from airhockey.evaluator.official import write_official

    typed = {"environments" if name in ("task", "robot", "env") else name for name in typed}
    session, options = Session("evaluate", given, typed), _options(given)
    engine = session.engine()
    folder = session.open(options, _name(options, given), evaluation.begin, evaluation.resume, (options.agent,))
    options = folder.manifest.options

    def play(on_episode: evaluation.OnEpisode | None) -> evaluation.Result:
        result = evaluation.evaluate(folder, engine, on_episode)
        if given["official_dataset"]:
            write_official(folder.path, result)
        return result

    def show(result: evaluation.Result) -> int:
        session.print(folder, result, lambda: _tables.print_result(result, folder))
        return AGENT_FAILED if any(task.agent_errors for task in result.tasks) else 0

    progress = _progress.of_episodes(options, folder.records, session.quiet)
    ctx.exit(session.run(folder, f"{len(evaluation.jobs(options))} episodes", progress, play, show))


def _options(given: dict[str, Any]) -> "Options":
    from msgspec import UNSET

    from airhockey.commands._session import (
        agent_of,
        agent_seed_of,
        disturbances_of,
        edition_of,
        from_anywhere,
        python_of,
        real_time_of,
    )
    from airhockey.evaluator import Options
    from airhockey.evaluator.isolation.modes import choose

    keep = given["trajectories"]
    default = "planner" if given["parameters"] is None else "thesis"  # the one that reads them
    agent, order = agent_of(given["agent"] or default), given["interpolation_order"]
    python = python_of(given["python"])
    edition = edition_of(given, (agent,), () if given["env"] is None else (given["env"],))
    environments = _environments(given, edition)
    return Options(
        environments=environments,
        agent=agent,
        episodes=given["episodes"],
        seed=given["seed"],
        edition=edition,
        disturbances=disturbances_of(given),
        interpolation_order="agent" if order is None else "none" if order == "none" else int(order),
        clock=given["clock"],
        isolate=choose(agent, given["isolate"]).mode,
        patience=given["patience"],
        real_time=real_time_of(given, {agent: python}, environments[0], edition),
        python=python,
        settings=given["settings"],
        keep=UNSET if keep == "full" else keep,
        agent_seed=agent_seed_of(given["agent_seed"], (agent,)),
        parameters=None if given["parameters"] is None else from_anywhere(given["parameters"]),
    )


def _environments(given: dict[str, Any], year: str) -> tuple[str, ...]:
    """The environments of a task and a robot, or the one named."""
    from airhockey.envs.editions import edition
    from airhockey.errors import ConfigurationError

    rules = edition(year)
    if given["env"] is not None:
        return (rules.counterpart(given["env"]),)
    robot, task = given["robot"], given["task"]
    tasks = rules.tasks_of(robot)
    if task == "all":
        return tasks
    name = rules.names.get(f"{robot}-{task}")
    if name is None:
        raise ConfigurationError(f"there is no task {task!r} for the {robot} robot; its tasks are {', '.join(tasks)}")
    return (name,)


def _name(options: "Options", given: dict[str, Any]) -> str:
    """Says what is evaluated."""
    what = options.environments[0] if len(options.environments) == 1 else f"{given['robot']}-all"
    from airhockey.envs.editions import DEFAULT

    year = [] if options.edition == DEFAULT else [options.edition]
    profile = [] if options.disturbances == "ideal" else [Path(options.disturbances).stem]
    return "-".join([what, Path(options.agent).name, *year, *profile, f"s{options.seed}"])

"""What `hockey evaluate` does once its options are read: open the run, play with a progress bar, show the result."""

import contextlib
import os
import shlex
import sys
from collections.abc import Container, Iterator, Mapping
from pathlib import Path
from typing import Any

import click
import msgspec

from airhockey.agents import AGENTS
from airhockey.commands._isolation import isolation_of, say_what_is_not_protected
from airhockey.commands._progress import progress
from airhockey.commands._tables import print_result
from airhockey.envs.disturbances import available
from airhockey.envs.editions import edition
from airhockey.errors import ConfigurationError
from airhockey.evaluator import Options, RunResult, TaskResult, begin, evaluate, resume
from airhockey.evaluator.engines.cluster import engine_of
from airhockey.evaluator.official import write_official
from airhockey.evaluator.runs.episode_folder import EpisodeFolder
from airhockey.evaluator.runs.records import Order

AGENT_FAILED = 3
INTERRUPTED = 130
RUNS = Path("runs")


def run(given: Mapping[str, Any], typed: set[str]) -> int:
    """Do what the options say.

    Args:
        given: Every option's value by its name.
        typed: Names of those that the user typed.

    Returns:
        The exit status.
    """
    engine = engine_of(given["cluster"], given["jobs"] or cpus())
    folder = _open_run(given, typed)
    options = folder.manifest.options
    if not given["resume"]:
        say_what_is_not_protected((options.agent,), given["isolate"])
    played: TaskResult | RunResult | None = None
    with contextlib.suppress(KeyboardInterrupt), stdout_for_the_result():
        with progress(options, folder.records, quiet=given["quiet"] or given["as_json"]) as on_episode:
            played = evaluate(folder, engine, on_episode)
        if given["official_dataset"]:
            write_official(folder.path, played)
    if played is None:
        _say_how_to_resume(folder)
        return INTERRUPTED
    if given["as_json"]:
        click.echo(msgspec.json.encode(played))
        if not given["quiet"]:
            click.echo(f"hockey: stored in {folder.path}", err=True)
    else:
        print_result(played, folder)
    return AGENT_FAILED if any(task.agent_errors for task in played.tasks) else 0


def _open_run(given: Mapping[str, Any], typed: set[str]) -> EpisodeFolder:
    """The run to take up, or a new one."""
    options = _options(given)
    if given["resume"]:
        fields = {"environments" if name in ("task", "robot", "env") else name for name in typed}
        asked = {name: getattr(options, name) for name in sorted(fields) if name in Options.__struct_fields__}
        return resume(Path(given["out"]), asked)
    if given["out"] is not None:
        return begin(options, Path(given["out"]))
    return begin(options, _new_folder(given, options))


def _options(given: Mapping[str, Any]) -> Options:
    agent = from_anywhere(given["agent"], AGENTS)
    return Options(
        environments=_environments(given),
        agent=agent,
        episodes=given["episodes"],
        seed=given["seed"],
        disturbances=from_anywhere(given["disturbances"], available()),
        interpolation_order=_order(given["interpolation_order"]),
        clock=given["clock"],
        isolate=isolation_of(agent, given["isolate"]),
        patience=given["patience"],
        parameters=None if given["parameters"] is None else from_anywhere(given["parameters"], ()),
    )


def _environments(given: Mapping[str, Any]) -> tuple[str, ...]:
    """The environments of a task and a robot, or the one named."""
    if given["env"] is not None:
        return (given["env"],)
    robot, task = given["robot"], given["task"]
    tasks = tuple(edition().score_weights[robot])
    if task == "all":
        return tasks
    if f"{robot}-{task}" not in tasks:
        raise ConfigurationError(f"there is no task {task!r} for the {robot} robot; its tasks are {', '.join(tasks)}")
    return (f"{robot}-{task}",)


def _order(given: str | None) -> Order:
    if given is None:
        return "agent"
    return "none" if given == "none" else int(given)


def from_anywhere(given: str, names: Container[str]) -> str:
    """A name as it is, the path of something that exists in full, and what is neither for the checks to complain about."""
    path = Path(given).expanduser()
    return given if given in names or not path.exists() else str(path.resolve())


def _new_folder(given: Mapping[str, Any], options: Options) -> Path:
    """A folder under runs/ that says what was evaluated and is not there yet."""
    what = options.environments[0] if len(options.environments) == 1 else f"{given['robot']}-all"
    parts = [what, Path(options.agent).name, f"s{options.seed}"]
    if options.disturbances != "ideal":
        parts.insert(2, Path(options.disturbances).stem)
    name = "-".join(parts)
    number = 1
    while (RUNS / (name if number == 1 else f"{name}-{number}")).exists():
        number += 1
    return RUNS / (name if number == 1 else f"{name}-{number}")


def cpus() -> int:
    """How many CPUs this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _say_how_to_resume(folder: EpisodeFolder) -> None:
    options = folder.manifest.options
    total = options.episodes * len(options.environments)
    click.echo(
        f"hockey: interrupted after {len(folder.records)} of {total} episodes; continue with:\n"
        f"  hockey evaluate --resume --out {shlex.quote(str(folder.path))}",
        err=True,
    )


@contextlib.contextmanager
def stdout_for_the_result() -> Iterator[None]:
    """What an agent prints, here or in a worker, goes to the standard error."""
    sys.stdout.flush()
    stdout = os.dup(1)
    os.dup2(2, 1)
    try:
        with contextlib.redirect_stdout(sys.stderr):
            yield
    finally:
        sys.stdout.flush()
        os.dup2(stdout, 1)
        os.close(stdout)

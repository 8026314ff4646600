"""The result of a run as a table for people."""

from rich import box
from rich.console import Console
from rich.table import Table

from airhockey.envs.editions import Deployability, edition
from airhockey.evaluator import RunResult, TaskResult
from airhockey.evaluator.evaluation import failure_reasons
from airhockey.evaluator.judging.tasks import wilson_interval
from airhockey.evaluator.runs.episode_folder import EpisodeFolder

OFFICIAL_EPISODES = 1000  # what the limits of the deployability classes are made for


def print_result(result: TaskResult | RunResult, folder: EpisodeFolder) -> None:
    """Print the table, what went wrong, and where everything is stored."""
    console = Console(highlight=False)
    tasks = result.tasks
    console.print(_table(tasks, folder))
    if isinstance(result, RunResult):
        score = "" if result.score is None else f", {result.phase} score {result.score:.3f}"
        console.print(f"overall: {result.deployability}{score}")
    for reason, episodes in failure_reasons(folder.path):
        console.print(f"agent failed {episodes} episode{'s' if episodes > 1 else ''}: {reason}", markup=False)
    versions = ", ".join(f"{name} {version}" for name, version in folder.manifest.versions.items())
    console.print(f"seed {tasks[0].seed}, {versions}", soft_wrap=True)
    console.print(f"stored in {folder.path}", soft_wrap=True, markup=False)


def _table(tasks: tuple[TaskResult, ...], folder: EpisodeFolder) -> Table:
    options = folder.manifest.options
    rules = edition(options.edition).deployability
    title = f"agent {options.agent}, {options.episodes} episodes, disturbances {options.disturbances}"
    table = Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("")
    for task in tasks:
        table.add_column(task.env, justify="right")
    table.add_row("success", *(f"{task.success:.1%}" for task in tasks))
    table.add_row("  95 % interval", *map(_interval, tasks))
    for name in dict.fromkeys(name for task in tasks for name in task.violations):
        table.add_row(f"episodes violating {name}", *(str(task.violations.get(name, "–")) for task in tasks))
    table.add_row("penalty points", *(f"{task.penalty:g}" for task in tasks))
    table.add_row("deployability", *(task.deployability for task in tasks))
    if options.episodes != OFFICIAL_EPISODES:
        table.add_row(
            f"  at this rate, {OFFICIAL_EPISODES} episodes", *(_official_class(task, rules) for task in tasks)
        )
    for name in ("mean", "p99", "max"):
        label = f"draw_action {name}, {options.clock} clock"
        table.add_row(label, *(f"{getattr(task.computation_time, name) * 1e3:.3f} ms" for task in tasks))
    table.add_row("episodes failed by the agent", *(str(task.agent_errors) for task in tasks))
    return table


def _official_class(task: TaskResult, rules: Deployability) -> str:
    return rules.class_of(task.penalty * OFFICIAL_EPISODES / task.episodes)


def _interval(task: TaskResult) -> str:
    low, high = wilson_interval(round(task.success * task.episodes), task.episodes)
    return f"{low:.1%} – {high:.1%}"

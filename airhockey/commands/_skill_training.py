"""What `hockey train sac` does once its options are read."""

import contextlib
import shlex
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import rich_click as click
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from airhockey.commands._evaluation import INTERRUPTED, RUNS, from_anywhere
from airhockey.envs.disturbances import available
from airhockey.errors import MissingDependencyError
from airhockey.learning.sac.folder import CARD, NETWORK, SkillFolder
from airhockey.learning.sac.records import Line, Settings

DIVERGED = 4


def run(given: Mapping[str, Any], typed: set[str]) -> int:
    """Do what the options say; returns the exit status."""
    try:
        from airhockey.learning.sac.evaluation import evaluate_skill
        from airhockey.learning.sac.trainer import DivergedError, Trainer
    except ImportError as error:
        raise MissingDependencyError(
            f"training skills needs {error.name or 'a package'}, which cannot be imported; "
            "install it with: pip install 'airhockey[rl]'"
        ) from error
    folder = _open_run(given, typed)
    figures = None
    try:
        with contextlib.suppress(KeyboardInterrupt):
            trainer = Trainer(folder)
            with _progress(folder.manifest.options, trainer.progress.steps, given["quiet"]) as on_line:
                trainer.run(on_line)
            figures = evaluate_skill(trainer.settings, folder.manifest.profile, trainer.network, given["episodes"])
            folder.write_card({"actions": trainer.progress.steps, "control_steps": trainer.env.steps, **figures})
    except DivergedError as error:
        click.echo(f"hockey: the training diverged: {error}; the last checkpoint is the last good one", err=True)
        return DIVERGED
    finally:
        folder.close()
    if figures is None:
        click.echo(
            "hockey: interrupted; continue from the last checkpoint with:\n"
            f"  hockey train sac --resume --out {shlex.quote(str(folder.path))}",
            err=True,
        )
        return INTERRUPTED
    click.echo(
        f"{figures['episodes']} unseen episodes: success {figures['success']:.1%}, return {figures['mean_return']:.4g}, "
        f"violations in {figures['violations']:.2%} of the steps\n"
        f"network: {folder.path / NETWORK}, its card: {folder.path / CARD}"
    )
    return 0


def _open_run(given: Mapping[str, Any], typed: set[str]) -> SkillFolder:
    """The run to take up, or a new one."""
    fields = set(Settings.__struct_fields__) & set(given)
    values = {name: given[name] for name in fields}
    values["disturbances"] = from_anywhere(given["disturbances"], available())
    if not given["resume"]:
        settings = Settings(**values)
        return SkillFolder.begin(settings, Path(given["out"]) if given["out"] else _new_folder(settings))
    return SkillFolder.resume(Path(given["out"]), {name: values[name] for name in sorted(fields & typed)})


def _new_folder(settings: Settings) -> Path:
    """A folder under runs/ that says what is trained and is not there yet."""
    name = f"{settings.algorithm}-{settings.robot}-{settings.task}-s{settings.seed}"
    number = 1
    while (RUNS / (name if number == 1 else f"{name}-{number}")).exists():
        number += 1
    return RUNS / (name if number == 1 else f"{name}-{number}")


@contextlib.contextmanager
def _progress(settings: Settings, done: int, quiet: bool) -> Iterator[Callable[[Line], None] | None]:
    """A line for every line of the log, and on a terminal a bar; on the standard error."""
    if quiet:
        yield None
        return
    console = Console(stderr=True)
    console.print("episode   actions     return   success  violations   entropy  actions/s", highlight=False)

    def show(line: Line) -> None:
        text = (
            f"{line.episode:>7} {line.steps:>9} {line.mean_return:>10.4g} {line.success:>9.1%} {line.violations:>11.2%} "
            f"{line.entropy:>9.3g} {line.steps_per_second:>10.0f}"
        )
        console.print(text, highlight=False, soft_wrap=True)

    if not console.is_terminal:
        yield show
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console) as bar:
        task = bar.add_task("actions", total=settings.steps, completed=done)

        def on_line(line: Line) -> None:
            show(line)
            bar.update(task, completed=min(line.steps, settings.steps))

        yield on_line

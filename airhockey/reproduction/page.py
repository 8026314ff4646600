"""The page: every table and figure of chapter 5 whose runs are finished, beside what is printed."""

from pathlib import Path

from airhockey.evaluator.runs.disk import disk_errors, replace_file
from airhockey.reporting.blocks import facts, section
from airhockey.reporting.markup import Markup
from airhockey.reporting.page import contents, page
from airhockey.reproduction.experiments import PARTS, experiments
from airhockey.reproduction.figures import figure_section
from airhockey.reproduction.folder import PAGE, ReproductionFolder
from airhockey.reproduction.tables import game_section, task_section


def write_page(folder: ReproductionFolder) -> None:
    """Leave the page of what is finished in the folder; raises `AirHockeyError` where the disk is full."""
    content = thesis_page(folder.path, {str(key) for key in folder.done}).encode()
    with disk_errors(folder.path):
        replace_file(folder.path / PAGE, content)


def thesis_page(path: Path, done: set[str]) -> str:
    """The page of a reproduction; the same for the same runs.

    Args:
        path: Its folder.
        done: Keys of the finished experiments.
    """
    manifest = ReproductionFolder.read(path)
    options = manifest.options
    shown: list[tuple[str, str, Markup]] = []
    for part in PARTS:
        keys = [one.key for one in experiments(options, (part,)) if one.key in done]
        if not keys or part == "table-5.3":
            continue
        kind, _, number = part.partition("-")
        if kind == "figure":
            shown.append((part, f"Figure {number}", figure_section(part, path, keys)))
        elif number < "5.4":
            drawn = task_section(part, path, done)
            if drawn is not None:
                shown.append((part, "Table 5.1" if number == "5.1" else "Tables 5.2, 5.3", drawn))
        elif all(identifier != "games" for identifier, *_ in shown):
            drawn = game_section(path, done)
            if drawn is not None:
                shown.append(("games", "Tables 5.4 – 5.7", drawn))
    missing = len({one.key for one in experiments(options)} - done)
    conditions = [
        ("seed", str(options.seed)),
        ("disturbances of tables", options.disturbances),
        ("episodes of a task", f"{options.episodes:,}"),
        ("games of a table", f"{options.games} of {options.steps:,} steps"),
        ("a training", f"{options.iterations} updates of {options.candidates} × {options.rollouts} episodes"),
        ("seeds of figures 5.4 and 5.5", str(options.seeds)),
        ("not run yet", f"{missing} experiments" if missing else "nothing"),
        ("versions", ", ".join(f"{name} {version}" for name, version in manifest.versions.items())),
    ]
    shown.append(("conditions", "Conditions", section("conditions", "Conditions", facts(conditions))))
    return page(
        "Chapter 5 of the thesis, run again",
        "What is printed, what the same player does here, and why they differ",
        [part for *_, part in shown],
        contents([(identifier, name) for identifier, name, _ in shown]),
        "Made by hockey reproduce thesis.",
    )

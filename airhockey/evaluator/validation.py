"""Is a submission fit to be handed in? Load it apart from everything, play a little, and say what to mend, and how."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec

from airhockey.agents.packaging.checkout import PACKAGE, find_checkout
from airhockey.agents.packaging.edition import edition_of_entry
from airhockey.agents.packaging.metadata import METADATA, Metadata, interpolation_order, read_metadata
from airhockey.agents.packaging.packing import contents
from airhockey.agents.packaging.unfetched import FETCH, what_is_missing
from airhockey.agents.submission import CONFIG, submission_config
from airhockey.compat.entries import notes
from airhockey.envs.editions import DEFAULT, Edition, edition
from airhockey.errors import ConfigurationError
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.isolation.modes import Mode
from airhockey.evaluator.pacing import BUSY
from airhockey.evaluator.play.build_seats import Entrant
from airhockey.evaluator.trial import GAME, Problem, Trial, slow, try_out

_SERVER = "tournament_server"
"""What configurations call a game that the official server asks for."""


class Verdict(msgspec.Struct, frozen=True):
    """What validation found.

    Attributes:
        left_out: File -> why `hockey package` leaves it out.
        notes: How the submission is played, where that is not obvious.
        conclusion: Plays, or does not because of what; whose cause that is, and what to do. One line.
        edition: The year whose rules it was tried under.
    """

    name: str
    problems: tuple[Problem, ...]
    trials: tuple[Trial, ...]
    left_out: dict[str, str]
    notes: tuple[str, ...] = ()
    conclusion: str = ""
    edition: str = DEFAULT


def validate(
    path: Path, mode: Mode, limits: Limits, steps: int = 50, python: str | None = None, year: str | None = None
) -> Verdict:
    """Look at a submission and let it play.

    Args:
        path: Folder or archive: a checkout, the folder of its agent, or one of ours.
        mode: Where its code runs.
        limits: What it may use, and how long anybody waits.
        steps: Control steps of each task.
        python: Another interpreter for its process.
        year: Of the rules; by default those that it was made for.
    """
    name = path.name if path.is_file() else path.resolve().name
    try:
        checkout = find_checkout(path)
    except ConfigurationError as error:
        remedy = "`hockey new DIR` makes a folder as it should be, `hockey package DIR` an archive"
        problem = Problem(name, str(error), remedy)
        return Verdict(name, (problem,), (), {}, conclusion=concluded(name, [], [problem]))
    metadata, config, problems = _paper(checkout.package)
    name = metadata.name if metadata is not None else checkout.root.name if name == PACKAGE else name
    left_out, trials = dict[str, str](), list[Trial]()
    if metadata is not None and path.is_dir():
        try:
            left_out = contents(path)[1]
        except ConfigurationError as error:
            remedy = "see the names and sizes above; `hockey package` needs this"
            problems.append(Problem(name, str(error), remedy))
    rules = edition(year or edition_of_entry(path) or DEFAULT)
    told = list(notes(path))
    unfetched = what_is_missing(checkout.root)
    if not any(problem.where == CONFIG for problem in problems):
        tasks, unknown_tasks = _tasks(metadata, config, rules)
        problems += unknown_tasks
        if metadata is None:
            where = f"env in {CONFIG}" if "env" in config else f"the usual ones ({CONFIG} names none)"
            told.append(
                f"the layout is the official one; the tasks are {where}; `hockey package` would want a {METADATA}"
            )
        if rules.edition != DEFAULT:
            told.append(f"played under the rules of {rules.edition} (--edition chooses)")
        sides = [(task, 1) for task in tasks] + [(task, 2) for task in tasks if task == GAME]
        before = len(problems)
        for task, side in sides:
            entrant = Entrant(str(path.resolve()), isolate=mode, limits=limits, python=python)
            outcome = try_out(entrant, task, steps, side, rules.edition)
            if isinstance(outcome, Trial):
                trials.append(outcome)
                problems += slow(outcome)
            else:
                problems.append(outcome)
        if unfetched and len(trials) < len(sides):
            problems.insert(before, Problem("the checkout", unfetched, FETCH))
        elif unfetched:
            told.append(unfetched)
    if any(trial.thinking > BUSY for trial in trials):
        told.append(
            "it thinks between its steps, in threads or processes: evaluations pace them as on the robot (--real-time)"
        )
    conclusion = concluded(name, trials, problems)
    return Verdict(name, tuple(problems), tuple(trials), left_out, tuple(told), conclusion, rules.edition)


def concluded(name: str, trials: list[Trial], problems: list[Problem]) -> str:
    """One line: plays, or does not play because …, whose cause that is, what to do."""
    played = ", ".join(dict.fromkeys(trial.env for trial in trials))
    if not problems:
        return f"{name}: plays {played}: fit to be handed in"
    first, more = problems[0], f"; and {len(problems) - 1} more problem(s)" if len(problems) > 1 else ""
    what = f"{first.what} (in {first.where}; {_cause(first)}); what to do: {first.remedy}{more}"
    return f"{name}: plays {played}, but {what}" if played else f"{name}: does not play, because {what}"


def _cause(problem: Problem) -> str:
    """Whose cause a problem is."""
    if "is not installed" in problem.what:
        return "this installation's cause"
    if any(
        word in problem.what
        for word in ("written for another version", "0-dimensional", "array element with a sequence")
    ):
        return "the libraries' cause: they are not those of its time"
    if "git lfs" in problem.what or "git submodule" in problem.what:
        return "this checkout's cause: git has not fetched all of it"
    if "No space left" in problem.what or "bubblewrap" in problem.what:
        return "this machine's cause"
    return "the entry's cause"


def _tasks(metadata: Metadata | None, config: dict[str, Any], rules: Edition) -> tuple[list[str], list[Problem]]:
    """What a submission plays: what its metadata or its configuration names, else everything of the iiwa."""
    file, where = (CONFIG, "env") if metadata is None else (METADATA, "tasks")
    named = config.get("env", [*rules.tasks_of("7dof"), GAME]) if metadata is None else list(metadata.tasks)
    tasks, problems = list[str](), list[Problem]()
    for name in map(str, named if isinstance(named, list) else [named]):
        try:
            tasks.append(GAME if name == _SERVER else rules.counterpart(name))
        except ConfigurationError as error:
            problems.append(Problem(f"{where} of {file}", str(error), "name one of these"))
    return list(dict.fromkeys(tasks)), problems


def _paper(folder: Path) -> tuple[Metadata | None, dict[str, Any], list[Problem]]:
    """What the submission's own files say."""
    problems: list[Problem] = []
    metadata, config = None, dict[str, Any]()
    try:
        config = submission_config(folder)
        if "interpolation_order" in config:
            interpolation_order(config["interpolation_order"])
    except ConfigurationError as error:
        problems.append(Problem(CONFIG, str(error), "write plain YAML: names, numbers, texts, lists"))
    try:
        metadata = read_metadata(folder)
    except ConfigurationError as error:
        problems.append(Problem(METADATA, str(error), "`hockey new` shows a file as it should be"))
    else:
        problems += _contradictions(metadata, config) if metadata is not None else ()
    return metadata, config, problems


def _contradictions(metadata: Metadata, config: dict[str, Any]) -> Iterator[Problem]:
    for requirement in metadata.missing_packages:
        yield Problem(METADATA, f"the package {requirement!r} is not installed here", f"pip install '{requirement}'")
    named = config.get("interpolation_order", metadata.interpolation_order)
    if str(named).lower() != str(metadata.interpolation_order).lower():
        yield Problem(
            METADATA,
            f"interpolation_order is {metadata.interpolation_order!r}, but {named!r} in {CONFIG}, which wins",
            "give the same order in both",
        )

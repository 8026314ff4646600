"""What came out, in one table; what is missing; and under which conditions it was played."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import msgspec

from airhockey.envs.disturbances import Disturbances
from airhockey.evaluator.judging.tasks import OFFICIAL_EPISODES
from airhockey.evaluator.judging.tasks import score as phase_score
from airhockey.evaluator.runs.reader import Match, Run, Source, Tournament, Unreadable, short_name
from airhockey.evaluator.runs.records import isolation_of
from airhockey.reporting import words
from airhockey.reporting.blocks import Row, badge, details, facts, paragraphs, section, table
from airhockey.reporting.markup import Child, Markup, element, joined
from airhockey.reporting.results import Task
from airhockey.reporting.sections.quantities import FEW, kinds_of, one_below_another, quantities, side_by_side


def summary(tasks: Sequence[Task]) -> Markup:
    """The results of all tasks of all runs."""
    caption = "Results by task and agent"
    sentences = [
        "Violations count episodes; each costs its points once per episode. A control step leaves draw_action 20 ms. An "
        "episode that the agent failed by an error is no success."
    ]
    if any(task.verdict.episodes != OFFICIAL_EPISODES for task in tasks):
        sentences.append(f"Deployability is the class of the penalty at the rate of {OFFICIAL_EPISODES} episodes.")
    if len(tasks) == 1:
        kinds = kinds_of(tasks)
        shown = joined(_key_figures(tasks[0]), facts(quantities(tasks[0], kinds)[5 : 6 + len(kinds)]))
    elif len(tasks) <= FEW:
        shown = side_by_side(caption, tasks, [f"{task.env}: {task.label}" for task in tasks])
    else:
        shown = one_below_another(caption, tasks)
        sentences.insert(0, "Under a constraint's name stands in how many episodes it was violated.")
    return section(
        "summary", "Summary", shown, paragraphs(_phases(tasks), "lead"), paragraphs([" ".join(sentences)], "note")
    )


def missing(sources: Iterable[Source], below: Path | None = None) -> Markup | None:
    """What could not be read, for every folder that lacks something; None where nothing does.

    Args:
        sources: The folders.
        below: Show paths below this folder, which is nobody else's business.
    """
    rows = [(source, note) for source in sources for note in source.notes]
    if not rows:
        return None
    listed = [element("li", element("code", _shown(source.path, below)), ": ", note) for source, note in rows]
    return element("section", element("h2", "What is missing"), element("ul", *listed), id="missing", class_="warning")


def conditions(sources: Iterable[Source], labels: dict[int, str]) -> Markup:
    """Where the results come from and under which conditions they were played, side by side."""
    shown = [source for source in sources if not isinstance(source, Unreadable)]
    columns = [_conditions_of(source) for source in shown]
    names = list(dict.fromkeys(name for column in columns for name in column))
    rows: list[Row] = [(name, *(column.get(name, "–") for column in columns)) for name in names]
    profiles = {source.manifest.profile: None for source in shown if source.manifest}
    return section(
        "conditions",
        "Conditions",
        table("Conditions by folder", ("", *(labels[id(source)] for source in shown)), rows, numbers_from=99),
        _contents(shown, labels),
        *(details(f"Disturbances {profile.profile} in full", facts(_flat(profile))) for profile in profiles),
    )


def _key_figures(task: Task) -> Markup:
    mean, p99, longest = task.computation_time
    pairs: list[tuple[str, Child]] = [
        (
            "success",
            [
                element("b", words.percent(task.verdict.success)),
                words.interval(task.verdict.successes, task.verdict.episodes),
            ],
        ),
        ("penalty points", [element("b", f"{task.verdict.penalty:g}"), badge(task.verdict.official_class)]),
        ("draw_action, p99", [element("b", words.milliseconds(p99 or mean)), f"longest {words.milliseconds(longest)}"]),
        ("episodes", [element("b", f"{task.verdict.episodes:,}"), f"{task.verdict.failures} failed by the agent"]),
    ]
    return element("div", facts(pairs), class_="key")


def _phases(tasks: Sequence[Task]) -> list[str]:
    """A sentence for every run that played all tasks of a phase."""
    said = []
    for run in {id(task.run): task.run for task in tasks}.values():
        own = [task for task in tasks if task.run is run]
        phase, score = phase_score({task.env: task.verdict.success for task in own}, own[0].rules)
        if score is not None:
            rules = own[0].rules
            weights = next(rules.score_weights[robot] for robot, name in rules.phases.items() if name == phase)
            formula = " + ".join(f"{weight:g} {env}" for env, weight in weights.items())
            said.append(f"{own[0].label}: {phase} score {score:.3f} ({formula}).")
    return said


def _conditions_of(source: Run | Match | Tournament) -> dict[str, str]:
    """Name of a condition -> what it is, in the order in which they are shown."""
    found = {"folder": source.path.name, "disturbances": source.disturbances}
    if isinstance(source, Run) and source.manifest:
        options = source.manifest.options
        found |= {
            "agent": short_name(options.agent),
            "seed": str(options.seed),
            "edition": options.edition,
            "clock": options.clock,
            "interpolation order": str(options.interpolation_order),
            "isolation": isolation_of(record.process for record in source.records) or options.isolate,
        }
    elif not isinstance(source, Run) and source.manifest:
        game = source.manifest.options.game
        found |= {
            "seed": str(source.manifest.options.seed),
            "edition": game.edition,
            "clock": game.clock,
            "steps of a game": f"{game.steps:,}",
            "rules": game.variant,
            "isolation": isolation_of(side.process for record in source.records for side in (record.home, record.away))
            or game.isolate,
        }
    if source.created:
        found["begun"] = source.created.replace("T", " ")
    return found | source.versions


def _contents(sources: Iterable[Run | Match | Tournament], labels: dict[int, str]) -> Markup | None:
    """Agents and files that decided the results, by their content; None where all came with airhockey."""
    rows: list[Row] = []
    for source in sources:
        for path, digest in (source.manifest.inputs if source.manifest else {}).items():
            rows.append((labels[id(source)], short_name(path), element("code", digest)))
    if not rows:
        return None
    return joined(
        element("h3", "Agents and files by their content"),
        table("SHA-256 of agents and files", ("folder", "agent or file", "SHA-256"), rows, numbers_from=99),
    )


def _flat(profile: Disturbances) -> list[tuple[str, Child]]:
    """Every figure of a profile by its path."""
    pairs: list[tuple[str, Child]] = []
    for name, value in msgspec.to_builtins(profile).items():
        if isinstance(value, dict):
            pairs += [(f"{name} {key}".replace("_", " "), _figure(part)) for key, part in value.items()]
        elif name != "profile":
            pairs.append((name, _figure(value)))
    return pairs


def _shown(path: Path, below: Path | None) -> str:
    return str(path.relative_to(below)) if below is not None and path.is_relative_to(below) else str(path)


def _figure(value: Any) -> str:
    return " – ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)

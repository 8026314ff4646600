"""What came out, in one table; what is missing; and under which conditions it was played."""

from collections.abc import Iterable, Sequence

from airhockey.envs.editions import edition
from airhockey.evaluator.judging import PHASES
from airhockey.evaluator.judging import score as phase_score
from airhockey.reporting import words
from airhockey.reporting.blocks import badge, details, facts, paragraphs, section, table
from airhockey.reporting.markup import Child, Markup, element
from airhockey.reporting.results import OFFICIAL_EPISODES, Task
from airhockey.reporting.sources import Match, Nothing, Run, Source, Tournament, short_name


def summary(tasks: Sequence[Task]) -> Markup:
    """The results of all tasks of all runs."""
    kinds = list(dict.fromkeys(name for task in tasks for name in task.violations))
    head = [
        "task",
        "agent",
        "success",
        "95 % interval",
        "episodes",
        "penalty points",
        "deployability",
        *(f"{words.constraint(name)} violated" for name in kinds),
        "mean time",
        "p99",
        "longest",
        "failed",
    ]
    rows = [_row(task, kinds) for task in tasks]
    sentences = [
        "Violated counts episodes; each constraint costs its points once per episode. Times are those of draw_action, of which "
        "a control step leaves 20 ms. Failed are episodes that the agent ended by an error; they count as no success."
    ]
    if any(task.episodes != OFFICIAL_EPISODES for task in tasks):
        sentences.append(f"Deployability is the class of the penalty at the rate of {OFFICIAL_EPISODES} episodes.")
    return section(
        "summary",
        "Summary",
        _key_figures(tasks[0]) if len(tasks) == 1 else None,
        table("Results by task and agent", head, rows, numbers_from=2),
        paragraphs([*_phases(tasks)], "lead"),
        paragraphs(sentences, "note"),
    )


def missing(sources: Iterable[Source]) -> Markup | None:
    """What could not be read, for every folder that lacks something; None where nothing does."""
    rows = [(str(source.path), note) for source in sources for note in source.notes]
    if not rows:
        return None
    listed = [element("li", element("code", path), ": ", note) for path, note in rows]
    return element("section", element("h2", "What is missing"), element("ul", *listed), id="missing", class_="warning")


def conditions(sources: Iterable[Source], labels: dict[int, str]) -> Markup:
    """Where the results come from and under which conditions they were played."""
    shown = [source for source in sources if not isinstance(source, Nothing)]
    return section(
        "conditions", "Conditions", *(_conditions_of(source, labels.get(id(source), "")) for source in shown)
    )


def _row(task: Task, kinds: Sequence[str]) -> list[Child]:
    mean, p99, longest = task.computation_time
    return [
        task.env,
        task.label,
        element("strong", words.percent(task.success)),
        words.interval(task.successes, task.episodes),
        f"{task.episodes:,}",
        f"{task.penalty:g}",
        badge(task.deployability),
        *(str(task.violations.get(name, "–")) for name in kinds),
        words.milliseconds(mean),
        "–" if p99 is None else words.milliseconds(p99),
        words.milliseconds(longest),
        str(task.failures),
    ]


def _key_figures(task: Task) -> Markup:
    mean, p99, longest = task.computation_time
    pairs: list[tuple[str, Child]] = [
        ("success", [element("b", words.percent(task.success)), words.interval(task.successes, task.episodes)]),
        ("penalty points", [element("b", f"{task.penalty:g}"), badge(task.deployability)]),
        ("draw_action, p99", [element("b", words.milliseconds(p99 or mean)), f"longest {words.milliseconds(longest)}"]),
        ("episodes", [element("b", f"{task.episodes:,}"), f"{task.failures} failed by the agent"]),
    ]
    return element("div", facts(pairs), class_="key")


def _phases(tasks: Sequence[Task]) -> list[str]:
    """A sentence for every run that played all tasks of a phase."""
    said = []
    for run in {id(task.run): task.run for task in tasks}.values():
        own = [task for task in tasks if task.run is run]
        phase, score = phase_score({task.env: task.success for task in own}, own[0].rules)
        if score is not None:
            robot = next(robot for robot, name in PHASES.items() if name == phase)
            weights = edition(own[0].rules.edition).score_weights[robot]
            formula = " + ".join(f"{weight:g} {env}" for env, weight in weights.items())
            said.append(f"{own[0].label}: {phase} score {score:.3f} ({formula}).")
    return said


def _conditions_of(source: Run | Match | Tournament, label: str) -> Markup:
    manifest = source.manifest
    pairs: list[tuple[str, Child]] = [("folder", source.path.name), ("disturbances", source.disturbances)]
    if isinstance(source, Run) and source.manifest:
        options = source.manifest.options
        pairs += [
            ("agent", short_name(options.agent)),
            ("seed", str(options.seed)),
            ("edition", options.edition),
            ("interpolation order", str(options.interpolation_order)),
            ("clock", options.clock),
            ("isolation", options.isolate),
        ]
    elif not isinstance(source, Run) and source.manifest:
        game = source.manifest.options.game
        pairs += [
            ("seed", str(source.manifest.options.seed)),
            ("edition", game.edition),
            ("steps of a game", f"{game.steps:,}"),
            ("rules", game.variant),
            ("clock", game.clock),
        ]
    if manifest:
        pairs.append(("begun", manifest.created.replace("T", " ")))
        pairs += list(manifest.versions.items())
    return details(label or source.path.name, facts(pairs))

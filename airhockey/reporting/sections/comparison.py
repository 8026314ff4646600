"""Two or more runs of the same task, side by side: is one better, by how much, and could it be chance?"""

from collections.abc import Sequence
from dataclasses import dataclass

import msgspec

from airhockey.evaluator.judging import statistics
from airhockey.evaluator.judging.statistics import Difference
from airhockey.evaluator.judging.tasks import wilson_interval
from airhockey.reporting import words
from airhockey.reporting.blocks import figure, figures, paragraphs, section, table, tables
from airhockey.reporting.draw.axes import Scale
from airhockey.reporting.draw.intervals import Interval, interval_plot
from airhockey.reporting.markup import Markup
from airhockey.reporting.results import Task
from airhockey.reporting.sections.quantities import side_by_side

SIGNIFICANT = 0.05
_COLOURS = ("a", "b", "c", "d")


@dataclass(frozen=True)
class Comparison:
    """One run against another.

    Attributes:
        first, second: The two.
        difference: Of their success, first minus second.
        pairs: Episodes that both, only the first, only the second and none won; None where they are not paired.
    """

    first: Task
    second: Task
    difference: Difference
    pairs: tuple[int, int, int, int] | None


def compare(first: Task, second: Task) -> Comparison:
    """Compare two runs of the same task, episode by episode where the episodes' seeds agree."""
    if not same_seeds(first, second):
        difference = statistics.compare_samples(
            first.verdict.successes, first.verdict.episodes, second.verdict.successes, second.verdict.episodes
        )
        return Comparison(first, second, difference, None)
    one, other = ({record.index: record.success for record in task.records} for task in (first, second))
    shared = one.keys() & other.keys()
    both = sum(one[k] and other[k] for k in shared)
    only_first = sum(one[k] and not other[k] for k in shared)
    only_second = sum(other[k] and not one[k] for k in shared)
    pairs = (both, only_first, only_second, len(shared) - both - only_first - only_second)
    return Comparison(first, second, statistics.compare_pairs(*pairs), pairs)


def same_seeds(first: Task, second: Task) -> bool:
    """Whether episodes of the same index had the same start: same seed, same edition, and an episode that both played."""
    one, other = first.run.manifest, second.run.manifest
    if one is None or other is None:
        return False
    same = (one.options.seed, one.options.edition) == (other.options.seed, other.options.edition)
    return same and bool({r.index for r in first.records} & {r.index for r in second.records})


def comparison_section(env: str, tasks: Sequence[Task], figures_too: bool = True) -> Markup:
    """Every run of a task against the first one.

    Args:
        env: The task's environment.
        tasks: Of the runs, at least two.
        figures_too: Show all their figures side by side, unless the summary has done so.
    """
    found = [compare(task, tasks[0]) for task in tasks[1:]]
    adjusted = statistics.holm([comparison.difference.p_value for comparison in found])
    several = "With several comparisons, the p-values are adjusted (Holm)." if len(found) > 1 else None
    beside = []
    if figures_too:
        beside.append(("Side by side", side_by_side(f"{env}, side by side", tasks, [task.label for task in tasks])))
    return section(
        f"compare-{env}",
        f"Comparison: {env}",
        *(paragraphs([sentence(one, p)], "lead") for one, p in zip(found, adjusted, strict=True)),
        paragraphs(filter(None, [several, *_caveats(tasks)]), "note"),
        figures(_success(env, tasks), _differences(found)),
        tables(*beside, *(("Episode by episode", _pairs_table(one)) for one in found if one.pairs is not None)),
    )


def sentence(comparison: Comparison, p_value: float) -> str:
    """What a comparison says, in words.

    Args:
        comparison: See `compare`.
        p_value: Its p-value, adjusted if there are others beside it.
    """
    first, second, difference = comparison.first, comparison.second, comparison.difference
    ahead, behind = (first, second) if difference.estimate >= 0 else (second, first)
    low, high = (difference.low, difference.high) if ahead is first else (-difference.high, -difference.low)
    if comparison.pairs is None:
        how = "The episodes had different seeds, so they count as two samples (Fisher's exact test)"
    else:
        both = sum(comparison.pairs)
        alone = comparison.pairs[1:3] if ahead is first else comparison.pairs[2:0:-1]
        how = (
            f"In {words.count(both, 'episode')} with the same seeds, only {ahead.label} succeeded in {alone[0]:,} and only "
            f"{behind.label} in {alone[1]:,} (exact McNemar test)"
        )
    size = (
        f"{ahead.label} succeeds more often than {behind.label}, by {100 * abs(difference.estimate):.1f} percentage points"
        if difference.estimate
        else f"{ahead.label} and {behind.label} succeed equally often"
    )
    verdict = (
        "a difference that is hardly chance"
        if p_value < SIGNIFICANT
        else "no evidence that one is better: what there is may be chance"
    )
    return f"{size} (95 % interval {words.points(low)} to {words.points(high)}). {how}: {words.p_value(p_value)}, {verdict}."


def _caveats(tasks: Sequence[Task]) -> list[str]:
    """What else differs between the runs."""
    differing = []
    for name in ("disturbances", "versions", "edition", "clock", "interpolation_order", "seed"):
        values = {_condition(task, name) for task in tasks}
        if len(values) > 1:
            differing.append(name.replace("_", " "))
    unknown = [task.label for task in tasks if task.run.manifest is None]
    agents = {task.run.agent for task in tasks}
    said = [f"The conditions of {words.enumeration(unknown)} are unknown."] if unknown else []
    if differing and len(agents) == 1:
        said.append(f"The agent has the same name in all of them; what differs: {words.enumeration(differing)}.")
    elif differing:
        said.append(f"Not only the agents differ: so do {words.enumeration(differing)} (see Conditions).")
    return said


def _condition(task: Task, name: str) -> str:
    manifest = task.run.manifest
    if manifest is None:
        return "unknown"
    if name == "disturbances":
        return msgspec.json.encode(manifest.profile).decode()
    return str(manifest.versions if name == "versions" else getattr(manifest.options, name))


def _success(env: str, tasks: Sequence[Task]) -> Markup:
    rows = []
    for k, task in enumerate(tasks):
        low, high = wilson_interval(task.verdict.successes, task.verdict.episodes)
        value = words.percent(task.verdict.success)
        rows.append(Interval(task.label, value, 100 * low, 100 * task.verdict.success, 100 * high, _COLOURS[k % 4]))
    title = f"Success in {env}: " + "; ".join(f"{row.label} {row.value}" for row in rows)
    least = min(row.low for row in rows)
    scale = Scale(max(0.0, 10.0 * (least // 10.0)), 100.0)
    return figure("Success with 95 % intervals", interval_plot(rows, scale, "% of episodes", title))


def _differences(found: Sequence[Comparison]) -> Markup:
    rows = []
    for k, one in enumerate(found):
        estimate, low, high = (100.0 * value for value in one.difference[:3])
        label = f"{one.first.label} − {one.second.label}"
        rows.append(Interval(label, words.points(one.difference.estimate), low, estimate, high, _COLOURS[(k + 1) % 4]))
    reach = max(5.0, *(abs(value) for row in rows for value in (row.low, row.high)))
    scale = Scale(-5.0 * -(-reach // 5.0), 5.0 * -(-reach // 5.0))
    title = "Differences of success: " + "; ".join(f"{row.label} {row.value} points" for row in rows)
    drawing = interval_plot(rows, scale, "percentage points", title, mark=0.0)
    return figure(f"Difference to {found[0].second.label}, with 95 % intervals", drawing)


def _pairs_table(comparison: Comparison) -> Markup:
    assert comparison.pairs is not None
    both, only_first, only_second, neither = comparison.pairs
    first, second = comparison.first.label, comparison.second.label
    return table(
        f"Episodes by the success of {first} and {second}",
        ("", f"{second} succeeds", f"{second} does not"),
        [
            (f"{first} succeeds", f"{both:,}", f"{only_first:,}"),
            (f"{first} does not", f"{only_second:,}", f"{neither:,}"),
        ],
    )

"""Who is on a leaderboard, and with which results.

An entry is an agent's name. It is judged separately under every profile of disturbances, because results under different ones
cannot be compared. Of several runs of a task the one counts that is nearest to an official evaluation of 1000 episodes, and of
those the latest.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from airhockey.envs.disturbances import Disturbances
from airhockey.envs.editions import Edition, available, edition
from airhockey.evaluator.judging.tasks import CLASSES, OFFICIAL_EPISODES, weighted, worst_class
from airhockey.reporting.results import Task


@dataclass(frozen=True)
class Condition:
    """Under which results are compared.

    Attributes:
        edition: Of the rules.
        disturbances: Name of the profile.
        profile: The profile itself: a file of one name may change.
    """

    edition: str
    disturbances: str
    profile: Disturbances | None


@dataclass(frozen=True)
class Overall:
    """An entry's standing in all tasks of a robot.

    Attributes:
        name: Of the entry.
        tasks: Those that count, by environment.
        score: Weighted success, 0 … 1.
    """

    name: str
    tasks: Mapping[str, Task]
    score: float

    @property
    def deployability(self) -> str:
        """The worst task's class."""
        return worst_class(task.verdict.official_class for task in self.tasks.values())

    @property
    def penalty(self) -> float:
        """Penalty points of all tasks."""
        return sum(task.verdict.penalty for task in self.tasks.values())


@dataclass
class Board:
    """All results under one condition.

    Attributes:
        condition: The condition.
        label: Its name, which no other board of the site has.
        results: Entry -> environment -> its runs, the latest last.
    """

    condition: Condition
    label: str
    results: dict[str, dict[str, list[Task]]] = field(default_factory=dict)

    @property
    def environments(self) -> list[str]:
        """Those that anybody played."""
        return in_order({env for by_env in self.results.values() for env in by_env})

    def ranked(self, env: str) -> list[tuple[str, Task]]:
        """The entries of a task with the run that counts, best first within the better class first."""
        found = [(name, counting(by_env[env])) for name, by_env in self.results.items() if env in by_env]
        return sorted(
            found,
            key=lambda one: (
                CLASSES.index(one[1].verdict.official_class),
                -one[1].verdict.success,
                one[1].verdict.penalty,
                one[0],
            ),
        )

    def overall(self, weights: Mapping[str, float]) -> list[Overall]:
        """The entries that played every task of these weights, ranked as in a task."""
        found = []
        for name, by_env in self.results.items():
            if weights.keys() <= by_env.keys():
                tasks = {env: counting(by_env[env]) for env in weights}
                success = {env: task.verdict.success for env, task in tasks.items()}
                found.append(Overall(name, tasks, weighted(success, weights)))
        return sorted(found, key=lambda one: (CLASSES.index(one.deployability), -one.score, one.penalty, one.name))

    def incomplete(self, weights: Mapping[str, float]) -> list[tuple[str, list[str]]]:
        """Entries that played some tasks of these weights, and which ones they lack."""
        lacking = [(name, [env for env in weights if env not in by_env]) for name, by_env in self.results.items()]
        return [(name, envs) for name, envs in lacking if 0 < len(envs) < len(weights)]


def counting(tasks: Sequence[Task]) -> Task:
    """The run that counts."""
    return max(tasks, key=lambda task: (min(task.verdict.episodes, OFFICIAL_EPISODES), task.run.created))


def boards(tasks: Iterable[Task]) -> list[Board]:
    """Sort results by condition; the boards with the most entries first."""
    found: dict[Condition, Board] = {}
    for task in sorted(tasks, key=lambda task: task.run.created):
        manifest = task.run.manifest
        condition = Condition(
            edition=task.run.edition,
            disturbances=task.run.disturbances,
            profile=manifest.profile if manifest else None,
        )
        if condition not in found:
            name = task.run.conditions
            alike = sum(
                (other.edition, other.disturbances) == (condition.edition, task.run.disturbances) for other in found
            )
            label = name if not alike else f"{name} (another, {alike + 1})"
            found[condition] = Board(condition, label)
        found[condition].results.setdefault(task.run.agent, {}).setdefault(task.env, []).append(task)
    return sorted(found.values(), key=lambda board: (-len(board.results), board.label))


def in_order(environments: Collection[str]) -> list[str]:
    """Environments in the order of the challenge, those of the 7-DoF robot first."""
    names = [env for year in available() for env in edition(year).environments]
    known = [env for env in sorted(dict.fromkeys(names), key=lambda env: env[:4] != "7dof") if env in environments]
    return known + sorted(set(environments) - set(known))


def phases(rules: Edition) -> dict[str, Mapping[str, float]]:
    """Phase -> weights of its tasks, the 7-DoF robot's first."""
    return {rules.phases[robot]: rules.score_weights[robot] for robot in sorted(rules.score_weights, reverse=True)}

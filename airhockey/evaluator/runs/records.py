"""What a run is asked to do and what it leaves behind, as typed records that travel as JSON."""

from collections.abc import Iterable
from typing import Literal

import msgspec
import numpy as np
from numpy.typing import NDArray

from airhockey.envs.editions import DEFAULT, available, edition
from airhockey.evaluator.runs import notebook

Trajectory = dict[str, NDArray[np.float64]]
"""One episode's arrays by name; `airhockey.evaluator.play.episode.Recorder.trajectory` says which."""

Order = int | Literal["agent", "none"]
"""An interpolation order; "agent" leaves the choice to the agent, "none" means that an action is the 20 set-points."""


class Options(msgspec.Struct, frozen=True, kw_only=True):
    """Everything that a run's result depends on, besides the versions of the software.

    Attributes:
        environments: Names of the tasks' environments, played one after the other.
        agent: A name of the registry or the absolute path of a submission folder.
        episodes: Number of episodes of each task.
        seed: From it, the task and the episode's index come the seeds of every episode.
        disturbances: Name of a profile or absolute path of a YAML file.
        interpolation_order: See `Order`.
        clock: What the time of `draw_action` is measured with.
        edition: The year whose rules apply.
        isolate: Where the agent lives: with the evaluator, in a process of its own, or in a sandbox.
        patience: Longest time for an answer of an agent that lives elsewhere, in [s].
        real_time: Pace of the steps relative to the robot's, for agents that think beside them; 0: as fast as possible.
        python: Absolute path of another interpreter for the agent's process; None for the evaluator's own.
        settings: Of our own players' controller, as in "control.solver=osqp".
        agent_seed: Secret from which the seeds of the agent's own generators come, in hexadecimal, so that no agent can find the
            environment's; None for seeds that follow from `seed`.
        parameters: Of the rule-based player: a name that it knows or the absolute path of a YAML file; None for its own.
        keep: What is kept of trajectories, see `airhockey.evaluator.runs.keeping`; UNSET, which manifests do not mention, for
            all of it.
    """

    environments: tuple[str, ...]
    agent: str = "planner"
    episodes: int = 1000
    seed: int = 0
    disturbances: str = "ideal"
    interpolation_order: Order = "agent"
    clock: Literal["wall", "cpu"] = "cpu"
    edition: str = DEFAULT
    isolate: Literal["none", "process", "sandbox"] = "none"
    patience: float = 60.0
    real_time: float = 0.0
    python: str | None = None
    settings: tuple[str, ...] = ()
    parameters: str | None = None
    agent_seed: str | None = None
    keep: Literal["actions", "none"] | msgspec.UnsetType = msgspec.field(default=msgspec.UNSET, name="trajectories")

    @property
    def trajectories(self) -> Literal["full", "actions", "none"]:
        """What is kept of them."""
        return "full" if self.keep is msgspec.UNSET else self.keep

    def __post_init__(self) -> None:
        """Environments go by the names of their edition, whichever they were given by; checks complain about others."""
        if self.edition in available():
            names = edition(self.edition).names
            environments = tuple(names.get(name, name) for name in self.environments)
            msgspec.structs.force_setattr(self, "environments", environments)


class Job(msgspec.Struct, frozen=True):
    """One episode to play: the environment's name and the episode's index in its task."""

    env: str
    index: int


class StepTime(msgspec.Struct, frozen=True, kw_only=True):
    """Time that `draw_action` took in one episode, in [s]."""

    mean: float = 0.0
    max: float = 0.0


class AgentProcess(msgspec.Struct, frozen=True, kw_only=True):
    """Where an agent lived, and the wall time that it took besides its commands.

    Attributes:
        isolation: How far it was kept apart, by what, and what was not limited; "none": it lived with the evaluator; "": there
            was none, or the journal is older than this field.
        build_time: To build it, in [s].
        start_time: Of the longest start of an episode or serve, in [s].
    """

    isolation: str = ""
    build_time: float = 0.0
    start_time: float = 0.0


def isolation_of(processes: Iterable[AgentProcess]) -> str:
    """How agents were kept apart, as their records say; "" where none does."""
    return " / ".join(dict.fromkeys(process.isolation for process in processes if process.isolation))


class EpisodeRecord(msgspec.Struct, frozen=True, kw_only=True):
    """One line of the journal.

    Attributes:
        env: Name of the environment.
        index: Index of the episode in its task.
        success: What the task says about the last step; False where the agent failed.
        steps: Control steps played.
        absorbing: Whether the task ended the episode; False at the horizon and where the agent failed.
        violations: Constraint name -> number of steps that violated it.
        computation_time: Of `draw_action`.
        process: Where the agent lived.
        error: Why the agent failed the episode; None where it did not.
        edition: The year whose rules applied.
        interpolation_order: Of the agent's actions, "none" for 20 set-points; None where no step was played, and in journals
            that are older than this field.
    """

    env: str
    index: int
    success: bool = False
    steps: int = 0
    absorbing: bool = False
    violations: dict[str, int] = {}
    computation_time: StepTime = StepTime()
    process: AgentProcess = AgentProcess()
    error: str | None = None
    edition: str = DEFAULT
    interpolation_order: int | Literal["none"] | None = None

    @property
    def job(self) -> Job:
        """The job that this record answers."""
        return Job(self.env, self.index)

    @property
    def key(self) -> Job:
        """Names the episode in its run."""
        return self.job


class Episode(msgspec.Struct, frozen=True):
    """A played episode: what the journal gets and what the trajectory file gets."""

    record: EpisodeRecord
    trajectory: Trajectory


class RunTime(msgspec.Struct, frozen=True, kw_only=True):
    """Time that `draw_action` took over a whole task, in [s].

    Attributes:
        late: Steps in which it took longer than a control step lasts.
    """

    mean: float
    p99: float
    max: float
    late: int = 0


class PreparationTime(msgspec.Struct, frozen=True, kw_only=True):
    """The longest wall times that an agent took besides its commands, in [s]."""

    build_agent: float = 0.0
    episode_start: float = 0.0


class TaskResult(msgspec.Struct, frozen=True, kw_only=True):
    """The result of one task; its JSON is what `hockey evaluate --json` prints.

    Attributes:
        success: Share of episodes, 0 … 1.
        penalty: Penalty points, summed over the episodes.
        violations: Constraint name -> number of episodes that violated it.
        agent_errors: Number of episodes that the agent failed.
        inputs: See `Manifest`.
        edition: The year whose rules applied.
        isolation: How far the agent was kept apart, see `AgentProcess`; all of them where machines differ.
    """

    env: str
    agent: str
    episodes: int
    seed: int
    disturbances: str
    success: float
    penalty: float
    deployability: str
    violations: dict[str, int]
    computation_time: RunTime
    agent_errors: int
    inputs: dict[str, str] = {}
    edition: str = DEFAULT
    isolation: str = ""
    preparation_time: PreparationTime = PreparationTime()

    @property
    def tasks(self) -> "tuple[TaskResult, ...]":
        """The results of the single tasks: this one."""
        return (self,)

    def _repr_html_(self) -> str:
        return _as_html(self.tasks)


class RunResult(msgspec.Struct, frozen=True, kw_only=True):
    """The results of several tasks, and of the whole where every task of a phase was played.

    Attributes:
        deployability: The worst task's class.
        phase: "phase-1" (3dof) or "phase-2" (7dof), in the edition of 2025 "qualifying"; None unless all its tasks were played.
        score: Weighted success of the phase's tasks, 0 … 1.
        edition: The year whose rules applied.
    """

    results: tuple[TaskResult, ...]
    deployability: str
    phase: str | None
    score: float | None
    edition: str = DEFAULT

    @property
    def tasks(self) -> tuple[TaskResult, ...]:
        """The results of the single tasks."""
        return self.results

    def _repr_html_(self) -> str:
        score = "" if self.score is None else f", {self.phase} score {self.score:.3f}"
        return _as_html(self.results, f"overall {self.deployability}{score}")


def _as_html(results: tuple[TaskResult, ...], more: str = "") -> str:
    first = results[0]
    return notebook.table(
        f"{first.agent}, seed {first.seed}, disturbances {first.disturbances}" + (more and f": {more}"),
        ("task", "episodes", "success", "penalty", "class", "draw_action mean", "agent failed"),
        (
            (one.env, one.episodes, f"{one.success:.1%}", f"{one.penalty:g}", one.deployability,
             f"{1e3 * one.computation_time.mean:.3f} ms", one.agent_errors)
            for one in results
        ),
    )  # fmt: skip

"""Episodes of tasks: the function that engines run. It builds the environment and the seat once for many episodes."""

import functools
import gc
import time
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from airhockey.envs.disturbances import Disturbances
from airhockey.evaluator.isolation.failures import AgentTimeout
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.play import seeding
from airhockey.evaluator.play.build_seats import Entrant, build_seats
from airhockey.evaluator.play.recorder import Recorder, violated_steps
from airhockey.evaluator.play.rollout import Rollout
from airhockey.evaluator.play.seat import Care, Seat
from airhockey.evaluator.runs.records import AgentProcess, Episode, EpisodeRecord, Job, Options, StepTime

REBUILD = 10.0
"""What building an agent again may cost on average for every episode, in [s]."""


def play(job: Job, rollout: Rollout, recorder: Recorder) -> Episode:
    """Play an episode to its end, or to the agent's failure.

    Args:
        job: Which episode this is.
        rollout: Of one seat, not begun.
        recorder: Buffers of this environment's size.
    """
    (seat,) = rollout.seats
    recorder.start(rollout.begin())
    step, add = rollout.step, recorder.add
    while not rollout.over and recorder.steps < recorder.horizon and step():
        add(seat.action, rollout.reward, seat.seconds, rollout.observation)
    went_well = seat.failure is None
    trajectory = recorder.trajectory() if recorder.steps else {}
    times = trajectory.get("computation_time", np.empty(0))
    record = EpisodeRecord(
        env=job.env,
        index=job.index,
        success=went_well and bool(rollout.info["success"]),
        steps=recorder.steps,
        absorbing=went_well and bool(rollout.over),
        violations=violated_steps(recorder.constraint_values[: recorder.steps], recorder.constraint_slices),
        computation_time=StepTime(mean=float(times.mean()), max=float(times.max())) if times.size else StepTime(),
        process=seat.process,
        error=seat.failure,
        edition=rollout.env.edition.edition,
        interpolation_order=None if not recorder.steps else "none" if seat.form.order is None else seat.form.order,
    )
    return Episode(record, trajectory)


@dataclass
class _Task:
    """What is built for one environment."""

    name: str
    env: Any
    seats: tuple[Seat, ...]
    recorder: Recorder

    @property
    def broke_down(self) -> bool:
        """Whether an agent that could be built has failed; it is to start afresh."""
        return any(seat.agent is not None and seat.failure is not None for seat in self.seats)


@dataclass
class Rebuilding:
    """The time that goes into an agent that breaks down again and again: to build it anew, and to wait for it in vain.

    Attributes:
        spent, allowed: So far, in [s].
    """

    spent: float = 0.0
    allowed: float = Limits.start + Limits.patience

    def refusal(self) -> str | None:
        """Why an agent that broke down is not built again; None if it is."""
        if self.spent <= self.allowed:
            return None
        return (
            f"build_agent: it broke down too often: {self.spent:.0f} s went into building it again and waiting in vain, "
            f"{Limits.start + Limits.patience:.0f} s and {REBUILD:.0f} s for every episode are allowed"
        )


@dataclass
class EpisodePlayer:
    """Plays the episodes of a run. Picklable until it has played the first one.

    Attributes:
        options: The run's.
        profile: The disturbances, which `options` name.
    """

    options: Options
    profile: Disturbances
    _task: _Task | None = field(default=None, repr=False)
    _rebuilding: Rebuilding = field(default_factory=Rebuilding, repr=False)

    def __call__(self, job: Job) -> Episode:
        """Play one episode; the result depends on the options and on the job, not on what was played before, unless the agent
        wastes hours by breaking down."""
        waited_for = self._rebuilding.refusal() if self._task is not None and self._task.broke_down else None
        self._rebuilding.allowed += REBUILD
        if waited_for is not None:
            assert self._task is not None
            return failed(job, waited_for, self.options.edition, self._task.seats[0].process)
        rollout = self.open(job)
        (seat,) = rollout.seats
        if seat.failure is not None:
            return failed(job, seat.failure, self.options.edition, seat.process)
        assert self._task is not None
        return play(job, rollout, self._task.recorder)

    def open(self, job: Job) -> Rollout:
        """An episode that is not begun, its agent seeded; the seat has failed where there is no agent."""
        task, seed = self._task_of(job.env), functools.partial(seeding.seed_of, self.options.seed, job.env, job.index)
        secret = self.options.agent_seed
        for_agent = seeding.agent_seed_of(secret, self.options.seed, job.env, job.index, seeding.AGENT)
        seeding.seed_global_generators(for_agent)
        for seat in task.seats:
            seat.seed(for_agent)
        return Rollout(task.env, task.seats, seed(seeding.ENVIRONMENT), self.options.real_time)

    def close(self) -> None:
        """Tell the agent that the evaluation is over, and let go of everything built."""
        task, self._task = self._task, None
        gc.unfreeze()
        for seat in () if task is None else task.seats:
            seat.stop()

    def _task_of(self, name: str) -> _Task:
        """The environment and its seat, built for another one than the last, and after an agent broke down."""
        if self._task is None or self._task.name != name or self._task.broke_down:
            if self._task is not None and isinstance(self._task.seats[0].error, AgentTimeout):
                self._rebuilding.spent += self.options.patience
            self.close()
            self._task = self._build(name)
            gc.collect()
            gc.freeze()  # or a collection in the middle of an episode would walk over every module ever imported
        return self._task

    def _build(self, name: str) -> _Task:
        from airhockey import envs

        options = self.options
        seed = seeding.agent_seed_of(options.agent_seed, options.seed, name, 0, seeding.AGENT_BUILD)
        entrant = Entrant(
            options.agent,
            options.interpolation_order,
            options.isolate,
            Limits(patience=options.patience),
            options.parameters,
            seed,
            options.python,
            options.settings,
        )
        make = functools.partial(envs.make, name, disturbances=self.profile, edition=options.edition)
        began = time.monotonic()
        env, seats = build_seats(make, [entrant], Care(options.clock), seed)
        self._rebuilding.spent += time.monotonic() - began
        return _Task(name, env, seats, Recorder(env, env.reset(seed=0).size, self.profile.blurs_observations))


def failed(job: Job, reason: str, edition: str, process: AgentProcess | None = None) -> Episode:
    """An episode that the agent failed before its first step."""
    where = AgentProcess() if process is None else process
    return Episode(EpisodeRecord(env=job.env, index=job.index, process=where, error=reason, edition=edition), {})

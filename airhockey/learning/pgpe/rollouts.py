"""The function that engines run: it plays episodes of given parameters, and says what they were worth."""

import zlib
from dataclasses import dataclass, field

import numpy as np

from airhockey.agents.parameters import convert
from airhockey.agents.thesis.parameters import ThesisParameters
from airhockey.evaluator.isolation.failures import agent_failures, describe
from airhockey.evaluator.play import seeding
from airhockey.evaluator.play.blame import fault_of_machine
from airhockey.evaluator.play.rollout import Rollout
from airhockey.evaluator.play.seat import Seat
from airhockey.learning.pgpe.records import Outcome, PgpeManifest, RolloutJob, Settings
from airhockey.learning.pgpe.stage import Stage, environments_of
from airhockey.learning.pgpe.trainable import bounds, replaced

_TRAINING = zlib.crc32(b"training")
"""First key of training seeds; an evaluation's begin with the checksum of an environment's name."""


@dataclass
class Rollouts:
    """Plays the episodes of a training run. Picklable until it has played the first one.

    Attributes:
        manifest: The run's.
    """

    manifest: PgpeManifest[Settings]
    _stages: dict[str, Stage] = field(default_factory=dict, repr=False)
    _seats: dict[str, tuple[tuple[float, ...], Seat]] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        settings = self.manifest.options
        self._environments = environments_of(settings.task, settings.robot)
        self._start = convert(ThesisParameters, self.manifest.parameters, "train.json: parameters")
        self._lower, self._upper = bounds(settings.names)

    def __call__(self, job: RolloutJob) -> Outcome:
        """Play one episode; the outcome depends on the manifest and on the job, not on what was played before."""
        stage = self._stage(self._environments[job.episode % len(self._environments)])
        seed = self._seed(job)
        seeding.seed_global_generators(seed)
        try:
            seat = self._seat(stage, job.theta)
        except agent_failures() as failure:
            fault = fault_of_machine(failure, "thesis")
            if fault is not None:
                raise fault from failure
            return Outcome(error=describe(failure))
        return self._play(stage, seat, seed)

    def _stage(self, name: str) -> Stage:
        if name not in self._stages:
            settings = self.manifest.options
            self._stages[name] = Stage(
                settings.task, name, settings.discount, self.manifest.profile,
                sparse=settings.reward == "sparse", fixed=settings.fixed_start, seed=settings.seed,
            )  # fmt: skip
        return self._stages[name]

    def _seat(self, stage: Stage, theta: tuple[float, ...]) -> Seat:
        """The seat of the player with these parameters, built anew when they are others than the last ones."""
        known = self._seats.get(stage.name)
        if known is not None and known[0] == theta:
            return known[1]
        within = np.clip(theta, self._lower, self._upper)
        values = dict(zip(self.manifest.options.names, map(float, within), strict=True))
        seat = stage.seat(replaced(self._start, values))
        self._seats[stage.name] = theta, seat
        return seat

    def _seed(self, job: RolloutJob) -> np.random.SeedSequence:
        settings = self.manifest.options
        candidate = 0 if settings.common_random_numbers else job.candidate + 1
        return np.random.SeedSequence(settings.seed, spawn_key=(_TRAINING, job.iteration, candidate, job.episode))

    def _play(self, stage: Stage, seat: Seat, seed: np.random.SeedSequence) -> Outcome:
        env, reward, rollout = stage.env, stage.reward, Rollout(stage.env, [seat], seed)
        shaped = self.manifest.options.reward != "success"
        discount, value, weight = self.manifest.options.discount, 0.0, 1.0
        rollout.begin()
        rollout.observation = stage.place(rollout.observation, seed)
        state = env.base_observation
        violated = np.zeros(env.constraint_values.size, dtype=bool)
        while not rollout.over and env.step_count < env.horizon and rollout.step():
            violated |= env.constraint_values > 0.0
            if shaped:
                next_state = env.base_observation
                value += weight * reward(env, state, seat.action, next_state, rollout.over)
                weight *= discount
                state = next_state
        if seat.error is not None:
            self._seats.clear()  # a player that broke down starts afresh
            return Outcome(error=describe(seat.error))
        success = stage.accomplished()
        names = tuple(name for name, part in env.constraint_slices.items() if violated[part].any())
        return Outcome(
            value=value if shaped else float(success),
            success=success,
            penalty=sum(env.edition.penalty_points[name] for name in names),
            violated=names,
            steps=env.step_count,
        )

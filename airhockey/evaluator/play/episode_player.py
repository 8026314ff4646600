"""The function that engines run: it plays jobs, and builds the environment and the agent once for many."""

import gc
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from airhockey.envs.disturbances import Disturbances
from airhockey.errors import ConfigurationError
from airhockey.evaluator.isolation.handle import AgentHandle
from airhockey.evaluator.play import seeding
from airhockey.evaluator.play.episode import CLOCKS, Recorder, agent_failures, describe, play
from airhockey.evaluator.runs.records import Episode, EpisodeRecord, Job, Options, Order


@dataclass
class Setting:
    """An environment with its recorder and, unless it could not be built, the agent that plays on it.

    Attributes:
        failure: Why there is no agent.
    """

    name: str
    env: Any
    recorder: Recorder
    agent: Any = None
    failure: str | None = None


@dataclass
class Player:
    """Plays the episodes of a run. Picklable until it has played the first one.

    Attributes:
        options: The run's.
        profile: The disturbances, which `options` name.
    """

    options: Options
    profile: Disturbances
    _setting: Setting | None = field(default=None, repr=False)

    def __call__(self, job: Job) -> Episode:
        """Play one episode; the result depends on the options and on the job, not on what was played before."""
        setting = self._setting_for(job.env)
        if setting.failure is not None:
            return failed(job, setting.failure)
        seed = self.options.seed
        seeding.seed_global_generators(seeding.seed_of(seed, job.env, job.index, seeding.AGENT))
        env_seed = seeding.seed_of(seed, job.env, job.index, seeding.ENVIRONMENT)
        if isinstance(setting.agent, AgentHandle):
            setting.agent.seed(seeding.seed_of(seed, job.env, job.index, seeding.AGENT))
        episode = play(job, setting.env, setting.agent, env_seed, self.clock_of(setting.agent), setting.recorder)
        if episode.record.error is not None:
            self._discard()  # an agent that broke down starts afresh
        return episode

    def clock_of(self, agent: Any) -> Callable[[], float]:
        """What measures an agent's `draw_action`, in [s]."""
        return agent.clock(self.options.clock) if isinstance(agent, AgentHandle) else CLOCKS[self.options.clock]

    def close(self) -> None:
        """Tell the agent that the evaluation is over, and let go of everything built."""
        setting = self._forget()
        stop = getattr(setting.agent, "stop", None) if setting is not None else None
        if stop is not None:
            try:
                stop()
            except agent_failures():
                return  # its episodes are played and stored; nothing is left to fail

    def _discard(self) -> None:
        """Let go of an agent without telling it; what lives in another process is ended."""
        setting = self._forget()
        if setting is not None and isinstance(setting.agent, AgentHandle):
            setting.agent.close()

    def _forget(self) -> Setting | None:
        setting, self._setting = self._setting, None
        gc.unfreeze()
        return setting

    def _setting_for(self, env_name: str) -> Setting:
        """The setting of this environment, built when it is another than the last one's."""
        if self._setting is None or self._setting.name != env_name:
            self.close()
            self._setting = self._build(env_name)
            gc.collect()
            gc.freeze()  # or a collection in the middle of an episode would walk over every module ever imported
        return self._setting

    def _build(self, env_name: str) -> Setting:
        """An environment of the interpolation order asked for, or of the one that the agent wants."""
        asked = self.options.interpolation_order
        order = named_order(self.options.agent) if asked == "agent" else as_order(asked)
        setting = self._build_with(env_name, order)
        wanted = getattr(setting.agent, "interpolation_order", order)
        if asked != "agent" or wanted == order:
            return setting
        if isinstance(setting.agent, AgentHandle):
            setting.agent.close()
        try:
            return self._build_with(env_name, wanted)
        except ConfigurationError as error:
            setting.failure = f"build_agent: {describe(error)}"  # an order that there is not
            return setting

    def _build_with(self, env_name: str, order: int | None) -> Setting:
        """An environment of this order, and an agent made for it if it can be made."""
        from airhockey import envs
        from airhockey.agents import AGENTS
        from airhockey.evaluator.isolation.build import build_agent

        options = self.options
        env = envs.make(env_name, interpolation_order=order, disturbances=self.profile, edition=options.edition)
        recorder = Recorder(env, env.reset(seed=0).size, disturbed=self.profile.blurs_observations)
        setting = Setting(env_name, env, recorder)
        # Our own agents can play any order; a submission's order is a matter of its agent_config.yml.
        told = options.interpolation_order != "agent" and options.agent in AGENTS
        kwargs: dict[str, Any] = {"interpolation_order": order} if told else {}
        if options.parameters is not None:
            kwargs["parameters"] = options.parameters
        seed = seeding.seed_of(options.seed, env_name, 0, seeding.AGENT_BUILD)
        seeding.seed_global_generators(seed)
        try:
            setting.agent = build_agent(
                options.agent,
                env,
                mode=options.isolate,
                patience=options.patience,
                order=order,
                seed=seed,
                **kwargs,
            )
        except agent_failures() as failure:
            setting.failure = f"build_agent: {describe(failure)}"
        return setting


def as_order(order: Order) -> int | None:
    """The order as `envs.make` takes it; "none" is None."""
    return order if isinstance(order, int) else None


def named_order(agent: str) -> int | None:
    """The order that a submission's files name; 3, the usual one, for everybody else."""
    from airhockey.agents.submission import is_submission, wanted_order

    try:
        return wanted_order(Path(agent)) if is_submission(agent) else 3
    except ConfigurationError:
        return 3  # the builder will say the same


def failed(job: Job, reason: str) -> Episode:
    """An episode that the agent failed before its first step."""
    return Episode(EpisodeRecord(env=job.env, index=job.index, error=reason), {})

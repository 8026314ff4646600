"""Playing one episode: the agent proposes, the environment moves, and everything is kept for the judge."""

import contextlib
import signal
import time
import traceback
from collections.abc import Callable
from typing import Any, Final

import numpy as np

from airhockey.errors import AirHockeyError
from airhockey.evaluator.isolation.failures import AgentRaised
from airhockey.evaluator.runs.records import Episode, EpisodeRecord, Job, StepTime, Trajectory

CLOCKS: Final[dict[str, Callable[[], float]]] = {"wall": time.perf_counter, "cpu": time.thread_time}


class Recorder:
    """Buffers for one episode, reused from episode to episode. `trajectory()` says what they hold."""

    def __init__(self, env: Any, observation_size: int, disturbed: bool) -> None:
        """Allocate buffers for an environment.

        Args:
            env: Has `horizon`, `constraint_slices`, `constraint_values` and `true_observation`.
            observation_size: Number of entries of an observation.
            disturbed: Whether the agent may see something else than what is judged.
        """
        self.horizon = int(env.horizon)
        self.steps = 0
        self.constraint_slices: dict[str, slice] = dict(env.constraint_slices)
        self.constraint_values = np.empty((self.horizon, env.constraint_values.size))
        self._env = env
        self._disturbed = disturbed
        self._observations = np.empty((self.horizon + 1, observation_size))
        self._true_observations = np.empty((self.horizon + 1, observation_size))
        self._actions = np.empty((self.horizon, 0))
        self._rewards = np.empty(self.horizon)
        self._computation_time = np.empty(self.horizon)

    def clear(self) -> None:
        """Make room for the next episode."""
        self.steps = 0

    def start(self, observation: Any) -> None:
        """Keep the first observation."""
        self._observations[0] = observation
        if self._disturbed:
            self._true_observations[0] = self._env.true_observation

    def add(self, action: Any, reward: float, seconds: float, observation: Any) -> None:
        """Keep one step: the action, what `draw_action` took, and what came of it."""
        step = self.steps
        if step == 0 and self._actions.shape[1:] != np.shape(action):
            self._actions = np.empty((self.horizon, *np.shape(action)))
        self._actions[step] = action
        self._rewards[step] = reward
        self._computation_time[step] = seconds
        self.constraint_values[step] = self._env.constraint_values
        self._observations[step + 1] = observation
        if self._disturbed:
            self._true_observations[step + 1] = self._env.true_observation
        self.steps = step + 1

    def trajectory(self) -> Trajectory:
        """Copies of what was kept, by name.

        Returns:
            `observations`, as the agent was given them, and `true_observations` where they may differ, (T + 1, d);
            `actions`, by interpolation order, (T, …); `rewards` (T,); `computation_time` (T,) in [s];
            `constraints/<name>` (T, c), violated where > 0.
        """
        steps = self.steps
        kept = {"observations": self._observations[: steps + 1].copy()}
        if self._disturbed:
            kept["true_observations"] = self._true_observations[: steps + 1].copy()
        kept["actions"] = self._actions[:steps].copy()
        kept["rewards"] = self._rewards[:steps].copy()
        kept["computation_time"] = self._computation_time[:steps].copy()
        for name, columns in self.constraint_slices.items():
            kept[f"constraints/{name}"] = self.constraint_values[:steps, columns].copy()
        return kept


def play(
    job: Job, env: Any, agent: Any, seed: np.random.SeedSequence, clock: Callable[[], float], recorder: Recorder
) -> Episode:
    """Play an episode to its end, or to the agent's failure.

    The order of calls is the official core's: the agent's `episode_start`, then the environment's reset, then steps.

    Args:
        job: Which episode this is.
        env: The simulation.
        agent: Has `episode_start`, `draw_action` and perhaps `preprocessors`.
        seed: The environment's.
        clock: Measures `draw_action`, in [s].
        recorder: Buffers of this environment's size.
    """
    recorder.clear()
    absorbing, success, error = False, False, None
    try:
        absorbing, success = _play(env, agent, seed, clock, recorder)
    except agent_failures() as failure:
        error = f"step {recorder.steps}: {describe(failure)}"
    trajectory = recorder.trajectory() if recorder.steps else {}
    times = trajectory.get("computation_time", np.empty(0))
    record = EpisodeRecord(
        env=job.env,
        index=job.index,
        success=success,
        steps=recorder.steps,
        absorbing=absorbing,
        violations=violated_steps(recorder.constraint_values[: recorder.steps], recorder.constraint_slices),
        computation_time=StepTime(mean=float(times.mean()), max=float(times.max())) if times.size else StepTime(),
        error=error,
    )
    return Episode(record, trajectory)


def _play(
    env: Any, agent: Any, seed: np.random.SeedSequence, clock: Callable[[], float], recorder: Recorder
) -> tuple[bool, bool]:
    """The control loop. Returns whether the task ended the episode, and whether the last step counts as a success."""
    agent.episode_start()
    preprocessors = tuple(getattr(agent, "preprocessors", ()))
    draw_action, step, add = agent.draw_action, env.step, recorder.add
    observation = env.reset(seed=seed)
    recorder.start(observation)
    absorbing, info = False, {}
    for _ in range(recorder.horizon):
        for preprocessor in preprocessors:
            observation = preprocessor(observation)
        started = clock()
        action = draw_action(observation)
        seconds = clock() - started
        observation, reward, absorbing, info = step(action)
        add(action, reward, seconds, observation)
        if absorbing:
            break
    return bool(absorbing), bool(info["success"])


def violated_steps(constraint_values: Any, slices: dict[str, slice]) -> dict[str, int]:
    """Constraint name -> number of steps that violated it.

    Args:
        constraint_values: Violated where > 0. Shape (T, c).
        slices: Constraint name -> its columns.
    """
    violated = constraint_values > 0.0
    return {name: int(violated[:, columns].any(axis=1).sum()) for name, columns in slices.items()}


def agent_failures() -> tuple[type[BaseException], ...]:
    """What counts as the agent's failure when its code is called.

    A KeyboardInterrupt is the user's, unless this process ignores the user's: then only the agent can have raised it.
    """
    ignored = signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    return (Exception, SystemExit, KeyboardInterrupt) if ignored else (Exception, SystemExit)


def describe(failure: BaseException) -> str:
    """One line: the kind of error, what it says, and for an error that is not ours the file and line."""
    text = " ".join(str(failure).split())[:300]
    if isinstance(failure, AgentRaised):
        return text  # described where it was raised
    place = ""
    if not isinstance(failure, AirHockeyError):
        with contextlib.suppress(IndexError):
            frame = traceback.extract_tb(failure.__traceback__)[-1]
            place = f" ({frame.filename.rsplit('/', 1)[-1]}:{frame.lineno})"
    return f"{type(failure).__name__}: {text}{place}" if text else f"{type(failure).__name__}{place}"

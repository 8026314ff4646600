import signal
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airhockey import envs
from airhockey.evaluator.isolation.handle import LocalAgent
from airhockey.evaluator.play.episode import play
from airhockey.evaluator.play.recorder import Recorder, violated_steps
from airhockey.evaluator.play.rollout import Rollout
from airhockey.evaluator.play.seat import Care, Seat
from airhockey.evaluator.runs.records import Episode, Job

ENV = envs.make("3dof-hit")
SIZE = ENV.reset(seed=0).size


class Agent:
    """Moves its first joint steadily; does something else at one step."""

    def __init__(self, special: Callable[[], Any] | None = None, at: int = 5) -> None:
        self.special, self.at = special, at
        self.preprocessors: list[Any] = []

    def episode_start(self) -> None:
        self.step = 0

    def draw_action(self, observation: Any) -> Any:
        self.step += 1
        if self.special is not None and self.step == self.at:
            return self.special()
        position = observation[ENV.env_info["joint_pos_ids"]]
        return np.array([position + np.array([0.01, 0, 0]), 0 * position])


def played(agent: Any, clock: Callable[[], float] = time.perf_counter) -> Episode:
    seat = Seat(LocalAgent(agent), ENV.formats[0], Care())
    seat.clock = clock
    rollout = Rollout(ENV, [seat], np.random.SeedSequence(1))
    return play(Job("3dof-hit", 4), rollout, Recorder(ENV, SIZE, False))


def throw(error: BaseException) -> Callable[[], Any]:
    def raise_it() -> Any:
        raise error

    return raise_it


@pytest.mark.parametrize(
    ("special", "reason"),
    [
        (throw(ValueError("bad\nluck")), r"^step 4: ValueError: bad luck \(test_episode.py:\d+\)$"),
        (throw(SystemExit(0)), "^step 4: SystemExit: 0"),
        (throw(ZeroDivisionError()), r"^step 4: ZeroDivisionError \(test_episode"),
        (lambda: np.zeros((2, 4)), r"^step 4: ActionError: .*\(2, 4\)"),
        (lambda: np.full((2, 3), np.nan), "^step 4: ActionError"),
        (lambda: np.full((2, 3), np.inf), "^step 4: ActionError"),
        (lambda: None, "^step 4: ActionError"),
        (lambda: "left", "^step 4: ActionError"),
        (lambda: [[0.0, 0.0, 0.0], [0.0]], "^step 4: ActionError"),
        (lambda: object(), "^step 4: ActionError"),
    ],
)
def test_the_agents_failures_are_recorded(special: Callable[[], Any], reason: str) -> None:
    import re

    episode = played(Agent(special))
    assert re.search(reason, episode.record.error or "")
    assert episode.record.steps == 4
    assert not episode.record.success
    assert not episode.record.absorbing
    assert len(episode.trajectory["observations"]) == 5
    assert len(episode.trajectory["actions"]) == 4


def test_an_agent_without_methods_fails_before_the_first_step() -> None:
    episode = played(object())
    assert "AttributeError" in (episode.record.error or "")
    assert episode.record.steps == 0
    assert episode.trajectory == {}


def test_ctrl_c_is_the_users_unless_this_process_ignores_it() -> None:
    with pytest.raises(KeyboardInterrupt):
        played(Agent(throw(KeyboardInterrupt())))
    handler = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        assert "KeyboardInterrupt" in (played(Agent(throw(KeyboardInterrupt()))).record.error or "")
    finally:
        signal.signal(signal.SIGINT, handler)


def test_the_trajectory_is_what_the_environment_gave_and_the_agent_returned() -> None:
    episode = played(Agent())
    env = envs.make("3dof-hit")
    observation = env.reset(seed=np.random.SeedSequence(1))
    arrays = episode.trajectory
    for step in range(episode.record.steps):
        assert np.array_equal(arrays["observations"][step], observation)
        observation, reward, absorbing, info = env.step(arrays["actions"][step])
        assert reward == arrays["rewards"][step]
        for name, values in info["constraints_value"].items():
            assert np.array_equal(arrays[f"constraints/{name}"][step], values)
    assert np.array_equal(arrays["observations"][-1], observation)
    assert (bool(absorbing), bool(info["success"])) == (episode.record.absorbing, episode.record.success)
    assert episode.record.steps == env.horizon or absorbing


def test_violations_are_counted_from_what_was_recorded() -> None:
    values = np.array([[-1.0, 0.0, 1.0], [-1.0, 2.0, -1.0], [-1.0, 1.0, 1.0]])
    assert violated_steps(values, {"a": slice(0, 1), "b": slice(1, 3)}) == {"a": 0, "b": 3}
    assert violated_steps(values[:0], {"a": slice(0, 3)}) == {"a": 0}


def test_time_is_measured_around_draw_action_alone() -> None:
    """On a clock that only the agent moves: 100 s in `episode_start`, 1 s in each `draw_action`, 3 s more in the fifth."""
    now = [0.0]

    class Ticks(Agent):
        def episode_start(self) -> None:
            super().episode_start()
            now[0] += 100.0

        def draw_action(self, observation: Any) -> Any:
            now[0] += 1.0 if self.step != 4 else 4.0
            return super().draw_action(observation)

    episode = played(Ticks(), lambda: now[0])
    times = episode.trajectory["computation_time"]
    assert times[4] == episode.record.computation_time.max == 4.0
    assert set(np.delete(times, 4)) == {1.0}
    assert episode.record.computation_time.mean == pytest.approx(1.0 + 3.0 / times.size)


def test_preprocessors_stand_between_environment_and_agent() -> None:
    seen = []

    class Looks(Agent):
        def draw_action(self, observation: Any) -> Any:
            seen.append(observation.copy())
            return super().draw_action(observation)

    agent = Looks()
    agent.preprocessors = [lambda observation: observation + 1, lambda observation: observation * 2]
    episode = played(agent)
    assert np.array_equal(seen[3], (episode.trajectory["observations"][3] + 1) * 2)


def test_an_agent_that_writes_into_its_observation_changes_nothing() -> None:
    class Scribbles(Agent):
        def draw_action(self, observation: Any) -> Any:
            action = super().draw_action(observation)
            observation[:] = 0
            return action

    one, other = played(Agent()), played(Scribbles())
    for name, values in one.trajectory.items():
        if name != "computation_time":
            assert np.array_equal(values, other.trajectory[name])

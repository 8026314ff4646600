"""Agents that live apart play episodes and games as those that do not; where they fail, they fail alone."""

import socket
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from airhockey import envs
from airhockey.envs.disturbances import load_disturbances
from airhockey.errors import ConfigurationError
from airhockey.evaluator import Options
from airhockey.evaluator.isolation import modes
from airhockey.evaluator.isolation.build import build_agent
from airhockey.evaluator.isolation.failures import AgentDied, AgentTimeout
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.isolation.serving import listen, serve
from airhockey.evaluator.play.episode import EpisodePlayer
from airhockey.evaluator.play.game import Game, GamePlayer
from airhockey.evaluator.runs.game_records import GameJob, GameOptions
from airhockey.evaluator.runs.records import Episode, Job

ENV = "3dof-defend"


def episodes(count: int = 2, **given: Any) -> list[Episode]:
    player = EpisodePlayer(Options(environments=(ENV,), seed=3, **given), load_disturbances("ideal"))
    try:
        return [player(Job(ENV, index)) for index in range(count)]
    finally:
        player.close()


def test_an_agent_draws_the_same_random_numbers_wherever_it_lives(
    submission: Callable[..., str], sandbox: None
) -> None:
    agent = submission()
    here, there = episodes(agent=agent), episodes(agent=agent, isolate="sandbox")
    for one, other in zip(here, there, strict=True):
        np.testing.assert_array_equal(one.trajectory["actions"], other.trajectory["actions"])
        assert one.record.success == other.record.success


def test_a_failed_agent_is_restarted_for_the_next_episode(submission: Callable[..., str], tmp_path: Path) -> None:
    agent = submission("if self.episodes == 2: time.sleep(60)")
    played = episodes(3, agent=agent, isolate="process", patience=0.5)
    assert [episode.record.error is None for episode in played] == [True, False, True]
    assert "did not answer within 0.5 s" in str(played[1].record.error)


def test_the_evaluator_measures_the_time(submission: Callable[..., str]) -> None:
    agent = submission("time.sleep(0.02 if self.steps == 2 else 0); time.perf_counter = time.thread_time = lambda: 0.0")
    (wall,) = episodes(1, agent=agent, isolate="process", clock="wall")
    assert wall.record.computation_time.max > 0.02
    busy = submission("sum(range(1000000)) if self.steps == 2 else 0")
    (cpu,) = episodes(1, agent=busy, isolate="process", clock="cpu")
    assert 0.005 < cpu.record.computation_time.max < 1.0 and cpu.record.computation_time.mean < 0.005


def game(home: str, away: str, **given: Any) -> Game:
    job = GameJob(key="0", home="home", away="away", home_agent=home, away_agent=away, seed=1)
    return GamePlayer(GameOptions(steps=60, **given), load_disturbances("ideal"))(job)


def test_who_does_not_answer_forfeits_and_the_game_is_kept(submission: Callable[..., str], sandbox: None) -> None:
    played = game("hold", submission("if self.steps == 40: time.sleep(60)"), isolate="auto", patience=0.5)
    assert played.record.home.failure is None and played.record.winner == "home"
    assert "did not answer within 0.5 s" in str(played.record.away.failure)
    assert played.record.steps >= 39 and len(played.film) >= 39


def test_who_answers_late_has_its_last_command_held(submission: Callable[..., str]) -> None:
    late = submission("time.sleep(0.03 if self.steps == 40 else 0)")
    played = game("hold", late, isolate="process", clock="wall")
    assert played.record.away.held >= 1 and played.record.away.failure is None


def test_both_players_of_a_game_live_apart(submission: Callable[..., str], sandbox: None) -> None:
    agent = submission(
        "assert len([p for p in os.listdir('/proc') if p.isdigit()]) == 2"
    )  # the sandbox's first, and it
    played = game(agent, agent, isolate="sandbox")
    assert (played.record.home.failure, played.record.away.failure) == (None, None)


def test_the_default_mode(submission: Callable[..., str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modes, "why_no_sandbox", lambda: None)
    agent = submission()
    assert modes.choose("thesis").mode == "none" and modes.choose("tcp://localhost:1").mode == "none"
    assert modes.choose(agent) == modes.Choice("sandbox")
    monkeypatch.setattr(modes, "why_no_sandbox", lambda: "no bubblewrap")
    choice = modes.choose(agent)
    assert choice.mode == "process" and "files" in str(choice.warning)
    with pytest.raises(ConfigurationError, match="no bubblewrap"):
        modes.choose(agent, "sandbox")


@pytest.fixture
def served() -> Iterator[str]:
    """The thesis agent behind a port."""
    env = envs.make("7dof-hit")
    agent = build_agent("thesis", env)
    with listen("127.0.0.1", 0) as waiting:
        thread = threading.Thread(target=serve, args=(waiting, agent, 23, 1), daemon=True)
        thread.start()
        yield f"tcp://127.0.0.1:{waiting.getsockname()[1]}"
        thread.join(10.0)


def test_a_remote_agent_plays_as_at_home(served: str) -> None:
    env = envs.make("7dof-hit")
    actions = []
    for agent in (build_agent("thesis", env), build_agent(served, env)):
        agent.episode_start()
        observation = env.reset(seed=0)
        drawn = []
        for _ in range(40):
            for preprocessor in agent.preprocessors:
                observation = preprocessor(observation)
            drawn.append(agent.act(observation))
            observation, *_ = env.step(drawn[-1])
        agent.stop()
        actions.append(drawn)
    np.testing.assert_array_equal(*actions)


@pytest.mark.parametrize(
    ("answer", "error", "text"),
    [
        (b"", AgentDied, "hung up"),
        (b"x", AgentDied, "did not confirm"),
        (b"r" + bytes(47), AgentDied, "hung up after 47 of 48"),
        (b"r" + bytes(480), AgentDied, "too long"),
        (None, AgentTimeout, "within 0.3 s"),
    ],
)
def test_a_remote_agent_that_breaks_the_protocol_fails(answer: bytes | None, error: Any, text: str) -> None:
    env = envs.make("3dof-hit")
    with socket.create_server(("127.0.0.1", 0)) as server:

        def misbehave() -> None:
            connection, _ = server.accept()
            with connection:
                connection.recv(1)
                if answer is None:
                    time.sleep(1.0)
                elif answer:
                    connection.sendall(answer[:1])
                    connection.recv(1000)
                    connection.sendall(answer[1:])
                    time.sleep(0.1)

        threading.Thread(target=misbehave, daemon=True).start()
        agent = build_agent(f"tcp://127.0.0.1:{server.getsockname()[1]}", env, limits=Limits(patience=0.3))
        with pytest.raises(error, match=text):
            two_steps(agent, env.reset(seed=0))


def two_steps(agent: Any, observation: Any) -> None:
    agent.episode_start()
    agent.act(observation)
    time.sleep(0.05)
    agent.act(observation)


@pytest.mark.parametrize("address", ["tcp://", "tcp://host", "tcp://host:x", "tcp://host:99999", "tcp://:80"])
def test_addresses_are_checked(address: str) -> None:
    with pytest.raises(ConfigurationError, match="write tcp://HOST:PORT"):
        modes.host_and_port(address)

"""A copied player plays on by itself, and the original is left as it is, whichever way the copy was made."""

import copy
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cloudpickle
import numpy as np
import pytest

from airhockey import envs
from airhockey.agents import AGENTS, build_agent
from airhockey.agents.hold import HoldAgent
from airhockey.agents.person import Hand
from airhockey.envs.vector.threads import Threads
from airhockey.evaluator import Options, begin
from airhockey.evaluator.isolation.build import build_agent as build_handle
from airhockey.evaluator.play.rollout import Rollout
from airhockey.evaluator.play.seat import Care, Seat
from airhockey.evaluator.play.watchdog import Watch

WAYS: dict[str, Callable[[Any], Any]] = {
    "agent.copy": lambda agent: agent.copy(),
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda agent: pickle.loads(pickle.dumps(agent)),
    "cloudpickle": lambda agent: pickle.loads(cloudpickle.dumps(agent)),
}
BEFORE, AFTER = 25, 30
PLAYED = [(name, env) for name in AGENTS for env in ("3dof-hit", "7dof-defend", "tournament")]


def mid_episode(name: str, env_name: str, **kwargs: Any) -> tuple[Any, Any, Any]:
    """An agent, its environment and what it sees next, in the middle of an episode under disturbances."""
    env = envs.make(env_name, disturbances="server")
    agent = build_agent(name, env.env_info, **kwargs)
    observation = env.reset(seed=3)
    agent.episode_start()
    _, observation = play_on(agent, env, observation, BEFORE)
    return agent, env, observation


def play_on(agent: Any, env: Any, observation: Any, steps: int = AFTER) -> tuple[bytes, Any]:
    """The bits of the next actions, and what is seen after them; in a game the opponent stands still."""
    actions = []
    half = observation.size // env.n_players
    other = HoldAgent(env.env_info, 2) if env.n_players == 2 else None
    for _ in range(steps):
        actions.append(np.asarray(agent.draw_action(observation[:half].copy())))
        pair = (actions[-1], other.draw_action(observation[half:])) if other is not None else actions[-1]
        observation, _, over, _ = env.step(pair)
        if over:
            break
    return np.array(actions).tobytes(), observation


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("name", "env_name"), PLAYED)
def test_every_copy_has_the_same_future_and_disturbs_nobody(name: str, env_name: str) -> None:
    agent, env, observation = mid_episode(name, env_name)
    untouched, its_env, its_observation = mid_episode(name, env_name)
    assert its_observation.tobytes() == observation.tobytes()
    expected, _ = play_on(untouched, its_env, its_observation)
    for how, way in WAYS.items():
        assert play_on(way(agent), env.copy(), observation.copy())[0] == expected, how
    assert play_on(agent, env, observation)[0] == expected


@pytest.mark.parametrize(
    "settings", [("control.solver=osqp",), ("control.solver=daqp",), ("control.kinematics=pinocchio",)]
)
def test_other_solvers_and_kinematics_are_copied_too(settings: tuple[str, ...]) -> None:
    pytest.importorskip({"osqp": "osqp", "daqp": "daqp"}.get(settings[0].rpartition("=")[2], "pinocchio"))
    agent, env, observation = mid_episode("thesis", "7dof-defend", settings=settings)
    futures = {how: play_on(way(agent), env.copy(), observation.copy(), 10)[0] for how, way in WAYS.items()}
    futures["original"] = play_on(agent, env, observation, 10)[0]
    assert len(set(futures.values())) == 1, {how: hash(future) for how, future in futures.items()}


def test_a_copy_plays_on_in_another_process(tmp_path: Path) -> None:
    agent, env, observation = mid_episode("thesis-final", "7dof-defend")
    (tmp_path / "all").write_bytes(pickle.dumps((agent, env, observation)))
    program = (
        "import pickle, sys; from pathlib import Path; agent, env, seen = pickle.loads(Path(sys.argv[1]).read_bytes())\n"
        "for _ in range(10):\n    action = agent.draw_action(seen); print(action.tobytes().hex()); seen, *_ = env.step(action)"
    )
    done = subprocess.run([sys.executable, "-c", program, str(tmp_path / "all")], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "".join(done.stdout.split()) == play_on(agent, env, observation, 10)[0].hex()


def test_what_cannot_be_copied_says_so(submission: Callable[..., str], tmp_path: Path) -> None:
    env = envs.make("3dof-hit")
    isolated = build_handle(submission(), env, mode="process")
    folder = begin(Options(environments=("3dof-hit",), agent="hold", episodes=1), tmp_path / "run")
    seat = Seat(isolated, env.formats[0], Care())
    holders = (seat, Rollout(env, [seat], 0), Watch(), Threads(1), Hand())
    try:
        for held in (isolated, isolated._memory, folder, *holders):
            for how in (copy.copy, copy.deepcopy, pickle.dumps, cloudpickle.dumps):
                with pytest.raises(TypeError, match=f"{type(held).__name__} cannot be copied or pickled"):
                    how(held)
        isolated.episode_start()
        assert np.asarray(isolated.act(env.reset(seed=0))).shape == (2, 3)
    finally:
        isolated.close()
        folder.close()

"""An agent that plans beside its steps is noticed, and given the time that the robot would give it."""

import functools
import time
from pathlib import Path

import numpy as np
import pytest
from submission_examples import ZOO

from airhockey import envs
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.pacing import pace_for, starts_anything
from airhockey.evaluator.play.build_seats import Entrant, build_seats
from airhockey.evaluator.play.rollout import Rollout
from airhockey.evaluator.play.seat import Care
from submissions import make_submission

THREAD = """
    import threading
    def think():
        while True:
            ends = time.monotonic() + 0.004
            while time.monotonic() < ends: pass
            time.sleep(0.004)
    threading.Thread(target=think, daemon=True).start()
"""
CHILD = THREAD.replace("import threading", "import multiprocessing").replace(
    "threading.Thread(target=think, daemon=True)",
    'multiprocessing.get_context("fork").Process(target=think, daemon=True)',
)


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("building", "pace"), [(THREAD, 1.0), (CHILD, 1.0), ("pass", 0.0), ("import threading", 0.0)])
def test_one_that_thinks_between_calls_is_noticed(tmp_path: Path, building: str, pace: float) -> None:
    agent = make_submission(tmp_path, building=building.strip())
    assert pace_for(agent, "3dof-defend", "process") == pace


def test_nobody_else_is_tried_out(tmp_path: Path) -> None:
    assert not starts_anything(Path(make_submission(tmp_path)))
    assert starts_anything(ZOO / "threaded_planner") and starts_anything(ZOO / "spawned_planner")
    for agent in ("planner", "tcp://127.0.0.1:9"):
        began = time.perf_counter()
        assert pace_for(agent, "7dof-hit") == 0.0
        assert time.perf_counter() - began < 1.0


@pytest.mark.parametrize("factor", [1.0, 2.0])
def test_paced_steps_take_the_robots_time(factor: float) -> None:
    env, seats = build_seats(functools.partial(envs.make, "3dof-defend"), [Entrant("hold")], Care())
    rollout = Rollout(env, seats, seed=1, real_time=factor)
    rollout.begin()
    began = time.perf_counter()
    for _ in range(25):
        rollout.step()
    assert time.perf_counter() - began >= 0.5 / factor - 0.001


def test_a_plan_made_in_a_thread_comes_in_time_when_paced() -> None:
    pytest.importorskip("mushroom_rl")
    moved = []
    for factor in (0.0, 1.0):
        entrant = Entrant(str(ZOO / "threaded_planner"), isolate="process", limits=Limits(start=300.0))
        env, seats = build_seats(functools.partial(envs.make, "7dof-defend"), [entrant], Care())
        rollout = Rollout(env, seats, seed=1, real_time=factor)
        start = rollout.begin()[6:13].copy()
        for _ in range(40):
            assert rollout.step()
            if factor == 0.0 and rollout.steps == 1:
                first = rollout.seats[0].action[0].copy()
        moved.append(np.abs(rollout.seats[0].action[0] - start).max())
        seats[0].close()
    assert np.allclose(first, start, atol=1e-9)
    assert moved[1] > 1e-3

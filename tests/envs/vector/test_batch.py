"""A batch's moments, its caller's arrays, its complaints."""

import contextlib
import copy
import itertools
import pickle

import gymnasium
import numpy as np
import pytest
from arms import standing

from airhockey import envs
from airhockey.errors import ActionError, ConfigurationError
from airhockey.learning.envs.batch import LearningBatch
from airhockey.learning.envs.game import GameBatch


def still(vec):
    return np.array([standing(vec.single)] * vec.num_envs)


@pytest.mark.parametrize("name", ["7dof-defend", "tournament"])
def test_a_saved_moment_has_the_same_future_in_another_batch(name):
    vec, other = (envs.make_vec(name, 2, seed=seed, disturbances="harsh") for seed in (1, 7))
    for _ in range(20):
        vec.step(still(vec))
    saved = vec.get_state()
    future = [[part.tobytes() for part in vec.step(still(vec))] for _ in range(30)]
    for again in (other, vec):
        again.set_state(saved)
        assert [[part.tobytes() for part in again.step(still(vec))] for _ in range(30)] == future


def test_an_environment_to_look_at_is_a_copy_with_the_same_future():
    vec = envs.make_vec("7dof-hit", 2, seed=3, disturbances="harsh")
    for _ in range(10):
        vec.step(still(vec))
    one = vec.environment(1)
    assert one.step_count == 10
    for _ in range(20):
        alone, batch = one.step(standing(one))[0], vec.step(still(vec))
        assert alone.tobytes() == batch.observations[1].tobytes()


def test_the_callers_arrays_are_written_into_and_no_others():
    vec = envs.make_vec("3dof-hit", 2, seed=0)
    mine, kept = vec.new_batch(), vec.step(still(vec))
    before = [part.copy() for part in kept]
    assert vec.step(still(vec), mine) is mine
    assert mine.observations.any()
    assert all(np.array_equal(a, b) for a, b in zip(before, kept, strict=True))


def test_only_some_are_reset():
    vec = envs.make_vec("3dof-defend", 3, seed=0)
    moved = vec.step(still(vec)).observations
    batch = vec.reset(seed=40, into=vec.step(still(vec)), which=np.array([False, True, False]))
    assert batch.observations[1].tobytes() == envs.make("3dof-defend").reset(seed=41).tobytes()
    assert not np.array_equal(batch.observations[0], moved[0])


def test_what_is_not_finite_or_of_the_wrong_shape_is_refused():
    vec = envs.make_vec("3dof-hit", 2, seed=0)
    with pytest.raises(ActionError, match=r"shape \(2, 3\).*\(2, 2, 3\)"):
        vec.step(np.zeros((2, 3)))
    broken = still(vec)
    broken[1, 0, 0] = np.nan
    with pytest.raises(ActionError, match=r"environment 1.*not finite"):
        vec.step(broken)


@pytest.mark.parametrize(("given", "message"), [
    ({"num_envs": 0}, "0 environments"), ({"threads": 0}, "0 threads"), ({"seed": [1]}, "1 seeds for 2"),
    ({"interpolation_order": (3, 3)}, "one interpolation order"),
])  # fmt: skip
def test_what_makes_no_batch_is_refused(given, message):
    with pytest.raises(ConfigurationError, match=message):
        envs.make_vec("3dof-hit", **{"num_envs": 2} | given)


def test_a_failure_in_a_thread_is_raised_where_it_was_asked_for():
    from airhockey.envs.vector.threads import Threads

    threads = Threads(2)
    import threading

    def fail():
        if threading.current_thread() is not threading.main_thread():
            raise ValueError("in the other")

    with pytest.raises(ValueError, match="in the other"):
        threads.run(fail)
    done = []
    threads.run(lambda: done.append(1))
    assert done == [1, 1]
    threads.close()


def test_no_more_threads_are_started_than_there_are_environments():
    from airhockey.envs.vector.threads import Threads

    assert (Threads(4, most=1).count, Threads(2, most=8).count) == (1, 2)


@pytest.mark.sampled(6)
@pytest.mark.parametrize("way", [copy.deepcopy, copy.copy, lambda batch: pickle.loads(pickle.dumps(batch))])
@pytest.mark.parametrize(
    "make",
    [
        lambda: envs.make_vec("tournament", 2, disturbances="harsh"),
        lambda: LearningBatch("7dof-defend", 3, disturbances="server", threads=2),
        lambda: GameBatch(2, opponents=["hold"]),
        lambda: gymnasium.make_vec("airhockey.envs.gymnasium:airhockey/7dof-defend-v0", num_envs=2).unwrapped,
    ],
)
def test_a_copied_batch_has_the_same_future_and_disturbs_nobody(make, way):
    batch, random = make(), np.random.default_rng(0)
    batch.reset(seed=1)
    shape = getattr(batch, "action_shape", None) or batch.action_space.shape[1:]
    actions = random.normal(0.0, 0.3, (60, batch.num_envs, *shape)).astype(np.float32)
    for action in actions[:10]:
        batch.step(action)
    twin = way(batch)
    with contextlib.closing(batch), contextlib.closing(twin):
        futures = [[parts(one.step(action)) for action in actions[10:]] for one in (batch, twin)]
    assert all(np.array_equal(a, b) for a, b in zip(*map(itertools.chain.from_iterable, futures), strict=True))


def parts(step):
    """Observations, rewards and ends."""
    return [np.array(part) for part in (step[:4])]

"""A batch's moments, its caller's arrays, its complaints."""

import numpy as np
import pytest
from arms import standing

from airhockey import envs
from airhockey.errors import ActionError, ConfigurationError


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

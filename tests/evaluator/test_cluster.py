"""The Dask engine, on local workers: the same promises as the other engines."""

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import engine_functions
import pytest

from airhockey.errors import ConfigurationError
from airhockey.evaluator.engines import cluster
from airhockey.evaluator.engines.cluster import Cluster, engine_of
from airhockey.evaluator.engines.engine import InProcess
from airhockey.evaluator.engines.pool import JobFailed
from airhockey.evaluator.engines.processes import Processes


def results(function: Any, jobs: Any) -> dict[Any, Any]:
    return dict(Cluster("local:2").run(function, jobs))


def test_jobs_give_results_and_one_that_kills_its_workers_is_lost() -> None:
    lost = JobFailed("the worker process died 3 times over it")
    assert results(engine_functions.die_on_three, range(12)) == {n: n for n in range(12)} | {3: lost}


def test_what_the_function_raises_is_raised_here() -> None:
    with pytest.raises(ValueError, match="no 0"):
        results(engine_functions.fail, [0])


def test_the_function_is_built_once_per_worker_and_closed_at_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And no folder of the workers is left."""
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    function = engine_functions.Closing(str(tmp_path / "closed"))
    assert len(results(function, range(20))) == 20
    assert (tmp_path / "closed").read_text() == "closed"
    assert list(temporary.iterdir()) == []


def test_a_worker_unpacks_a_function_once_and_closes_the_one_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import pickle

    first, second = (pickle.dumps(engine_functions.Closing(str(tmp_path / name))) for name in ("first", "second"))
    versions = cluster.envs.versions()
    monkeypatch.setattr(cluster, "_built", {})
    assert [cluster._work("first", first, versions, job) for job in (1, 2)] == [1, 2]
    assert cluster._work("first", b"not unpacked again", versions, 3) == 3
    assert not (tmp_path / "first").exists()
    assert cluster._work("second", second, versions, 4) == 4
    assert (tmp_path / "first").exists()
    with pytest.raises(ConfigurationError, match="a worker has"):
        cluster._work("third", second, {**versions, "mujoco": "5.0.0"}, 5)


def test_which_engine() -> None:
    assert isinstance(engine_of(None, 1), InProcess)
    assert engine_of(None, 3) == Processes(3)
    assert engine_of(None, 1, isolated=True) == Processes(1)
    assert engine_of("local:2", 1) == Cluster("local:2")
    for wrong in ("local:", "local:0", "local:-1", "local:two", "local:²"):
        with pytest.raises(ConfigurationError, match="positive number"):
            engine_of(wrong, 1)


STRANGERS = """
import sys, distributed
for address in sys.argv[1:]:
    try:
        distributed.Client(address, timeout="2s")
    except (OSError, TypeError):
        print("refused")
"""


def test_a_local_cluster_takes_nobody_without_its_certificate() -> None:
    """Clients that were refused live in a process of their own: collected while another starts, they would stop it for ever."""
    pytest.importorskip("distributed")
    with cluster._connected(Cluster("local:1")) as client:
        address = client.scheduler.address
        assert address.startswith("tls://")
        strangers = [sys.executable, "-c", STRANGERS, address, address.replace("tls://", "tcp://")]
        done = subprocess.run(strangers, capture_output=True, text=True, timeout=120)
    assert done.stdout.split() == ["refused", "refused"], done.stderr

import subprocess
import sys
from pathlib import Path
from typing import Any

import engine_functions
import pytest

from airhockey.errors import AirHockeyError
from airhockey.evaluator.engines.engine import InProcess, engine_for
from airhockey.evaluator.engines.pool import JobFailed
from airhockey.evaluator.engines.processes import Processes


def results(engine: Any, function: Any, jobs: Any) -> dict[Any, Any]:
    return dict(engine.run(function, jobs))


@pytest.mark.parametrize("engine", [InProcess(), Processes(2)])
def test_every_job_gives_its_result(engine: Any) -> None:
    assert results(engine, engine_functions.square, range(20)) == {n: n * n for n in range(20)}
    assert results(engine, engine_functions.square, []) == {}


def test_one_job_at_a_time_is_played_here() -> None:
    assert isinstance(engine_for(1), InProcess)
    assert engine_for(3) == Processes(3)


def test_workers_are_single_threaded_and_leave_ctrl_c_to_the_parent() -> None:
    told = set(results(Processes(2), engine_functions.surroundings, range(50)).values())
    assert len({pid for pid, _, _ in told}) == 2
    assert {(threads, ignores) for _, threads, ignores in told} == {("1", True)}


def test_a_job_that_kills_its_workers_is_lost_and_the_others_are_not() -> None:
    lost = JobFailed("the worker process died 3 times over it (signal SIGKILL)")
    expected = {n: n for n in range(10)} | {3: lost}
    assert results(Processes(2), engine_functions.die_on_three, range(10)) == expected


def test_a_job_whose_worker_dies_once_is_tried_again(tmp_path: Path) -> None:
    jobs = [(n, str(tmp_path / "died")) for n in range(6)]
    assert results(Processes(2), engine_functions.die_once, jobs) == {job: job[0] for job in jobs}
    assert (tmp_path / "died").exists()


@pytest.mark.parametrize("engine", [InProcess(), Processes(1)])
def test_what_the_function_raises_is_raised_here(engine: Any) -> None:
    with pytest.raises(ValueError, match="no 0"):
        results(engine, engine_functions.fail, range(3))


@pytest.mark.parametrize("engine", [InProcess(), Processes(1)])
def test_the_function_is_closed_at_the_end(engine: Any, tmp_path: Path) -> None:
    results(engine, engine_functions.Closing(str(tmp_path / "closed")), range(3))
    assert (tmp_path / "closed").read_text() == "closed"


def test_workers_that_cannot_start_are_an_error_not_a_thousand_lost_jobs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("airhockey.evaluator.engines.workers.get_context", lambda _: _NoUnpickling())
    with pytest.raises(AirHockeyError, match="do not start"):
        results(Processes(1), engine_functions.square, range(1000))


def test_a_worker_that_dies_while_it_starts_costs_a_retry(monkeypatch: pytest.MonkeyPatch) -> None:
    context = _NoUnpickling(failures=2)
    monkeypatch.setattr("airhockey.evaluator.engines.workers.get_context", lambda _: context)
    assert results(Processes(2), engine_functions.square, range(5)) == {n: n * n for n in range(5)}
    assert context.failures <= 0


def test_nothing_is_imported_from_the_present_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("pickle", "threading", "numpy", "socket"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'mark')!r}, 'w')\nraise ImportError")
    monkeypatch.chdir(tmp_path)
    assert results(Processes(2), engine_functions.square, range(3)) == {0: 0, 1: 1, 2: 4}
    assert not (tmp_path / "mark").exists()


class _NoUnpickling:
    """A context whose first processes die before they say hello."""

    def __init__(self, failures: int = 1000) -> None:
        self.failures = failures
        import multiprocessing

        self._context = multiprocessing.get_context("spawn")
        self.Pipe = self._context.Pipe

    def Process(self, target: Any, args: Any, daemon: bool) -> Any:
        self.failures -= 1
        if self.failures < 0:
            return self._context.Process(target=target, args=args, daemon=daemon)
        return self._context.Process(target=exit, args=(5,), daemon=daemon)


SCRIPT = """
from pathlib import Path
from airhockey.evaluator import Options, Processes, begin, evaluate
options = Options(environments=("3dof-defend",), agent="hold", episodes=2)
{guard}print(evaluate(begin(options, Path("run")), Processes(2)).episodes)
"""


@pytest.mark.parametrize(
    ("guard", "status"), [("", 1), pytest.param('if __name__ == "__main__": ', 0, marks=pytest.mark.long)]
)
def test_a_script_is_told_of_the_guard_that_it_lacks(tmp_path: Path, guard: str, status: int) -> None:
    (tmp_path / "mine.py").write_text(SCRIPT.format(guard=guard))
    done = subprocess.run([sys.executable, "mine.py"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == status, done.stderr
    if status:
        assert "mine.py' starts worker processes" in done.stderr and 'if __name__ == "__main__":' in done.stderr
    else:
        assert done.stdout == "2\n"

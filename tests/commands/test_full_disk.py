"""A disk that is full stops every writer in one line, with exit status 2; with room it goes on as if nothing had been."""

import contextlib
import resource
from collections.abc import Iterator
from pathlib import Path

import pytest
from command_line import Hockey
from outcomes import outcome

from airhockey.errors import AirHockeyError
from airhockey.evaluator.runs.game_records import GameRecord
from airhockey.evaluator.runs.journal import read_journal
from airhockey.reproduction.experiments import quick
from airhockey.reproduction.folder import PAGE, ReproductionFolder
from airhockey.reproduction.page import write_page
from submissions import make_submission


@contextlib.contextmanager
def no_file_larger_than(size: int) -> Iterator[None]:
    """What the operating system says then ends a write in the middle, as a full disk does."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def stopped(hockey: Hockey, line: str, size: int) -> str:
    """What a command says that had no room."""
    with no_file_larger_than(size):
        status, out, err = hockey(line)
    assert (status, out) == (2, ""), err
    assert err.count("\n") == 1 and "cannot write" in err and "File too large" in err
    assert not list(Path.cwd().rglob("*.part*"))
    return err


@pytest.mark.sampled(2)
@pytest.mark.parametrize("size", [2500, 20_000])
def test_a_run(hockey: Hockey, size: int) -> None:
    line = "evaluate --env 3dof-defend --agent hold --episodes 3 --jobs 1 --quiet"
    assert hockey(f"{line} --out whole")[0] == 0
    assert "--resume" in stopped(hockey, f"{line} --out run", size)
    assert hockey("evaluate --resume --out run --quiet")[0] == 0
    assert outcome(Path("run")) == outcome(Path("whole"))


def test_the_official_files(hockey: Hockey) -> None:
    line = "evaluate --env 3dof-defend --agent hold --episodes 3 --jobs 1 --quiet --official-dataset"
    assert hockey(f"{line} --out whole")[0] == 0
    dataset = Path("whole/official/3dof-defend/dataset.pkl")
    stopped(hockey, f"{line} --out run", dataset.stat().st_size - 1)
    assert hockey("evaluate --resume --out run --quiet --official-dataset")[0] == 0
    for file in dataset.parent.iterdir():
        again = Path("run", *file.parts[1:])
        assert again.stat().st_size == file.stat().st_size and (
            file.name == "computation_time.npy" or again.read_bytes() == file.read_bytes()
        )


@pytest.mark.sampled(2)
@pytest.mark.parametrize("size", [1900, 9000])
def test_a_match(hockey: Hockey, size: int) -> None:
    line = "match hold hold --steps 400 --jobs 1 --quiet"
    stopped(hockey, f"{line} --out match", size)
    assert read_journal(Path("match"), GameRecord).records == []
    assert hockey("match --resume --out match --quiet")[0] == 0
    assert len(read_journal(Path("match"), GameRecord).records) == 1


@pytest.mark.long
def test_a_training_by_pgpe(hockey: Hockey) -> None:
    size = "--iterations 9 --episodes 1 --candidates 4 --jobs 1 --quiet"
    line = f"train pgpe --task hit --robot 3dof {size}"
    assert hockey(f"{line} --out whole")[0] == 0
    journal, manifest = (Path("whole", name).stat().st_size for name in ("journal.jsonl", "train.json"))
    assert journal > manifest + 100
    with no_file_larger_than(journal - 50):
        status, _, err = hockey(f"{line} --out run")
    assert status == 2 and "make room and go on with --resume" in err and err.count("\n") == 1
    assert hockey("train pgpe --resume --out run --quiet")[0] == 0
    assert Path("run/parameters.yaml").read_text() == Path("whole/parameters.yaml").read_text()


@pytest.mark.long
def test_a_training_by_sac(hockey: Hockey) -> None:
    pytest.importorskip("stable_baselines3")
    line = "train sac --task home --robot 3dof --steps 60 --warm-up 20 --episodes 1 --quiet"
    stopped(hockey, f"{line} --out run", 60_000)
    assert hockey("train sac --resume --out run --quiet")[0] == 0
    assert Path("run/network.npz").exists()


def test_an_archive_a_page_and_a_film(hockey: Hockey, tmp_path: Path) -> None:
    agent = make_submission(tmp_path)
    Path(agent, "submission.yaml").write_text("name: mine\nversion: 0.1.0\ntasks: [3dof-hit]\n")
    hockey("evaluate --env 3dof-defend --agent hold --episodes 1 --jobs 1 --quiet --out run")
    before = sorted(Path.cwd().rglob("*"))
    with no_file_larger_than(300):
        for line in (f"package {agent}", "report run -o page.html --quiet"):
            status, _, err = hockey(line)
            assert status == 2 and err.count("\n") == 1 and "cannot write" in err
    assert sorted(Path.cwd().rglob("*")) == before


def test_the_page_of_a_reproduction(tmp_path: Path) -> None:
    with ReproductionFolder.begin(quick(0), tmp_path / "run") as folder:
        with no_file_larger_than(1900), pytest.raises(AirHockeyError, match="cannot write"):
            write_page(folder)
        assert not list(tmp_path.rglob("*.html")) and not list(tmp_path.rglob("*.part*"))
        write_page(folder)
        assert "17 experiments" in (folder.path / PAGE).read_text(encoding="utf-8")

"""Contents, known by their hashes."""

import hashlib
import os
from pathlib import Path

import pytest

from airhockey.errors import ConfigurationError
from airhockey.inputs.hashing import content_hash


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    place = tmp_path / "agent"
    (place / "parts").mkdir(parents=True)
    (place / "agent_builder.py").write_text("x = 1\n")
    (place / "parts" / "weights.bin").write_bytes(bytes(100))
    return place


def test_a_files_hash_is_its_sha256(folder: Path) -> None:
    file = folder / "agent_builder.py"
    assert content_hash(file) == hashlib.sha256(file.read_bytes()).hexdigest()


def test_a_folder_is_its_names_and_bytes_wherever_it_lies(folder: Path, tmp_path: Path) -> None:
    before = content_hash(folder)
    moved = folder.rename(tmp_path / "elsewhere")
    assert content_hash(moved) == before
    for name in ("__pycache__", ".git", "runs", "agent.egg-info"):
        (moved / name).mkdir()
        (moved / name / "more").write_text("x")
    (moved / "result").mkdir()
    (moved / "result" / "run.json").write_text("{}")
    (moved / "result" / "journal.jsonl").write_text("{}")
    assert content_hash(moved) == before


@pytest.mark.parametrize("name", ["build", "dist", "runs", "x.pyo", "x.egg-info", ".git", "run.json", "train.json"])
def test_a_file_counts_whatever_it_is_called(folder: Path, name: str) -> None:
    seen = {content_hash(folder)}
    for content in ("1", "2"):
        (folder / name).write_text(content)
        seen.add(content_hash(folder))
        (folder / "parts" / name).write_text(content)
        if name != "run.json":  # the folder is then a run's, and is not shown to a sandbox either
            seen.add(content_hash(folder))
    assert len(seen) == (3 if name == "run.json" else 5)


def test_what_was_learned_counts(folder: Path) -> None:
    """The folder of a training is an agent, or part of one."""
    (folder / "train.json").write_text("{}")
    (folder / "parts" / "train.json").write_text("{}")
    before = content_hash(folder)
    (folder / "parts" / "weights.bin").write_bytes(bytes(99))
    assert content_hash(folder) != before


@pytest.mark.parametrize("name", ["build", ".venv", "__pycache__", "data"])
def test_a_link_is_refused_whatever_it_is_called(folder: Path, name: str) -> None:
    (folder / name).symlink_to("/usr/lib")
    with pytest.raises(ConfigurationError, match=rf"{name}' is a link"):
        content_hash(folder)


def test_every_change_shows(folder: Path) -> None:
    seen = {content_hash(folder)}
    (folder / "agent_builder.py").write_text("x = 2\n")
    seen.add(content_hash(folder))
    (folder / "parts" / "weights.bin").rename(folder / "weights.bin")
    seen.add(content_hash(folder))
    (folder / "empty.txt").touch()
    seen.add(content_hash(folder))
    (folder / "parts" / "empty.txt").touch()
    seen.add(content_hash(folder))
    assert len(seen) == 5


def test_links_and_pipes_are_refused_by_name(folder: Path) -> None:
    (folder / "parts" / "borrowed.bin").symlink_to("/etc/passwd")
    with pytest.raises(ConfigurationError, match=r"borrowed.bin' is a link"):
        content_hash(folder)
    (folder / "parts" / "borrowed.bin").unlink()
    os.mkfifo(folder / "pipe")
    with pytest.raises(ConfigurationError, match=r"pipe' is neither"):
        content_hash(folder)
    with pytest.raises(ConfigurationError, match="No such file"):
        content_hash(folder / "missing")


def test_a_module_without_source_counts(tmp_path: Path) -> None:
    """Python imports it as it does any other."""
    (tmp_path / "agent_builder.py").write_text("import hidden")
    (tmp_path / "hidden.pyc").write_bytes(b"one")
    before = content_hash(tmp_path)
    (tmp_path / "hidden.pyc").write_bytes(b"two")
    assert content_hash(tmp_path) != before


def test_a_file_larger_than_any_disk_is_refused(tmp_path: Path) -> None:
    (tmp_path / "weights.bin").touch()
    os.truncate(tmp_path / "weights.bin", 9 << 30)
    with pytest.raises(ConfigurationError, match="holds more than 8 GiB"):
        content_hash(tmp_path)

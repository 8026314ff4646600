"""From a folder to an archive and back: reproducible, tamper-evident, and safe to open."""

import io
import os
import shutil
import stat
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from submission_examples import SUBMISSIONS

from airhockey.agents.packaging import archive as archives
from airhockey.agents.packaging.archive import opened, unpack
from airhockey.agents.packaging.manifest import MANIFEST
from airhockey.agents.packaging.metadata import read_metadata, read_yaml
from airhockey.agents.packaging.packing import pack
from airhockey.agents.packaging.template_folder import make
from airhockey.agents.submission import submission_config, submission_folder, wanted_order
from airhockey.errors import ConfigurationError


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    make(tmp_path / "my_agent")
    return tmp_path / "my_agent"


def test_a_new_submission_is_the_template_under_its_own_name(folder: Path) -> None:
    assert submission_folder(folder) == folder / "air_hockey_agent"
    metadata = read_metadata(folder)
    assert metadata is not None and metadata.name == "my_agent" and wanted_order(folder) == 3
    for file in ("agent_builder.py", "agent_config.yml"):
        there = SUBMISSIONS / "template" / "air_hockey_agent" / file
        assert there.read_bytes() == (folder / "air_hockey_agent" / file).read_bytes()
    with pytest.raises(ConfigurationError, match="there already"):
        make(folder)


def test_packing_on_two_days_under_two_umasks_gives_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    first = pack(folder, tmp_path / "first.zip")
    other = tmp_path / "elsewhere"
    before = os.umask(0o077)
    try:
        shutil.copytree(folder, other, copy_function=shutil.copyfile)
        for path in other.rglob("*"):
            path.chmod(0o700)
            os.utime(path, (1e9, 1e9))
        second = pack(other, tmp_path / "second.zip")
    finally:
        os.umask(before)
    assert first.path.read_bytes() == second.path.read_bytes()
    assert first.sha256 == second.sha256


def test_what_is_left_out_is_said(folder: Path, tmp_path: Path) -> None:
    (folder / ".git").mkdir()
    (folder / ".git" / "config").write_text("x")
    (folder / "air_hockey_agent" / "__pycache__").mkdir()
    (folder / "weights").symlink_to("/etc/passwd")
    packed = pack(folder, tmp_path / "a.zip")
    assert packed.left_out == {
        ".git": "hidden",
        "air_hockey_agent/__pycache__": "made by tools, not by you",
        "weights": "a link: its target may not be there elsewhere",
    }
    assert not any("weights" in name for name in packed.manifest.files)


def test_an_archive_opens_to_what_was_packed(folder: Path, tmp_path: Path) -> None:
    inside = opened(pack(folder, tmp_path / "a.zip").path)
    names = {path.relative_to(folder) for path in folder.rglob("*") if path.is_file()}
    assert {path.relative_to(inside) for path in inside.rglob("*") if path.is_file()} == names | {Path(MANIFEST)}
    assert submission_config(tmp_path / "a.zip")["gain"] == 1.5


def test_every_changed_byte_is_refused(folder: Path, tmp_path: Path) -> None:
    data = pack(folder, tmp_path / "a.zip").path.read_bytes()
    for k, position in enumerate(range(0, len(data), 37)):
        changed = bytearray(data)
        changed[position] ^= 0x20
        (tmp_path / "b.zip").write_bytes(changed)
        target = tmp_path / f"out{k}"
        target.mkdir()
        with pytest.raises(ConfigurationError, match=r"b\.zip"):
            unpack(tmp_path / "b.zip", target)


def test_a_changed_file_is_refused_by_name(folder: Path, tmp_path: Path) -> None:
    data = pack(folder, tmp_path / "a.zip").path.read_bytes()
    (tmp_path / "b.zip").write_bytes(data.replace(b"gain: 1.5", b"gain: 9.5"))
    with pytest.raises(ConfigurationError, match=r"agent_config\.yml"):  # by its checksum
        opened(tmp_path / "b.zip")
    with zipfile.ZipFile(tmp_path / "a.zip") as old, zipfile.ZipFile(tmp_path / "c.zip", "w") as new:
        for entry in old.infolist():
            new.writestr(entry, old.read(entry).replace(b"gain: 1.5", b"gain: 9.5"))
    with pytest.raises(ConfigurationError, match=r"agent_config.yml.*hash differs"):
        opened(tmp_path / "c.zip")
    with zipfile.ZipFile(tmp_path / "a.zip", "a") as new:
        new.writestr("extra.py", "")
    with pytest.raises(ConfigurationError, match=r"extra.py.*added later"):
        opened(tmp_path / "a.zip")


def zipped(path: Path, *entries: tuple[str | zipfile.ZipInfo, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in entries:
            archive.writestr(name, data)
    return path


def link() -> zipfile.ZipInfo:
    entry = zipfile.ZipInfo("agent_builder.py")
    entry.create_system = 3
    entry.external_attr = (stat.S_IFLNK | 0o777) << 16
    return entry


@pytest.mark.parametrize(
    ("entry", "why"),
    [
        ("../outside.py", "climbs out"),
        ("a/../../outside.py", "climbs out"),
        ("/etc/cron.d/job", "absolute"),
        ("C:/windows/x", "Windows"),
        ("a\\..\\b", "Windows"),
        ("new\nline", "not UTF-8 text"),
        ("e\u0301.py", "decomposed"),
        ("\u202egpj.exe", "turn a line around"),
        ("agent\u200b.py", "nobody sees"),
        ("parts/aux.py", "a device"),
        ("agent.py:hidden", "a stream"),
        ("x" * 300, "longer than"),
        (link(), "a link"),
    ],
)
def test_an_archive_that_reaches_out_is_refused(tmp_path: Path, entry: str | zipfile.ZipInfo, why: str) -> None:
    bad = zipped(tmp_path / "bad.zip", (entry, b"/etc/passwd"))
    with pytest.raises(ConfigurationError, match=why):
        opened(bad)
    assert not (tmp_path.parent / "outside.py").exists()


def test_names_in_other_encodings_are_refused(tmp_path: Path) -> None:
    good = zipped(tmp_path / "good.zip", ("qqqq.py", b"x")).read_bytes()
    (tmp_path / "bad.zip").write_bytes(good.replace(b"qqqq.py", "äöü".encode("latin-1") + b"q.py"))
    with pytest.raises(ConfigurationError, match="not UTF-8"):
        opened(tmp_path / "bad.zip")


def test_two_names_for_one_file_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="the same on some machines"):
        opened(zipped(tmp_path / "bad.zip", ("A.py", b""), ("a.py", b"")))


def test_a_zip_bomb_of_10_gb_is_refused_unopened(tmp_path: Path) -> None:
    bomb = tmp_path / "bomb.zip"
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for k in range(2):
            archive.writestr(f"zeros{k}", bytes(1 << 20))
    data = bomb.read_bytes()
    claim = (5 << 30).to_bytes(8, "little")[:4]  # what the directory says: 1 GiB in 32 bits of 5 GiB
    (tmp_path / "liar.zip").write_bytes(data.replace((1 << 20).to_bytes(4, "little"), claim))
    with pytest.raises(ConfigurationError, match="1073741824 are allowed"):
        opened(tmp_path / "liar.zip")


def test_a_bomb_that_lies_about_its_size_is_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(archives, "MAX_BYTES", 1 << 20)
    bomb = zipped(tmp_path / "bomb.zip", ("zeros", bytes(8 << 20))).read_bytes()
    small = (1000).to_bytes(4, "little")
    (tmp_path / "liar.zip").write_bytes(bomb.replace((8 << 20).to_bytes(4, "little"), small))
    with pytest.raises(ConfigurationError, match="refused"):
        opened(tmp_path / "liar.zip")
    with pytest.raises(ConfigurationError, match="8388608 bytes"):
        opened(tmp_path / "bomb.zip")


def test_what_is_no_archive_is_refused(tmp_path: Path) -> None:
    (tmp_path / "agent.tar.gz").write_bytes(io.BytesIO(b"\x1f\x8bnothing").getvalue())
    with pytest.raises(ConfigurationError, match="no zip file"):
        submission_folder(tmp_path / "agent.tar.gz")


@pytest.mark.parametrize(
    "text",
    [
        "x: !!python/object/apply:os.system ['true']",
        "a: &a [1]\nb: *a",
        "[1, 2]",
        "{" * 3000,
        "1: 2",
        "x: \x00",
    ],
)
def test_yaml_that_is_more_than_data_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "agent_config.yml").write_text(text)
    with pytest.raises(ConfigurationError):
        read_yaml(tmp_path / "agent_config.yml")


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (("name: my_agent", "name: ../x"), "not usable"),
        (("7dof-hit", "8dof-hit"), "Did you mean '7dof-hit'"),
        (("packages: []", "packages: ['scipy; rm -rf /']"), "not a package requirement"),
        (("interpolation_order: 3", "interpolation_order: 9"), "unknown interpolation order"),
        (("version:", "vision:"), "unknown field `vision`"),
    ],
)
def test_metadata_is_checked(folder: Path, change: tuple[str, str], why: str) -> None:
    file = folder / "submission.yaml"
    file.write_text(file.read_text().replace(*change))
    with pytest.raises(ConfigurationError, match=why):
        pack(folder, folder / "out.zip")


def test_names_that_differ_elsewhere_are_not_packed(folder: Path) -> None:
    (folder / "Readme.MD").write_text("")
    with pytest.raises(ConfigurationError, match="the same on some machines"):
        pack(folder, folder / "out.zip")


def test_a_name_that_is_not_utf8_is_not_packed(folder: Path) -> None:
    (folder / os.fsdecode(b"caf\xe9.txt")).write_text("")
    with pytest.raises(ConfigurationError, match="not UTF-8 text"):
        pack(folder, folder / "out.zip")


def test_two_submissions_in_one_process_keep_their_modules_apart(submission_with: Callable[[str], Path]) -> None:
    from airhockey.agents import build_agent

    agents = [build_agent(submission_with(word), {}) for word in ("one", "two")]
    assert [agent.word for agent in agents] == ["one", "two"]


@pytest.fixture
def submission_with(tmp_path: Path) -> Callable[[str], Path]:
    def write(word: str) -> Path:
        folder = tmp_path / word / "air_hockey_agent"
        folder.mkdir(parents=True)
        (folder / "neighbour.py").write_text(f"WORD = {word!r}")
        (folder / "agent_builder.py").write_text(
            "import neighbour\nfrom . import neighbour as same\nimport air_hockey_agent.neighbour\n"
            "class Agent:\n    word = neighbour.WORD\n    assert word == same.WORD == air_hockey_agent.neighbour.WORD\n"
            "    draw_action = None.__class__\n"
            "def build_agent(env_info, **kwargs):\n    return Agent()\n"
        )
        return tmp_path / word

    return write


@pytest.mark.parametrize("name", ["submission.yaml", "agent_config.yml"])
def test_a_folder_or_a_pipe_in_a_files_place_is_refused(folder: Path, name: str) -> None:
    """Neither is passed over as if nothing were there, nor waited for."""
    place = submission_folder(folder) / name
    place.unlink(missing_ok=True)
    for put_there in (os.mkdir, os.mkfifo):
        put_there(place)
        with pytest.raises(ConfigurationError, match="is no file"):
            read_metadata(place.parent) if name == "submission.yaml" else submission_config(folder)
        place.rmdir() if place.is_dir() else place.unlink()

"""What an installation brings: one top-level package, with every module and asset in it."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from sources import copy_sources

ROOT = Path(__file__).parent.parent
BUILD = "from setuptools import build_meta; build_meta.build_wheel('dist')"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    """The wheel of a copy of the project, links at its root included."""
    copy = tmp_path_factory.mktemp("project") / "airhockey"
    copy_sources(ROOT, copy)
    subprocess.run([sys.executable, "-c", BUILD], cwd=copy, check=True, capture_output=True)
    return zipfile.ZipFile(next((copy / "dist").glob("*.whl")))


def test_its_only_top_level_is_airhockey(wheel: zipfile.ZipFile) -> None:
    tops = {name.split("/")[0] for name in wheel.namelist()}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"airhockey"}


def test_every_module_and_asset_is_in_it(wheel: zipfile.ZipFile) -> None:
    files = {path.relative_to(ROOT).as_posix() for path in (ROOT / "airhockey").rglob("*") if path.is_file()}
    expected = {name for name in files if "__pycache__" not in name}
    assert len(expected) > 50
    assert expected == {name for name in wheel.namelist() if name.startswith("airhockey/")}


def test_it_installs_the_command_and_its_licence(wheel: zipfile.ZipFile) -> None:
    info = next(name.split("/")[0] for name in wheel.namelist() if ".dist-info/" in name)
    assert "hockey = airhockey.cli:main" in wheel.read(f"{info}/entry_points.txt").decode()
    assert any(name.startswith(info) and name.endswith("LICENSE") for name in wheel.namelist())


@pytest.mark.parametrize("name", ["agents", "envs", "evaluator"])
def test_the_roots_links_lead_into_the_package(name: str) -> None:
    link = ROOT / name
    assert link.is_symlink()
    assert link.readlink() == Path("airhockey") / name
    assert (link / "__init__.py").samefile(ROOT / "airhockey" / name / "__init__.py")


def test_the_launcher_at_the_root_is_the_command() -> None:
    told = subprocess.run([sys.executable, ROOT / "cli.py", "--version"], capture_output=True, text=True, check=True)
    assert told.stdout.startswith("hockey, version ")

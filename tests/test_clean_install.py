"""Installed beside what the official package pins (NumPy 1.24.4): the wheel plays there, and keeps under its size.

It fetches packages and compiles every player from nothing, so it runs where CLEAN_INSTALL=1 asks for it (`make
compatibility`); what needs no other environment, the stand-in of the official package with our players, always does.
"""

import os
import subprocess
import sys
import venv
from pathlib import Path

import pytest
from sources import copy_sources
from submission_examples import SUBMISSIONS

ROOT = Path(__file__).parent.parent
STAND_IN = ROOT / "tests" / "support" / "official_stand_in.py"
RECORDINGS = ROOT / "tests" / "data" / "recordings"
LARGEST = 500  # [MB] of the core, with everything that it brings
OFFICIAL_NUMPY, OFFICIAL_MUSHROOM = "1.24.4", "1.10.2"
asked_for = pytest.mark.skipif(
    "CLEAN_INSTALL" not in os.environ or sys.version_info >= (3, 12),
    reason=f"installs from a registry: set CLEAN_INSTALL=1; NumPy {OFFICIAL_NUMPY} has no wheel for Python 3.12",
)
GAMES = [("thesis", "7dof-defend_rims_o3_s1.npz", "7dof-defend"), ("thesis", "3dof-hit_strike_o3_s1.npz", "3dof-hit")]


@pytest.mark.parametrize(("name", "recording", "env"), GAMES)
def test_ours_play_in_a_stand_in_of_the_official_package(name: str, recording: str, env: str) -> None:
    command = [sys.executable, STAND_IN, SUBMISSIONS / name, RECORDINGS / recording, env]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "played 20 steps" in done.stdout


@pytest.fixture(scope="module")
def clean(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A fresh environment with the wheel and the official NumPy; gives its folder of executables."""
    place = tmp_path_factory.mktemp("clean")
    source = place / "source"
    copy_sources(ROOT, source)
    build = "from setuptools import build_meta; build_meta.build_wheel('dist')"
    subprocess.run([sys.executable, "-c", build], cwd=source, check=True, capture_output=True)
    (wheel,) = (source / "dist").glob("*.whl")
    venv.create(place / "env", with_pip=True)
    pip = [place / "env" / "bin" / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, f"numpy=={OFFICIAL_NUMPY}", wheel], check=True)
    return place / "env" / "bin"


@asked_for
def test_it_leaves_the_official_numpy_alone_and_is_small(clean: Path) -> None:
    ask = "import numpy, sysconfig; print(numpy.__version__); print(sysconfig.get_path('purelib'))"
    told = subprocess.run([clean / "python", "-c", ask], capture_output=True, text=True, check=True).stdout.split()
    assert told[0] == OFFICIAL_NUMPY
    size = sum(path.stat().st_size for path in Path(told[1]).rglob("*") if path.is_file() and not path.is_symlink())
    assert size < LARGEST * 1e6
    for name in ("pinocchio", "osqp", "daqp", "torch", "mushroom_rl"):
        assert not list(Path(told[1]).glob(f"{name}*"))


@asked_for
@pytest.mark.parametrize(("name", "recording", "env"), GAMES)
def test_ours_play_there(clean: Path, name: str, recording: str, env: str) -> None:
    command = [clean / "python", STAND_IN, SUBMISSIONS / name, RECORDINGS / recording, env]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert f"NumPy {OFFICIAL_NUMPY}" in done.stdout


@asked_for
def test_the_evaluator_plays_there(clean: Path, tmp_path: Path) -> None:
    arguments = ["evaluate", "--agent", "thesis", "--env", "7dof-defend", "--episodes", "2", "--jobs", "1", "--quiet"]
    done = subprocess.run([clean / "hockey", *arguments], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert f"numpy {OFFICIAL_NUMPY}" in done.stdout


@pytest.fixture(scope="module")
def with_mushroom(clean: Path) -> Path:
    """The same with the official MushroomRL; without its dependencies, because it asks for gigabytes of a torch for GPUs."""
    pip = [clean / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    imported = ["torch", "opencv-python-headless<4.10", "pygame", "scikit-learn", "tqdm", "scipy", "matplotlib"]
    subprocess.run([*pip, f"numpy=={OFFICIAL_NUMPY}", *imported], check=True)
    subprocess.run([*pip, "--no-deps", f"mushroom-rl=={OFFICIAL_MUSHROOM}"], check=True)
    return clean


CORE = """
import numpy, mushroom_rl
from mushroom_rl.core import Core, Environment, MDPInfo
from airhockey.agents.build import build_agent
from airhockey.envs import AirHockeyChallengeWrapper

env = AirHockeyChallengeWrapper("7dof-defend")
assert isinstance(env, Environment) and isinstance(env.info, MDPInfo)
dataset = Core(build_agent("thesis", env.env_info), env).evaluate(n_steps=20, quiet=True)
print(f"{len(dataset)} steps with NumPy {numpy.__version__} and MushroomRL {mushroom_rl.__version__}")
"""


@asked_for
def test_ours_play_in_the_loop_of_the_official_mushroom(with_mushroom: Path, tmp_path: Path) -> None:
    done = subprocess.run([with_mushroom / "python", "-c", CORE], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert f"20 steps with NumPy {OFFICIAL_NUMPY} and MushroomRL {OFFICIAL_MUSHROOM}" in done.stdout

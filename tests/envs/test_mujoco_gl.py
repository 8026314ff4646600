"""What MUJOCO_GL says matters to whoever draws, and to nobody else; what a package cannot import is said as it is."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SIMULATE = "from airhockey import envs; env = envs.make('3dof-hit'); env.reset(seed=0); print('simulated')"
DRAW = "from airhockey.envs.rendering.offscreen import new_context; new_context(8, 8)"


def run(program: str, **environment: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", program]
    return subprocess.run(command, capture_output=True, text=True, env=os.environ | environment)


@pytest.mark.parametrize("value", ["garbage", "egl2", "../x", "WGL", "osmesa", "EGL ", "glx", "off"])
def test_any_value_simulates(value: str) -> None:
    done = run(SIMULATE, MUJOCO_GL=value)
    assert (done.returncode, done.stdout) == (0, "simulated\n"), done.stderr


def test_a_library_that_is_missing_stops_no_simulation(tmp_path: Path) -> None:
    (tmp_path / "sitecustomize.py").write_text(
        "import ctypes\nplain = ctypes.CDLL\n"
        "def cdll(name, *args, **kwargs):\n"
        "    if 'EGL' in str(name):\n        raise OSError(f'{name}: cannot open shared object file')\n"
        "    return plain(name, *args, **kwargs)\n"
        "ctypes.CDLL = cdll\n"
    )
    done = run(SIMULATE, MUJOCO_GL="egl", PYTHONPATH=str(tmp_path))
    assert (done.returncode, done.stdout) == (0, "simulated\n"), done.stderr


def test_whoever_draws_is_told_the_value() -> None:
    done = run(f"from airhockey import envs; envs.make; {DRAW}", MUJOCO_GL="garbage")
    assert done.returncode == 1 and "unknown value of MUJOCO_GL 'garbage'" in done.stderr


@pytest.mark.parametrize(
    "failure", ["AttributeError('no eglQueryString')", "ImportError('libGL.so.1')", "OSError('x.so')"]
)
def test_a_lazy_attribute_passes_on_the_real_error(tmp_path: Path, failure: str) -> None:
    (tmp_path / "mujoco.py").write_text(f"raise {failure}")
    done = run("from airhockey.envs import Environment", PYTHONPATH=str(tmp_path))
    assert done.returncode == 1
    assert failure.partition("'")[2].rstrip("')") in done.stderr.splitlines()[-1]
    nothing = run("import airhockey.envs; airhockey.envs.Enviroment")
    assert "module 'airhockey.envs' has no attribute 'Enviroment'" in nothing.stderr

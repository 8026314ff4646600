"""What libraries have dropped since 2023 means to a submission what it meant, and nothing else changes."""

import subprocess
import sys
from pathlib import Path

import pytest

from airhockey.compat.own_copy import look_at

NUMPY = """
import numpy as np
assert np.float is float and np.int is int and np.bool(1) and np.Inf == np.inf and np.isnan(np.NaN)
assert np.product([2, 3]) == 6 and np.alltrue([1]) and np.in1d([1, 2], [2]).tolist() == [False, True]
assert np.trapz([1.0, 2.0]) == 1.5 and np.asfarray([1]).dtype == np.float_
import collections; assert collections.Iterable is collections.abc.Iterable
"""
DATACLASSES = """
from dataclasses import dataclass, field, fields
import numpy as np
@dataclass
class Inner:
    gain: float = 1.0
@dataclass(frozen=True)
class Outer:
    limits: np.ndarray = np.zeros(3)
    inner: Inner = Inner()
    names: list = field(default_factory=list)
a, b = Outer(), Outer(limits=np.ones(3))
assert a.limits is Outer().limits is Outer.limits and a.inner.gain == 1.0 and b.limits.sum() == 3.0
assert [f.name for f in fields(Outer)] == ["limits", "inner", "names"] and Outer().names is not a.names
try:
    @dataclass
    class Wrong:
        names: list = []
except ValueError: pass
else: raise SystemExit("a list as a default was never allowed")
"""
# An archive whose storage says cuda:0, as torch wrote it on a machine with a GPU.
TORCH = """
import io, torch, zipfile
plain = io.BytesIO()
torch.save({"w": torch.arange(3.0), "net": torch.nn.Linear(2, 1)}, plain)
moved = io.BytesIO()
with zipfile.ZipFile(plain) as old, zipfile.ZipFile(moved, "w") as new:
    for entry in old.infolist():
        data = old.read(entry)
        if entry.filename.endswith("data.pkl"):
            assert data.count(b"X\\x03\\x00\\x00\\x00cpu") > 0
            data = data.replace(b"X\\x03\\x00\\x00\\x00cpu", b"X\\x06\\x00\\x00\\x00cuda:0")
        new.writestr(entry.filename, data)
moved.seek(0)
state = torch.load(moved)
assert state["w"].tolist() == [0.0, 1.0, 2.0] and state["w"].device.type == "cpu"
assert torch.load.__name__ == "load" and isinstance(state["net"], torch.nn.Linear)
"""


def run(code: str, first: str = "from airhockey.compat import bridges; bridges.install(); bridges.install()\n") -> str:
    done = subprocess.run([sys.executable, "-c", first + code], capture_output=True, text=True)
    return done.stderr


@pytest.mark.parametrize("code", [NUMPY, DATACLASSES], ids=["numpy", "dataclasses"])
def test_what_was_dropped_is_back(code: str) -> None:
    assert run(code) == ""
    assert "Error" in run(code, "")  # without the bridges there is none


@pytest.mark.parametrize(
    "before", [pytest.param("", marks=pytest.mark.long), "import torch\n"], ids=["torch later", "torch before"]
)
def test_weights_saved_on_a_gpu_load(before: str) -> None:
    pytest.importorskip("torch")
    assert run(TORCH, before + "from airhockey.compat import bridges; bridges.install()\n") == ""
    assert "CUDA" in run(TORCH.replace("torch.load(moved)", "torch.load(moved, weights_only=False)"), "")


def copy_of_the_package(place: Path) -> Path:
    """A copy with the interface of ours, as a fork has one."""
    for file, text in {
        "__init__.py": "",
        "framework/__init__.py": "from .agent_base import AgentBase\n",
        "framework/agent_base.py": (
            "class AgentBase:\n    def __init__(self, env_info, agent_id=1, **kwargs): pass\n"
            "    def reset(self): pass\n    def get_puck_pos(self, obs): pass\n"
        ),
        "utils/__init__.py": "from .kinematics import *\n",
        "utils/kinematics.py": 'def forward_kinematics(mj_model, mj_data, q, link="ee"): pass\n',
    }.items():
        (place / file).parent.mkdir(parents=True, exist_ok=True)
        (place / file).write_text(text)
    return place


def test_a_copy_that_says_nothing_new_is_not_used(tmp_path: Path) -> None:
    own = look_at(copy_of_the_package(tmp_path))
    assert own is not None and not own.wins and own.told() is None


KINEMATICS = """import mujoco
from air_hockey_challenge.utils.transformations import robot_to_world
def forward_kinematics(mj_model, mj_data, q, link="ee"): return "theirs"
def inverse_kinematics(mj_model, mj_data, desired_position, desired_rotation=None, initial_q=None, link="ee"): pass
def jacobian(mj_model, mj_data, q, link="ee"): pass
"""


@pytest.mark.parametrize(
    ("text", "used"),
    [
        (KINEMATICS, True),
        (KINEMATICS.replace("import mujoco", "import mujoco_py"), False),  # of its time, and not here
        (KINEMATICS.replace("utils.transformations", "utils.vectors"), False),
        (KINEMATICS.replace("def jacobian", "def _jacobian"), False),  # others import it
    ],
)
def test_what_agents_compute_with_is_the_copys_own(tmp_path: Path, text: str, used: bool) -> None:
    folder = copy_of_the_package(tmp_path)
    (folder / "utils" / "kinematics.py").write_text(text)
    own = look_at(folder)
    assert own is not None and not own.wins
    assert own.modules == (("utils/kinematics.py",) if used else ())
    assert ("computes with its own copy's utils/kinematics.py" in str(own.told())) == used


@pytest.mark.parametrize(
    ("file", "text", "said"),
    [
        ("framework/agent_base.py", "\n    def get_puck_history(self): pass\n", "AgentBase.get_puck_history"),
        ("utils/kinematics.py", "\ndef manipulability(q): pass\n", "utils.kinematics.manipulability"),
        ("utils/kinematics.py", "\ndef jacobian(m, d, q, link, frame): pass\n", "utils.kinematics.jacobian"),
        ("constraints/constraints.py", "class Constraint: pass\nclass Energy(Constraint): pass\n", "Energy"),
    ],
)
def test_a_copy_that_extends_what_agents_use_wins(tmp_path: Path, file: str, text: str, said: str) -> None:
    folder = copy_of_the_package(tmp_path)
    (folder / file).parent.mkdir(exist_ok=True)
    with (folder / file).open("a") as source:
        source.write(text)
    own = look_at(folder)
    assert own is not None and own.wins and said in str(own.told())


def test_a_module_that_ours_has_not_is_taken_from_it(tmp_path: Path) -> None:
    folder = copy_of_the_package(tmp_path)
    (folder / "utils" / "rewards.py").write_text("BONUS = 2\n")
    own = look_at(folder)
    assert own is not None and not own.wins and "utils/rewards.py" in str(own.told())

"""Modules of every standard name in the folder in which a command is called: none of them may be imported outside a sandbox."""

import contextlib
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import product
from cheats import trouble
from verdicts import ESCAPE, HELD, Verdict

KIND = "planted modules"
FOREIGN = (
    "numpy", "numba", "mujoco", "yaml", "msgspec", "h5py", "click", "rich", "rich_click", "torch", "distributed", "dask",
    "airhockey", "cma", "scipy", "pinocchio", "daqp", "osqp", "openskill", "matplotlib", "PIL", "av", "gymnasium",
    "sitecustomize", "usercustomize", "cloudpickle", "psutil", "tornado", "tblib", "llvmlite", "_distutils_hack",
)  # fmt: skip
PLANTED = """
import os, sys
try:
    with open({mark!r}, "a") as file:
        file.write("{name} in %d: %s\\n" % (os.getpid(), " ".join(sys.argv)))
except OSError:  # in a sandbox, where it may be imported: the entry's folder is on the path of its own process
    pass
_paths = list(sys.path)
sys.path[:] = [p for p in sys.path if p not in ("", os.getcwd(), os.path.dirname(os.path.abspath(__file__)))]
sys.modules.pop("{name}", None)
import {name} as _real
sys.modules["{name}"] = _real
sys.path[:] = _paths
"""
MATCH = ("match", "hold", "hold", "--steps", "60", "--quiet", "--out")
HOLD = ("evaluate", "--env", "3dof-hit", "--agent", "hold", "--episodes", "1", "--jobs", "1", "--quiet", "--out")
COMMANDS: dict[str, tuple[tuple[str, ...], ...]] = {
    "evaluate": (
        (
            "evaluate",
            "--env",
            "3dof-hit",
            "--agent",
            "hold",
            "--episodes",
            "2",
            "--jobs",
            "2",
            "--quiet",
            "--out",
            "run",
        ),
        ("evaluate", "--env", "3dof-hit", "--agent", ".", "--episodes", "2", "--jobs", "2", "--quiet", "--out", "run2"),
    ),
    "match": ((*MATCH, "game"), ("match", ".", "hold", "--steps", "30", "--quiet", "--out", "game2")),
    "tournament": (("tournament", "hold", "thesis", "--steps", "30", "--jobs", "2", "--quiet", "--out", "cup"),),
    "evaluate --cluster": (
        (
            *("evaluate", "--env", "3dof-hit", "--agent", "hold", "--episodes", "2"),
            *("--cluster", "local:2", "--quiet", "--out", "run3"),
        ),
    ),
    "validate": (("validate", ".", "--steps", "5"),),
    "package": (("package", "."),),
    "new": (("new", "another"),),
    "agents": (("agents",),),
    "report": ((*MATCH, "game"), ("report", "game", "-o", "report.html")),
    "leaderboard": ((*MATCH, "games/game"), ("leaderboard", "games")),
    "video": (
        (*MATCH, "game"),
        ("video", "game", "-o", "game.mp4", "--seconds", "0.5"),
        ("video", "game", "-o", "game.gif"),
    ),
    "train pgpe": (
        (
            *("train", "pgpe", "--task", "hit", "--robot", "3dof", "--iterations", "1", "--candidates", "2"),
            *("--episodes", "1", "--jobs", "2", "--quiet", "--out", "learned"),
        ),
        ("plot", "learned"),
    ),
    "failures": ((*HOLD, "run"), ("failures", "run")),
    "identify": ((*HOLD, "run"), ("identify", "run", "-o", "found.yaml")),
    "doctor": (("doctor",), ("--help",), ("--version",)),
    "train ppo": (
        (
            *(
                "train",
                "ppo",
                "--task",
                "3dof-hit",
                "--steps",
                "300",
                "--envs",
                "2",
                "--rollout",
                "64",
                "--batch",
                "64",
            ),
            *("--episodes", "1", "--threads", "1", "--quiet", "--out", "policy"),
        ),
        ("evaluate", "--env", "3dof-hit", "--agent", "policy", "--episodes", "1", "--quiet", "--out", "run"),
        ("plot", "policy"),
    ),
    "reproduce": (("reproduce", "thesis", "--quick", "--table", "5.1", "--jobs", "1", "--quiet", "--out", "page"),),
    "train sac": (
        ("train", "sac", "--task", "defend", "--robot", "3dof", "--steps", "60", "--quiet", "--out", "policy"),
    ),
}
SERVERS = {
    "play": ("play", "hold", "--no-browser"),
    "watch": ("watch", "hold", "--env", "3dof-hit", "--no-browser"),
    "serve-agent": ("serve-agent", ".", "--port", "0"),
    "replay": ("replay", "game", "--no-browser"),
}
"""Commands that do not end by themselves."""


def attack(sample: bool) -> Iterator[Verdict]:
    """Call every command in a folder full of planted modules."""
    for name in ("package",) if sample else product.wanted(COMMANDS):
        with _planted() as (place, mark):
            for command in COMMANDS[name]:
                done = place.hockey(*command)
                called = " ".join(command)
                yield trouble(KIND, called, done) or _judged(called, mark, product.last_line(done))
    for name in () if sample else product.wanted(SERVERS):
        with _planted() as (place, mark):
            place.hockey(*MATCH, "game")
            process = place.start(product.hockey(*SERVERS[name]))
            time.sleep(12.0)
            product.kill_all()
            err = process.communicate()[1].decode(errors="replace").strip()
            yield _judged(name, mark, err[-200:])


def _judged(name: str, mark: Path, detail: str) -> Verdict:
    if mark.exists():
        return Verdict(KIND, name, ESCAPE, mark.read_text().splitlines()[0][:200])
    return Verdict(KIND, name, HELD, detail)


@contextlib.contextmanager
def _planted() -> Iterator[tuple[product.Place, Path]]:
    """A place whose working folder is an entry with modules of all names, and the file in which they leave a mark."""
    with product.fresh_place() as place:
        mark = place.path.parent / "mark"
        done = place.hockey("new", "entry")
        assert done.status == 0, done.err
        place.path = place.path / "entry"
        for name in (*sys.stdlib_module_names, *FOREIGN):
            (place.path / f"{name}.py").write_text(PLANTED.format(mark=str(mark), name=name))
        yield place, mark

"""Attempts to get out of the sandbox, or to take more than is allowed in it."""

import contextlib
import ctypes
import itertools
import json
import os
import secrets
import shutil
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import product
from verdicts import ESCAPE, HANG, HELD, LEFTOVER, SKIPPED, TRACEBACK, Verdict

HERE = Path(__file__).parent
LIMITS = {
    "memory": 1536 << 20,
    "scratch": 16 << 20,
    "file": 4 << 20,
    "processes": 32,
    "start": 120.0,
    "patience": 60.0,
}
START = 900.0
"""Longest time for the first attempt, in [s]: its code is compiled."""
ALONE = (
    "signal_everybody",
    "take_memory_by_memfd",
    "take_memory_by_shared_maps",
    "take_memory_by_system_v",
    "take_memory_by_children",
    "take_memory_by_temporary_files",
    "fork_without_end",
    "start_threads_without_end",
    "leave_a_process_behind",
    "print_without_end",
    "make_files_without_end",
    "take_memory_by_sockets",
    "take_memory_by_tcp",
    "take_memory_by_extended_attributes",
    "make_links_and_folders_without_end",
    "take_memory_by_watches_on_files",
    "crash",
    "end_the_first_process",
    "fill_the_pipe_of_requests",
    "find_descriptors_that_were_left_open",
)
"""Attempts that each have a sandbox of their own: they do not end well."""
_SHOW = """
set -e
t=$(mktemp -d -p /var/tmp)
mount --bind "$2" "$t"
mount -t tmpfs -o mode=755 none "$1"
mkdir -p "$2"
mount --move "$t" "$2"
rmdir "$t"
shift 2
exec "$@"
"""
"""Shows the second folder to everybody, although the first around it is closed to others."""


def _as_somebody() -> list[str]:
    """What runs a command as a user who is nobody; the interpreter may lie in a home that is closed to him."""
    become = ["setpriv", "--reuid", "65534", "--regid", "65534", "--clear-groups"]
    interpreter = Path(sys.base_prefix)
    closed = [place for place in interpreter.parents if not place.stat().st_mode & 0o001]
    return (
        ["unshare", "--mount", "sh", "-c", _SHOW, "sh", str(closed[-1]), str(interpreter), *become]
        if closed
        else become
    )


SURROUNDINGS: dict[str, list[str]] = {
    "root": [],
    "root of a user namespace": ["unshare", "--user", "--map-root-user", "--mount", "--pid", "--fork", "--mount-proc"],
    "a user": _as_somebody(),
}
"""Who the organiser is: what is put in front of the command."""
BUILDER = """
import inside
import numpy as np

class Agent:
    def __init__(self, env_info, attempts):
        self.joints, self.attempts, self.steps = env_info["joint_pos_ids"], attempts, 0

    def episode_start(self):
        pass

    def draw_action(self, observation):
        self.steps += 1
        if self.steps == 2:
            inside.try_all(self.attempts)
        position = observation[self.joints]
        return np.array([position, 0 * position])

def build_agent(env_info, attempts, **kwargs):
    return Agent(env_info, attempts)
"""


def attack(sample: bool) -> Iterator[Verdict]:
    """Try everything, from every surrounding that this machine lets us have."""
    for surrounding, prefix in SURROUNDINGS.items():
        kind = f"escapes, organiser is {surrounding}"
        if prefix and subprocess.run([*prefix, "true"], capture_output=True, check=False).returncode != 0:
            yield Verdict(kind, "all", SKIPPED, "this machine does not let us be that")
            continue
        with tempfile.TemporaryDirectory(
            prefix="airhockey-attack-cache-"
        ) as cache:  # of compiled code, for all of them
            os.chmod(cache, 0o1777)
            yield from _attack_from(kind, prefix, sample, cache)
        if sample:
            break


def _attack_from(kind: str, prefix: Sequence[str], sample: bool, cache: str) -> Iterator[Verdict]:
    together = [name for name in product.wanted(names()) if name not in ALONE]
    groups = [*([together] if together else []), *([name] for name in product.wanted(ALONE))]
    for first, group in zip(
        itertools.chain([True], itertools.repeat(False)), groups[:1] if sample else groups, strict=False
    ):
        with _host() as (place, told):
            entry = make_entry(place.path, told, group)
            done = place.run(
                [*prefix, sys.executable, "-P", str(HERE / "drive.py"), str(entry), json.dumps(LIMITS)],
                env=place.environment(
                    {
                        "AIRHOCKEY_TOKEN": told["token"],
                        "HOME": str(place.temporary.parent / "home"),
                        "XDG_CACHE_HOME": cache,
                    }
                ),
                patience=START if first else product.PATIENCE,
            )
            yield from _judged(kind, group, done)


def _judged(kind: str, group: Sequence[str], done: product.Done) -> Iterator[Verdict]:
    """What became of each attempt of a group."""
    got = dict(
        line[2:].split("@@", 1) for line in done.err.splitlines() if line.startswith("@@") and line.count("@@") > 1
    )
    ended = done.out.strip()[-200:]
    for name in group:
        if got.get(name, "nothing") != "nothing":
            yield Verdict(kind, name, ESCAPE, got[name])
        elif done.status is None:
            yield Verdict(kind, name, HANG, ended)
        elif done.has_traceback:
            yield Verdict(kind, name, TRACEBACK, product.last_line(done))
        elif done.leftovers:
            yield Verdict(kind, name, LEFTOVER, ", ".join(done.leftovers))
        elif "\x1b" in done.err + done.out or "\u202e" in done.err + done.out:
            yield Verdict(kind, name, ESCAPE, "control sequences reached the terminal")
        elif name not in got and name not in ALONE:
            yield Verdict(kind, name, SKIPPED, f"was not tried: {ended} {product.last_line(done)}")
        else:
            yield Verdict(kind, name, HELD, ended)


def make_entry(place: Path, told: dict[str, Any], attempts: Sequence[str]) -> Path:
    """An entry that tries these, with what it may know."""
    entry = place / "entry" / "air_hockey_agent"
    entry.mkdir(parents=True)
    shutil.copy(HERE / "inside.py", entry / "inside.py")
    for place in (entry / "__pycache__", entry.parent / "build", entry.parent / "runs"):
        place.mkdir()
        (place / "left.txt").write_text("secret")
    (entry / "told.json").write_text(json.dumps(told))
    (entry / "agent_builder.py").write_text(BUILDER)
    (entry / "agent_config.yml").write_text(json.dumps({"attempts": list(attempts)}))
    return entry.parent


def names() -> list[str]:
    """Every attempt that there is, in the order of the file."""
    return [line[4 : line.index("(")] for before, line in _pairs() if before == "@attempt"]


def _pairs() -> Iterator[tuple[str, str]]:
    lines = (HERE / "inside.py").read_text().splitlines()
    return itertools.pairwise(lines)


@contextlib.contextmanager
def _host() -> Iterator[tuple[product.Place, dict[str, Any]]]:
    """A host with something to find: secrets in files, in the environment and in a keyring, ports, sockets."""
    with contextlib.ExitStack() as stack:
        place = stack.enter_context(product.fresh_place())
        secret = place.path / "secret.txt"
        opponent = place.path / "opponent" / "agent_builder.py"
        opponent.parent.mkdir()
        home = place.temporary.parent / "home"
        home.mkdir()
        home.chmod(0o1777)
        for file in (secret, opponent):
            file.write_text("secret")
        server = stack.enter_context(socket.create_server(("127.0.0.1", 0)))
        hidden = stack.enter_context(socket.socket(socket.AF_UNIX))
        abstract = f"airhockey-attack-{secrets.token_hex(4)}"
        hidden.bind("\0" + abstract)
        hidden.listen()
        disk = os.stat(place.path).st_dev
        yield (
            place,
            {
                "secret": str(secret),
                "opponent": str(opponent),
                "repository": str(product.ROOT),
                "port": server.getsockname()[1],
                "abstract": abstract,
                "disk": [os.major(disk), os.minor(disk)],
                "caches": [str(product.ROOT / ".cache"), str(product.ROOT / "airhockey")],
                "key": _key(),
                "evaluator": os.getpid(),
                "environment": ["AIRHOCKEY_TOKEN"],
                "token": secrets.token_hex(8),
                **{name: LIMITS[name] for name in ("memory", "scratch", "processes")},
            },
        )


def _key() -> int:
    """A key in this session's keyring; 0 where the kernel has none."""
    number = {"x86_64": 248, "aarch64": 217}.get(os.uname().machine, 248)
    libc = ctypes.CDLL(None)
    libc.syscall.restype = ctypes.c_long
    return max(int(libc.syscall(ctypes.c_long(number), b"user", b"airhockey-host", b"secret", 6, -3)), 0)

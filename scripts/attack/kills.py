"""Runs that are killed at any moment and taken up again: the result is that of a run that nobody killed."""

import csv
import json
import os
import random
import signal
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import product
from verdicts import CHANGED, HANG, HELD, LEFTOVER, TRACEBACK, Verdict

KILLS, SAMPLE = 100, 1
TIMES = ("time", "second", "created", "longest", "mean", "p99", "rate", "duration", "cpu", "agent_seed", "memory")
"""Parts of names of values that measure this machine, or say when it was."""


@dataclass(frozen=True)
class Run:
    """A command that is killed.

    Attributes:
        command: Without where it writes.
        files: What it leaves that must be the same, as patterns.
        before: A command whose run "before" it needs.
        film: The file in its folder that it writes, where it is no run, but begins anew every time.
    """

    command: tuple[str, ...]
    files: tuple[str, ...]
    before: tuple[str, ...] = ()
    film: str = ""


HOLDS = ("evaluate", "--env", "3dof-hit", "--agent", "hold", "--episodes")
RUNS: dict[str, Run] = {
    "evaluate": Run((*HOLDS, "40", "--jobs", "2"), ("journal.jsonl", "result.json")),
    "match": Run(
        ("match", "hold", "hold", "--games", "3", "--steps", "600", "--jobs", "2"), ("journal.jsonl", "result.json")
    ),
    "tournament": Run(
        ("tournament", "a=hold", "b=hold", "c=hold", "--steps", "400", "--jobs", "2"),
        ("journal.jsonl", "standings.json"),
    ),
    "train pgpe": Run(
        (
            *("train", "pgpe", "--task", "hit", "--robot", "3dof", "--iterations", "3", "--candidates", "4"),
            *("--episodes", "1", "--jobs", "2"),
        ),
        ("*.csv", "*.yaml"),
    ),
    "train sac": Run(
        (
            *("train", "sac", "--task", "defend", "--robot", "3dof", "--steps", "600", "--warm-up", "100"),
            *("--episodes", "3", "--batch", "32"),
        ),
        ("log.csv", "network.npz"),
    ),
    "train ppo": Run(
        (
            *("train", "ppo", "--task", "3dof-hit", "--steps", "12000", "--envs", "8", "--rollout", "64"),
            *("--batch", "128", "--episodes", "4", "--threads", "1"),
        ),
        ("log.csv", "air_hockey_agent/*"),
    ),
    "a Dask worker": Run((*HOLDS, "40", "--cluster", "local:2"), ("journal.jsonl", "result.json")),
    "video": Run(
        ("video", "before", "--seconds", "0.4", "--size", "160x90", "--quality", "fast"),
        ("film.mp4",),
        before=(*HOLDS, "4", "--jobs", "1"),
        film="/film.mp4",
    ),
}


def attack(sample: bool) -> Iterator[Verdict]:
    """Kill every kind of run again and again, and compare."""
    chance = random.Random(1)
    left = SAMPLE if sample else KILLS
    chosen = ["evaluate"] if sample else product.wanted(RUNS)
    share = -(-left // (1 if sample else len(RUNS)))
    for name in chosen:
        yield from _killed(name, share, chance)


def _killed(name: str, kills: int, chance: random.Random) -> Iterator[Verdict]:
    kind = f"kills of {name}"
    run = RUNS[name]
    command, files = run.command, run.files
    if kills == SAMPLE:
        command = (*command[:5], "--episodes", "8", "--jobs", "1")
    with product.fresh_place() as place:
        if run.before:
            place.hockey(*run.before, "--quiet", "--out", "before")
        if run.film:
            (place.path / "reference").mkdir()
        began = time.monotonic()
        reference = place.hockey(*command, "--quiet", "--out", f"reference{run.film}", patience=900.0)
        whole = time.monotonic() - began
        wanted = _content(place.path / "reference", files)
        if reference.status != 0 or not wanted:
            yield Verdict(kind, "reference", TRACEBACK, product.last_line(reference))
            return
        done, attempt = 0, 0
        while done < kills:
            attempt += 1
            out = f"run{attempt}"
            if run.film:
                (place.path / out).mkdir()
            fresh = True
            ended: product.Done | None = None
            while ended is None:
                moment = chance.uniform(0.3, 1.1) * whole / 2
                given = command if fresh else (*command[: 2 if command[0] == "train" else 1], "--resume")
                if not fresh and not any((place.path / out).glob("*.json")):
                    given = command
                process, began = (
                    place.start(product.hockey(*given, "--quiet", "--out", out + run.film)),
                    time.monotonic(),
                )
                whole_run, fresh = fresh, False
                if done < kills and _kill_at(process, moment, name, chance):
                    done += 1
                    yield _after_kill(kind, done, place)
                    continue
                try:
                    out_text, err_text = process.communicate(timeout=900.0)
                except Exception:
                    product.kill_all()
                    yield Verdict(kind, f"run {attempt}", HANG)
                    return
                if whole_run:  # the first one may have had to compile something
                    whole = min(whole, time.monotonic() - began)
                ended = product.Done(
                    process.returncode, product.text(out_text), product.text(err_text), place.leftovers()
                )
            yield _compared(kind, f"run {attempt}", ended, wanted, _content(place.path / out, files))


def _kill_at(process: Any, moment: float, name: str, chance: random.Random) -> bool:
    """Kill the command, or one of its workers, after so many seconds; False where it had ended before."""
    end = time.monotonic() + moment
    while time.monotonic() < end:
        if process.poll() is not None:
            return False
        time.sleep(0.02)
    victims = [pid for pid in product.orphans() if pid != process.pid]
    if name == "a Dask worker" or (victims and chance.random() < 0.3):
        if not victims:
            return False
        with_worker = chance.choice(victims)
        try:
            os.kill(with_worker, signal.SIGKILL)
        except ProcessLookupError:
            return False
        process.wait(timeout=900.0)
        return True
    process.kill()
    process.wait()
    return True


def _after_kill(kind: str, number: int, place: product.Place) -> Verdict:
    """Nothing may outlive a command that was killed, but what its next run clears away."""
    end = time.monotonic() + 10.0
    while (left := product.orphans()) and time.monotonic() < end:
        time.sleep(0.1)
    if left:
        product.kill_all()
        return Verdict(kind, f"kill {number}", LEFTOVER, ", ".join(left.values()))
    return Verdict(kind, f"kill {number}", HELD)


def _compared(kind: str, name: str, ended: product.Done, wanted: Any, found: Any) -> Verdict:
    if ended.has_traceback:
        return Verdict(kind, name, TRACEBACK, product.last_line(ended))
    if ended.status != 0:
        return Verdict(kind, name, CHANGED, f"exit status {ended.status}: {product.last_line(ended)}")
    if wanted != found:
        other = [file for file in wanted if found.get(file) != wanted[file]]
        return Verdict(kind, name, CHANGED, f"another content of {', '.join(other)}")
    return Verdict(kind, name, HELD)


def _content(folder: Path, patterns: tuple[str, ...]) -> dict[str, Any]:
    """What the files say, without what measures this machine."""
    found: dict[str, Any] = {}
    for pattern in patterns:
        for file in sorted(folder.glob(pattern)):
            if file.suffix == ".jsonl":
                lines = [_plain(json.loads(line)) for line in file.read_text().splitlines()]
                found[file.name] = sorted(lines, key=json.dumps)
            elif file.suffix == ".json":
                found[file.name] = _plain(json.loads(file.read_text()))
            elif file.suffix == ".csv":
                found[file.name] = [_plain(row) for row in csv.DictReader(file.read_text().splitlines())]
            else:
                found[file.name] = file.read_bytes()
    return found


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items() if not any(part in key for part in TIMES)}
    return [_plain(item) for item in value] if isinstance(value, list) else value

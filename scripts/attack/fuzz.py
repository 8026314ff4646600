"""Inputs that somebody made up: every reader says in one line what is wrong, or reads them; nothing else."""

import io
import random
import resource
import signal
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import product
from entries import GOOD, NOBODY
from verdicts import HANG, HELD, TRACEBACK, Verdict

COUNT, SAMPLE = 10_000, 200
BATCH = 250
PATIENCE, BUSY = 20, 10
"""For one input, in [s] of CPU time, and how many times as long on a busy machine."""
MEMORY = 6 << 30
NASTY = (
    b"[" * 500, b"{a: " * 200, b"&a [*a]", b"*a", b"!!python/object:os.system x", b"!!binary x", b"9" * 400, b"1e999", b".nan",
    b"-.inf", b"1:59:59", b"2024-02-30", b"\0", b"\xff\xfe", "\u202e".encode(), b"\x1b[2J", b"? [a]\n: b",
    b"<<: {a: 1}", b"- - -",
    b"true", b"null", b"''", b"\"\\ud800\"", b"-1", b"0", b"1e-3", b"99999999999999999999", b"{}", b"[]", b"\t", b"---\n...\n---",
    b"{a: 1}", b"name:", b"%YAML 9.9\n---\n", b"\r\n", b"#", b": : :", b"=", b"0x", b"0b2", b"_1", b"~",
)  # fmt: skip


def attack(sample: bool) -> Iterator[Verdict]:
    """Mutate every kind of input; each batch is read in a process of its own."""
    count = SAMPLE if sample else COUNT
    kinds = QUICK if sample else product.wanted(READERS)
    for kind in kinds:
        share = -(-count // (len(QUICK) if sample else len(READERS)))
        for first in range(0, share, BATCH):
            yield from _batch(kind, range(first, min(first + BATCH, share)))


def _batch(kind: str, numbers: range) -> Iterator[Verdict]:
    name = f"fuzzed {kind}"
    with product.fresh_place() as place:
        command = [sys.executable, __file__, kind, str(numbers.start), str(numbers.stop)]
        done = place.run(command, patience=len(numbers) * 4.0 + 120.0)
    said = dict(line.split(" ", 1) for line in done.out.splitlines() if line[:1].isdigit())
    for number in numbers:
        word, _, detail = said.get(str(number), "crashed ").partition(" ")
        if word == "fine":
            yield Verdict(name, str(number), HELD)
        elif word == "hung":
            yield Verdict(name, str(number), HANG, detail)
        else:
            yield Verdict(name, str(number), TRACEBACK, detail or f"status {done.status}: {product.last_line(done)}")


# ---- in the process of a batch


def main() -> None:
    """Read some mutated inputs of one kind: a line for each."""
    kind, first, last = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    for number in (signal.SIGALRM, signal.SIGPROF):
        signal.signal(number, _give_up)
    with tempfile.TemporaryDirectory() as scratch:
        read, good = READERS[kind](Path(scratch))
        from airhockey.errors import AirHockeyError

        for number in range(first, last):
            raw = mutated(good, random.Random(f"{kind} {number}"))
            signal.alarm(BUSY * PATIENCE)
            signal.setitimer(signal.ITIMER_PROF, PATIENCE)
            try:
                read(raw)
            except AirHockeyError:
                print(number, "fine", flush=True)
            except _Hung:
                print(number, "hung", flush=True)
            except BaseException as error:
                print(
                    number,
                    "crashed",
                    f"{type(error).__name__}: {error}".replace("\n", " ")[:200].encode("ascii", "replace"),
                )
            else:
                print(number, "fine", flush=True)
            finally:
                signal.alarm(0)
                signal.setitimer(signal.ITIMER_PROF, 0)


class _Hung(BaseException):
    """An input took too long."""


def _give_up(*_: object) -> None:
    raise _Hung


def mutated(good: bytes, chance: random.Random) -> bytes:
    """A good input with some bytes changed, cut, doubled, moved, or replaced by nasty ones."""
    raw = bytearray(good)
    for _ in range(chance.choice((1, 1, 2, 3, 8))):
        place = chance.randrange(len(raw) + 1)
        length = chance.choice((1, 2, 8, 64, 512))
        what = chance.randrange(7)
        if what == 0 and raw:
            raw[min(place, len(raw) - 1)] ^= 1 << chance.randrange(8)
        elif what == 1:
            del raw[place : place + length]
        elif what == 2:
            raw[place:place] = raw[chance.randrange(len(raw) + 1) :][:length]
        elif what == 3:
            raw[place : place + chance.choice((0, length))] = chance.choice(NASTY)
        elif what == 4:
            del raw[place:]
        elif what == 5:
            raw[place : place + length] = chance.randbytes(length)
        else:
            lines = bytes(raw).split(b"\n")
            lines[chance.randrange(len(lines))] = chance.choice((b"", b"  ")) + chance.choice(NASTY)
            raw = bytearray(b"\n".join(lines))
    return bytes(raw)


Reader = tuple[Callable[[bytes], Any], bytes]


def _into(file: Path, read: Callable[[Path], Any]) -> Callable[[bytes], Any]:
    def reader(raw: bytes) -> Any:
        file.write_bytes(raw)
        return read(file)

    return reader


def _profiles(place: Path) -> Reader:
    from airhockey import envs
    from airhockey.envs.disturbances import load_disturbances

    good = Path(envs.__file__).parent / "assets" / "disturbances" / "server.yaml"
    return _into(place / "profile.yaml", load_disturbances), good.read_bytes()


def _parameters(place: Path) -> Reader:
    from airhockey import agents
    from airhockey.agents.thesis.parameters import thesis_parameters

    good = next(Path(agents.__file__).parent.rglob("tuned.yaml"))
    return _into(place / "parameters.yaml", lambda file: thesis_parameters(str(file))), good.read_bytes()


def _metadata(place: Path) -> Reader:
    from airhockey.agents.packaging.metadata import METADATA, read_metadata

    return _into(place / METADATA, lambda _: read_metadata(place)), NOBODY.encode()


def _entries(place: Path) -> Reader:
    from airhockey.evaluator.entries import read_entries

    good = b"entries:\n  - name: alpha\n    agent: hold\n  - {name: beta, agent: thesis, interpolation_order: 3}\n"
    return _into(place / "entries.yaml", read_entries), good


def _archives(place: Path) -> Reader:
    import shutil

    from airhockey.agents.packaging.archive import unpack

    def read(file: Path) -> None:
        target = place / "unpacked"
        target.mkdir()
        try:
            unpack(file, target)
        finally:
            shutil.rmtree(target)

    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("agent_builder.py", GOOD)
        archive.writestr("submission.yaml", NOBODY)
        archive.writestr("parts/weights.bin", bytes(500))
    return _into(place / "entry.zip", read), stream.getvalue()


def _run(place: Path, which: str) -> Reader:
    """One file of a run's folder; the others are as they should be."""
    run = place / "run"
    command = [str(Path(sys.executable).with_name("hockey")), "evaluate", "--env", "3dof-hit", "--agent", "hold"]
    settings = ["--episodes", "3", "--jobs", "1", "--quiet", "--official-dataset", "--out", str(run)]
    subprocess.run([*command, *settings], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    file = next(run.rglob(which))
    from airhockey.reporting.document import report

    def read(_: Path) -> None:
        report([run], lambda *_: None)

    return _into(file, read), file.read_bytes()


def _dataset(place: Path) -> Reader:
    good = _run(place, "dataset.pkl")[1]
    from airhockey.viewing.library_official import read_dataset

    return _into(place / "dataset.pkl", read_dataset), good


def _trained(place: Path, which: str) -> Reader:
    """One file of a learned player's folder; built and played a step with each."""
    import shutil

    from airhockey import agents, envs
    from airhockey.agents.learned.player import LearnedPlayer

    good = Path(agents.__file__).parent / "learned" / "trained" / "7dof-defend"
    folder, env = Path(shutil.copytree(good, place / "player")), envs.make("7dof-defend")
    observation = env.reset(seed=0)

    def read(_: Path) -> None:
        LearnedPlayer.load(folder, env.env_info).draw_action(observation)

    read(folder)  # what is compiled first takes its time
    return _into(folder / which, read), (good / which).read_bytes()


def _films(place: Path) -> Reader:
    """The film of a game, as a page shows it and as a match that goes on believes it."""
    game = place / "game"
    command = [str(Path(sys.executable).with_name("hockey")), "match", "hold", "hold", "--steps", "120", "--quiet"]
    subprocess.run([*command, "--out", str(game)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    film = next((game / "films").glob("*.h5"))
    from airhockey.evaluator.match import resume_match
    from airhockey.reporting.document import report

    def read(_: Path) -> None:
        report([game], lambda *_: None)
        resume_match(game).close()

    return _into(film, read), film.read_bytes()


def _logs(place: Path) -> Reader:
    """The log of a training, as it is drawn."""
    from airhockey.learning.sac.plots import LOG, plot_training

    run = place / "run"
    run.mkdir()
    lines = [f"{100 * k},{k},{-3.5 + k},{0.1 * k:.3g},{0.01},{12.5}" for k in range(1, 9)]
    good = "\n".join(["steps,episodes,mean_return,success,violations,seconds", *lines]) + "\n"
    return _into(run / LOG, lambda _: plot_training(run, place)), good.encode()


def _training(place: Path, which: str) -> Reader:
    """One file of a training's folder, of which the others are as they should be."""
    run = place / "run"
    command = [
        str(Path(sys.executable).with_name("hockey")),
        "train",
        "pgpe",
        "--task",
        "hit",
        "--robot",
        "3dof",
        "--quiet",
    ]
    settings = ["--iterations", "2", "--candidates", "2", "--episodes", "1", "--jobs", "1", "--out", str(run)]
    subprocess.run([*command, *settings], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    from airhockey.learning.pgpe import training

    def read(_: Path) -> None:
        training.train(training.resume(run, {}))

    return _into(run / which, read), (run / which).read_bytes()


def _weights(place: Path) -> Reader:
    from airhockey.learning.envs.game import WEIGHTS, read_weights

    return _into(place / "weights.yaml", read_weights), WEIGHTS.read_bytes()


READERS: dict[str, Callable[[Path], Reader]] = {
    "disturbance profiles": _profiles,
    "parameter files": _parameters,
    "submission.yaml": _metadata,
    "entries files": _entries,
    "archives": _archives,
    "manifests": lambda place: _run(place, "run.json"),
    "journals": lambda place: _run(place, "journal.jsonl"),
    "trajectories": lambda place: _run(place, "trajectories.h5"),
    "official datasets": _dataset,
    "films of games": _films,
    "networks of learned players": lambda place: _trained(place, "network.npz"),
    "descriptions of learned players": lambda place: _trained(place, "policy.yaml"),
    "logs of trainings": _logs,
    "weights of rewards": _weights,
    "manifests of trainings": lambda place: _training(place, "train.json"),
    "journals of trainings": lambda place: _training(place, "journal.jsonl"),
}


QUICK = ("disturbance profiles", "submission.yaml")
"""Those that need no run to begin with."""


if __name__ == "__main__":
    main()

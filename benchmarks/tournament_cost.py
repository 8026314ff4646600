"""What a tournament costs here, and elsewhere: a game, the scheduler, the bookkeeping; the numbers of docs/scaling.md.

python benchmarks/tournament_cost.py game [--home planner] [--away thesis] [--steps 5000]
python benchmarks/tournament_cost.py engines [--games 60] [--steps 100] [--workers 2]
python benchmarks/tournament_cost.py bookkeeping [--entries 16]
"""

import argparse
import itertools
import resource
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import msgspec
import numpy as np

from airhockey.envs.disturbances import load_disturbances
from airhockey.evaluator.engines.cluster import Cluster
from airhockey.evaluator.engines.engine import Engine, InProcess
from airhockey.evaluator.engines.processes import Processes
from airhockey.evaluator.entries import Entry
from airhockey.evaluator.judging.standings import standings, write_standings
from airhockey.evaluator.play.game import Game, GamePlayer
from airhockey.evaluator.runs.game_records import GameJob, GameOptions, GameRecord
from airhockey.evaluator.schedule import TournamentOptions, schedule
from airhockey.evaluator.tournament import TournamentFolder, begin_tournament

WHOLE = 45000
ENTRIES = (4, 8, 16, 32)


def seconds(work: Callable[[], object]) -> float:
    """How long a call takes, in [s]."""
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def player(steps: int) -> GamePlayer:
    """Plays games of so many steps."""
    return GamePlayer(GameOptions(steps=steps), load_disturbances("ideal"))


def job(home: str, away: str, key: str = "0", seed: int = 0) -> GameJob:
    """A game of two agents."""
    return GameJob(key, home, away, home, away, seed)


def game(options: argparse.Namespace) -> None:
    """A game's CPU time, split into what every game needs and what a step needs; and what that makes of a tournament."""
    play, pair = player(options.steps), job(options.home, options.away)
    player(10)(pair)  # compile and load
    begin = time.process_time()
    player(10)(pair)
    fixed = time.process_time() - begin
    begin = time.process_time()
    played = play(pair)
    per_step = (time.process_time() - begin - fixed) / options.steps
    whole = fixed + WHOLE * per_step
    print(
        f"{options.home} against {options.away}: {1e3 * per_step:.3f} ms CPU per step, {fixed:.2f} s per game besides"
    )
    print(f"a game of {WHOLE} steps: {whole:.0f} s of one core")
    print("entries  games  core hours  on 2 cores  on 32 cores")
    for entries in ENTRIES:
        games = entries * (entries - 1)
        hours = games * whole / 3600.0
        print(f"{entries:7d}  {games:5d}  {hours:10.1f}  {hours / 2:8.1f} h  {hours / 32:9.2f} h")
    size = played.film.nbytes * WHOLE / options.steps / 1e6
    print(f"film of a whole game: {size:.1f} MB in memory and on the wire")
    print(f"peak memory of this process: {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")


def engines(options: argparse.Namespace) -> None:
    """Many short games on every engine: how long until the first result, and what a game costs besides being played."""
    jobs = [job("hold", "hold", str(k), k) for k in range(options.games)]
    alone = player(options.steps)
    alone(jobs[0])
    begin = time.process_time()
    for one in jobs[:10]:
        alone(one)
    here = (time.process_time() - begin) / 10
    print(
        f"{options.games} games of {options.steps} steps, hold against hold: {1e3 * here:.1f} ms of CPU each, in this process"
    )
    print("engine              first result   wall per game   CPU per game here   CPU of all, start and end included")
    workers = options.workers
    for engine in (InProcess(), Processes(workers), Cluster(f"local:{workers}")):
        measure(engine, jobs, options.steps, workers)


def measure(engine: Engine, jobs: list[GameJob], steps: int, workers: int) -> None:
    """Play the jobs and print a line."""
    warm_up = 2 * workers  # games, after which every worker has played
    everything, times, cpu = _cpu_of_all(), [time.perf_counter()], [time.process_time()]
    for _ in engine.run(player(steps), jobs):
        times.append(time.perf_counter())
        cpu.append(time.process_time())
    steady = len(jobs) - warm_up
    print(
        f"{type(engine).__name__:18}  {times[1] - times[0]:10.2f} s  {1e3 * (times[-1] - times[warm_up]) / steady:11.1f} ms"
        f"  {1e3 * (cpu[-1] - cpu[warm_up]) / steady:15.2f} ms  {_cpu_of_all() - everything:10.1f} s"
    )


def _cpu_of_all() -> float:
    """CPU time of this process and of its children that have ended, in [s]."""
    usages = resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN)
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def bookkeeping(options: argparse.Namespace) -> None:
    """What a finished game costs its parent: journal, film, standings; with a film of a whole game."""
    entries = tuple(Entry(name=f"e{k}", agent="hold") for k in range(options.entries))
    plan = TournamentOptions(entries=entries)
    jobs, names = schedule(plan), [entry.name for entry in entries]
    template = player(200)(job("hold", "hold"))
    walk = np.cumsum(np.random.default_rng(0).normal(0.0, 1e-3, (WHOLE, template.film.shape[1])), axis=0)
    film = walk.astype(np.float32)
    print(f"schedule of {options.entries} entries: {len(jobs)} games, {1e3 * seconds(lambda: schedule(plan)):.1f} ms")
    with tempfile.TemporaryDirectory() as place:
        folder = begin_tournament(plan, Path(place) / "run")
        with folder:
            record: GameRecord = msgspec.structs.replace(template.record, job=jobs[0])
            kept = seconds(lambda: folder.add(Game(record, film)))
            size = sum(file.stat().st_size for file in (folder.path / "films").iterdir()) / 1e6
            records = [msgspec.structs.replace(template.record, job=one) for one in jobs]
            last = seconds(lambda: write_standings(folder.path, standings(names, jobs, records)))
    with tempfile.TemporaryDirectory() as place:
        folder = begin_tournament(plan, Path(place) / "run")
        with folder:
            for one in itertools.islice(records, len(records) - 1):
                folder.add(Game(one, film[:0]))
        again = seconds(lambda: TournamentFolder.open(Path(place) / "run").close())
    print(f"to keep a whole game: {kept:.2f} s, {size:.1f} MB of film")
    print(f"to compute and write the standings after the last game: {1e3 * last:.0f} ms")
    print(f"to take up the tournament before its last game: {1e3 * again:.0f} ms")


def main() -> None:
    """Measure what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    what = parser.add_subparsers(required=True)
    one = what.add_parser("game")
    one.add_argument("--home", default="planner")
    one.add_argument("--away", default="thesis")
    one.add_argument("--steps", type=int, default=5000)
    one.set_defaults(measure=game)
    many = what.add_parser("engines")
    many.add_argument("--games", type=int, default=60)
    many.add_argument("--steps", type=int, default=100)
    many.add_argument("--workers", type=int, default=2)
    many.set_defaults(measure=engines)
    books = what.add_parser("bookkeeping")
    books.add_argument("--entries", type=int, default=16)
    books.set_defaults(measure=bookkeeping)
    options = parser.parse_args()
    options.measure(options)


if __name__ == "__main__":
    main()

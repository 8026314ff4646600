"""A whole game against the bare engine, in one run, on one core: time, and memory over the game.

    python benchmarks/match_rate.py [--home planner] [--away thesis] [--steps 45000]

It is compared with bare `mj_step` for the same number of substeps on the same scene, measured in blocks between the blocks of
the game, so that whatever else the machine does disturbs both alike; and once more in CPU time. The target is a ratio ≤ 1.7.
"""

import argparse
import resource
import time

import mujoco

from airhockey import envs
from airhockey.envs.disturbances import load_disturbances
from airhockey.evaluator.play.game import GamePlayer
from airhockey.evaluator.runs.game_records import GameJob, GameOptions, Status

BLOCK = 500


class Bound:
    """Steps the bare engine in blocks, and takes its time out of the game's."""

    def __init__(self) -> None:
        self.env = envs.make("tournament")
        self.data = mujoco.MjData(self.env.simulation.model)
        self.seconds, self.cpu, self.steps = 0.0, 0.0, 0
        self.memory: list[int] = []
        self._start()

    def _start(self) -> None:
        self.env.reset(seed=self.steps)
        mujoco.mj_copyData(self.data, self.env.simulation.model, self.env.simulation.data)

    def block(self, status: Status) -> None:
        """As many bare steps as the game has done since the last call."""
        begin, cpu = time.perf_counter(), time.process_time()
        for _ in range(BLOCK):
            mujoco.mj_step(self.env.simulation.model, self.data, 20)
        self.seconds += time.perf_counter() - begin
        self.cpu += time.process_time() - cpu
        self.steps += BLOCK
        self._start()
        self.memory.append(_resident())


def _resident() -> int:
    """Resident memory, in [kB]."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize() // 1024


def main() -> None:
    """Play one game and print both times and the memory at its quarters."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--home", default="planner")
    parser.add_argument("--away", default="thesis")
    parser.add_argument("--steps", type=int, default=45000)
    options = parser.parse_args()
    bound = Bound()
    player = GamePlayer(GameOptions(steps=options.steps), load_disturbances("ideal"), on_step=bound.block, every=BLOCK)
    job = GameJob("0", options.home, options.away, options.home, options.away, seed=0)
    begin, cpu = time.perf_counter(), time.process_time()
    record = player(job).record
    total, total_cpu = time.perf_counter() - begin - bound.seconds, time.process_time() - cpu - bound.cpu
    bare, bare_cpu = (spent / bound.steps * record.steps for spent in (bound.seconds, bound.cpu))
    home, away = record.score
    print(f"{options.home} {home} : {away} {options.away}, {record.steps} steps")
    print(f"wall clock: game {total:.1f} s, bare mj_step {bare:.1f} s, ratio {total / bare:.2f}")
    print(f"CPU time: game {total_cpu:.1f} s, bare mj_step {bare_cpu:.1f} s, ratio {total_cpu / bare_cpu:.2f}")
    for name, result in ((options.home, record.home), (options.away, record.away)):
        spent, most = result.computation_time.mean * 1e3, result.computation_time.max * 1e3
        print(
            f"{name}: draw_action mean {spent:.3f} ms, max {most:.1f} ms, held {result.held}, penalty {result.penalty:g}"
        )
    # It was compiled and loaded by the end of the first quarter: from there on memory must be flat.
    quarters = [bound.memory[len(bound.memory) * k // 4 - 1] // 1024 for k in range(1, 5)]
    print(f"resident memory at the quarters of the game: {', '.join(f'{size} MB' for size in quarters)}")


if __name__ == "__main__":
    main()

"""Everybody against everybody: goals, points by faults, faults and penalties of every pair, over several seeds, with intervals.

    python benchmarks/champions_cup.py [--players planner thesis] [--against benchmarks/opponents/*] [--games 3] [--steps 45000]
        [--out docs/champions.md]

Without `--against` the players play each other; with it each plays those. Home and away alternate. Opponents of the folder
`opponents` that our parameters were not tuned on are marked *. A row is the mean per game of 45,000 steps, shorter games scaled
up, with the 95 % interval of Student's t over the games; penalties and computation times are the worst of any game.
"""

import argparse
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import combinations, product
from math import sqrt
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import strokes

from airhockey.envs.disturbances import load_disturbances
from airhockey.evaluator.analysis.shots import shots_of
from airhockey.evaluator.play.game import GamePlayer
from airhockey.evaluator.play.seeding import game_seed
from airhockey.evaluator.runs.game_records import SIDES, GameJob, GameOptions, PlayerResult

WHOLE = 45000
"""Control steps of a game."""
OPPONENTS = Path(__file__).parent / "opponents"
TUNED_ON = ("official", "volley", "soft")
"""Opponents that parameters may be chosen by."""
STUDENT = (12.71, 4.30, 3.18, 2.78, 2.57, 2.45, 2.36, 2.31, 2.26)
"""97.5 % points of Student's t with 1, 2, … degrees of freedom."""
COLUMNS = (
    "goals", "conceded", "points by faults", "faults", "their faults", "shots", "their median [m/s]", "penalty",
    "draw_action mean / max [ms]",
)  # fmt: skip

Row = dict[str, float]


def agent_of(name: str) -> str:
    """What a game job calls a player: a name of the registry, or a path."""
    return str((OPPONENTS / name).resolve()) if (OPPONENTS / name).is_dir() else name


def label_of(name: str) -> str:
    """How the table calls it."""
    short = name.rstrip("/").rpartition("/")[2]
    return short + "*" if (OPPONENTS / short).is_dir() and short not in TUNED_ON else short


def row_of(first: PlayerResult, second: PlayerResult, speeds: Sequence[float], scale: float) -> Row:
    """One game, seen from its first player, scaled to a whole one."""
    return {
        "goals": scale * first.goals,
        "conceded": scale * second.goals,
        "points by faults": scale * first.points_by_faults,
        "faults": scale * first.faults,
        "their faults": scale * second.faults,
        "shots": scale * len(speeds),
        "median speed": float(np.median(speeds)) if speeds else 0.0,
        "penalty": first.penalty,
        "mean ms": 1e3 * first.computation_time.mean,
        "max ms": 1e3 * first.computation_time.max,
    }


def play(pair: tuple[str, str], steps: int, disturbances: str, seed: int, number: int) -> Row:
    """One game of a pair; in every second one the first player is away."""
    left, right = pair if number % 2 == 0 else pair[::-1]
    job = GameJob(str(number), left, right, agent_of(left), agent_of(right), game_seed(seed, str(number)))
    game = GamePlayer(GameOptions(steps=steps, disturbances=disturbances), load_disturbances(disturbances))(job)
    sides = (game.record.home, game.record.away)
    for name, result in zip((left, right), sides, strict=True):
        if result.failure is not None:
            raise SystemExit(f"{name} failed: {result.failure}")
    mine = number % 2
    shots = shots_of(np.asarray(game.film, dtype=np.float64), game.record.events)
    speeds = [shot.speed for shot in shots if shot.side == SIDES[mine]]
    return row_of(sides[mine], sides[1 - mine], speeds, WHOLE / game.record.steps)


def summary(rows: list[Row]) -> list[str]:
    """The cells of a line."""
    cells = []
    for key in ("goals", "conceded", "points by faults", "faults", "their faults"):
        values = np.array([row[key] for row in rows])
        spread = (
            values.std(ddof=1) / sqrt(len(values)) * STUDENT[min(len(values) - 2, 8)] if len(values) > 1 else np.inf
        )
        cells.append(f"{values.mean():.1f} ± {spread:.1f}" if np.isfinite(spread) else f"{values.mean():.1f}")
    cells += [f"{np.mean([row['shots'] for row in rows]):.0f}", f"{np.mean([row['median speed'] for row in rows]):.2f}"]
    cells.append(f"{max(row['penalty'] for row in rows):g}")
    cells.append(f"{np.mean([row['mean ms'] for row in rows]):.3f} / {max(row['max ms'] for row in rows):.1f}")
    return cells


PAGE = """# Champions' cup

Players against opponents of other styles (`benchmarks/opponents`), figures per whole game of {whole} control steps. Parameters
were chosen on {tuned}; the opponents marked * are others. Made by

```
python benchmarks/champions_cup.py --players {players} --games {games} --steps {steps} --seed {seed} --out {out}
```

{table}

## How fast a stroke can be

By `python benchmarks/strokes.py`, in [m]/[s]: the mallet's speed that the joints' velocity limits allow at the contact, in the
posture of the stroke and in the best one; what the planner asks for, and its share of the best; and the puck's speed afterwards.

{strokes}
"""


def page(lines: Sequence[str], options: argparse.Namespace) -> str:
    """The page of documentation with a table, and how it was made."""
    return PAGE.format(
        whole=WHOLE,
        tuned=", ".join(TUNED_ON),
        players=" ".join(options.players),
        games=options.games,
        steps=options.steps,
        seed=options.seed,
        out=options.out,
        table="\n".join(lines),
        strokes="\n".join(strokes.lines()),
    )


def main() -> None:
    """Play, and print the table as it grows."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--players", nargs="+", default=["planner"])
    opponents = sorted(path.parent.name for path in OPPONENTS.glob("*/air_hockey_agent"))
    parser.add_argument("--against", nargs="*", default=[*opponents, "thesis"])
    parser.add_argument("--games", type=int, default=3)
    parser.add_argument("--steps", type=int, default=WHOLE)
    parser.add_argument("--disturbances", nargs="+", default=["ideal", "server"])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1, help="games at a time")
    parser.add_argument("--out", type=Path, help="also write the table to this page, with how it was made")
    options = parser.parse_args()
    pairs = (
        list(product(options.players, options.against)) if options.against else list(combinations(options.players, 2))
    )
    lines = [
        "| player | against | disturbances | " + " | ".join(COLUMNS) + " |",
        "|---" * (3 + len(COLUMNS)) + "|",
    ]
    print("\n".join(lines))
    with ProcessPoolExecutor(options.jobs, get_context("spawn")) as pool:
        table = [
            (
                pair,
                disturbances,
                [
                    pool.submit(play, pair, options.steps, disturbances, options.seed, number)
                    for number in range(options.games)
                ],
            )
            for pair, disturbances in product(pairs, options.disturbances)
        ]
        for pair, disturbances, games in table:
            rows = [game.result() for game in games]
            lines.append(
                f"| {label_of(pair[0])} | {label_of(pair[1])} | {disturbances} | " + " | ".join(summary(rows)) + " |"
            )
            print(lines[-1], flush=True)
            if options.out is not None:
                options.out.write_text(page(lines, options))


if __name__ == "__main__":
    main()

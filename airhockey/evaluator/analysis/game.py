"""A recorded game, aggregated: who had the puck where, who hit it, and what became of the shots."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from airhockey.evaluator.analysis.shots import Shot, hits_of, shots_among
from airhockey.evaluator.runs.game_records import AWAY, HOME, GameRecord
from airhockey.evaluator.runs.game_trajectories import read_film

Array = NDArray[np.float64]


@dataclass(frozen=True)
class GameAnalysis:
    """What a game's trajectory says.

    Attributes:
        at_home: Share of the time that the puck was on home's side, in each of equally long parts. Shape (parts,).
        possession: The same over the whole game.
        touches: Numbers of hits of home and away.
        shots: In the order of the game.
        puck: Where the puck was, world coordinates in [m], every fifth step. Shape (n, 2).
    """

    at_home: Array
    possession: float
    touches: tuple[int, int]
    shots: tuple[Shot, ...]
    puck: Array


def analyse_game(path: Path, record: GameRecord, parts: int = 180) -> GameAnalysis:
    """Analyse the trajectory of a game.

    Raises:
        OSError, KeyError: The file is broken.
    """
    rows = read_film(path).astype(np.float64)
    touches = hits_of(rows, record.events)
    home = rows[:, 0] < 0.0
    edges = np.linspace(0, len(rows), min(parts, len(rows)) + 1).astype(int)[:-1]
    return GameAnalysis(
        at_home=np.add.reduceat(home.astype(float), edges) / np.diff(np.append(edges, len(rows))),
        possession=float(home.mean()),
        touches=(sum(hit.side == HOME for hit in touches), sum(hit.side == AWAY for hit in touches)),
        shots=tuple(shots_among(touches, rows, record.events)),
        puck=rows[::5, :2],
    )

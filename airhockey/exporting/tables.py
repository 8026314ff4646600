"""A row per episode or game, as CSV or Parquet."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from airhockey.envs.specs import CONTROL_PERIOD
from airhockey.evaluator.runs.game_records import SIDES, GameRecord
from airhockey.evaluator.runs.reader import Games, Run
from airhockey.evaluator.runs.records import EpisodeRecord
from airhockey.inputs.packages import needs

Row = dict[str, Any]


def rows_of(source: Run | Games[Any]) -> list[Row]:
    """A row per finished episode or game; all have the same columns."""
    if isinstance(source, Run):
        constraints = sorted({name for record in source.records for name in record.violations})
        options = source.manifest.options if source.manifest else None
        seed = None if options is None else str(options.seed)  # it may have more bits than a column of integers
        shared = {"agent": source.agent, "seed": seed, "disturbances": source.disturbances}
        return [_episode(record, shared, constraints) for record in source.records]
    return [_game(record, source.disturbances) for record in source.records]


def as_csv(rows: Sequence[Row]) -> str:
    """With a line of names."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(rows[0])
    writer.writerows(row.values() for row in rows)
    return text.getvalue()


def as_parquet(rows: Sequence[Row]) -> bytes:
    """Raises `MissingDependencyError` where there is no pyarrow."""
    arrow, parquet = pyarrow()
    content = io.BytesIO()
    parquet.write_table(arrow.Table.from_pylist(list(rows)), content)
    return content.getvalue()


def pyarrow() -> tuple[Any, Any]:
    """The modules `pyarrow` and `pyarrow.parquet`."""
    with needs("this format", "pyarrow", "export"):
        import pyarrow
        from pyarrow import parquet
    return pyarrow, parquet


def table_name(path: Path, suffix: str) -> Path:
    """Where the table of a folder goes, unless the user says so."""
    return Path(f"{path.resolve().name}.{suffix}")


def _episode(record: EpisodeRecord, shared: Row, constraints: Sequence[str]) -> Row:
    violated = {f"{name}_steps": record.violations.get(name, 0) for name in constraints}
    return {
        "env": record.env,
        "index": record.index,
        "success": record.success,
        "steps": record.steps,
        "seconds": round(record.steps * CONTROL_PERIOD, 2),
        "ended_by_task": record.absorbing,
        **violated,
        "computation_time_mean": record.computation_time.mean,
        "computation_time_max": record.computation_time.max,
        "error": record.error,
        **shared,
        "edition": record.edition,
    }


def _game(record: GameRecord, disturbances: str) -> Row:
    row: Row = {"game": record.key, "home": record.job.home, "away": record.job.away, "seed": str(record.job.seed)}
    row |= {"steps": record.steps, "winner": record.winner}
    for side in SIDES:
        result = getattr(record, side)
        row |= {
            f"{side}_points": result.points,
            f"{side}_goals": result.goals,
            f"{side}_faults": result.faults,
            f"{side}_penalty": result.penalty,
            f"{side}_class": result.deployability,
            f"{side}_held": result.held,
            f"{side}_computation_time_mean": result.computation_time.mean,
            f"{side}_computation_time_max": result.computation_time.max,
            f"{side}_failure": result.failure,
        }
    return row | {"disturbances": disturbances, "edition": record.edition}

"""The evaluator: plays episodes of tasks, judges them, and keeps everything to go on with and to read.

from airhockey.evaluator import Options, begin, evaluate
result = evaluate(begin(Options(environments=("7dof-prepare",), episodes=100), Path("runs/mine")))
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from airhockey.evaluator.engines import Engine, InProcess, Processes, engine_for
    from airhockey.evaluator.records import EpisodeRecord, Options, RunResult, TaskResult
    from airhockey.evaluator.report import report
    from airhockey.evaluator.run import begin, evaluate, play_episode, take_up

_HOMES = {
    "Engine": "engines",
    "EpisodeRecord": "records",
    "InProcess": "engines",
    "Options": "records",
    "Processes": "engines",
    "RunResult": "records",
    "TaskResult": "records",
    "begin": "run",
    "engine_for": "engines",
    "evaluate": "run",
    "play_episode": "run",
    "report": "report",
    "take_up": "run",
}

__all__ = [
    "Engine",
    "EpisodeRecord",
    "InProcess",
    "Options",
    "Processes",
    "RunResult",
    "TaskResult",
    "begin",
    "engine_for",
    "evaluate",
    "play_episode",
    "report",
    "take_up",
]


def __getattr__(name: str) -> Any:
    """Import what the layer offers when it is first asked for (PEP 562)."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"airhockey.evaluator.{_HOMES[name]}"), name)

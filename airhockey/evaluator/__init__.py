"""The evaluator: plays episodes of tasks, judges them, and keeps everything to go on with and to read.

from airhockey.evaluator import Options, begin, evaluate
result = evaluate(begin(Options(environments=("7dof-prepare",), episodes=100), Path("runs/mine")))
"""

from typing import TYPE_CHECKING, Any

from airhockey.lazy import attribute

if TYPE_CHECKING:
    from airhockey.evaluator.engines.engine import Engine, InProcess, engine_for
    from airhockey.evaluator.engines.processes import Processes
    from airhockey.evaluator.evaluation import begin, evaluate, play_episode, report, resume
    from airhockey.evaluator.runs.records import EpisodeRecord, Options, RunResult, TaskResult

_HOMES = {
    "Engine": "engines.engine",
    "EpisodeRecord": "runs.records",
    "InProcess": "engines.engine",
    "Options": "runs.records",
    "Processes": "engines.processes",
    "RunResult": "runs.records",
    "TaskResult": "runs.records",
    "begin": "evaluation",
    "engine_for": "engines.engine",
    "evaluate": "evaluation",
    "play_episode": "evaluation",
    "report": "evaluation",
    "resume": "evaluation",
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
    "resume",
]


def __getattr__(name: str) -> Any:
    """Import what the layer offers when it is first asked for (PEP 562)."""
    return attribute(__name__, name, {one: f"{__name__}.{home}" for one, home in _HOMES.items()})

"""What workers are asked to do in the tests."""

import os
import signal
from pathlib import Path
from typing import Any

from airhockey.evaluator.play.episode import EpisodePlayer


def square(number: int) -> int:
    return number * number


def surroundings(_: int) -> tuple[int, str | None, bool]:
    return os.getpid(), os.environ.get("OMP_NUM_THREADS"), signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def die_on_three(number: int) -> int:
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def die_once(job: tuple[int, str]) -> int:
    number, marker = job
    if number == 3 and not Path(marker).exists():
        Path(marker).touch()
        os._exit(7)
    return number


def fail(number: int) -> int:
    raise ValueError(f"no {number}")


class Closing:
    def __init__(self, marker: str) -> None:
        self.marker = marker

    def __call__(self, number: int) -> int:
        return number

    def close(self) -> None:
        Path(self.marker).write_text("closed")


class DiesInTheSecond(EpisodePlayer):
    """Plays episodes; the second one ends the worker."""

    def __call__(self, job: Any) -> Any:
        if job.index == 1:
            os.kill(os.getpid(), signal.SIGKILL)
        return super().__call__(job)

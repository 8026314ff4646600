"""What stays between several runs of one function, and what a job gives that killed its workers."""

import abc
from collections.abc import Generator, Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Generic, TypeVar

Job = TypeVar("Job")
Result = TypeVar("Result")


@dataclass(frozen=True)
class JobFailed:
    """What a job gives whose worker died every time.

    Attributes:
        reason: One line.
    """

    reason: str


class Pool(AbstractContextManager["Pool[Job, Result]"], Generic[Job, Result]):
    """Several runs of one function after another, which keeps what it built and where it runs until the pool is left."""

    @abc.abstractmethod
    def run(self, jobs: Iterable[Job]) -> Generator[tuple[Job, Result | JobFailed], None, None]:
        """Yield each job with its result, in any order; raises what the function raises."""

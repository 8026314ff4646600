"""What an agent's answers cost: the CPU time of everything that it started, and the time that it slept."""

from airhockey.evaluator.isolation.failures import AgentTimeout
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.isolation.memory_watch import Watched
from airhockey.evaluator.isolation.process_tree import cpu_time_of

_UNSEEN = 0.002
"""Wall time beyond its own CPU time from which on it is worth a look where an answer's time went, in [s]."""


class AnswerTimes:
    """The clock of an agent in a process of its own.

    An answer costs the CPU time that the agent's process has used since the one before, with all its threads; where it has
    other processes, theirs too; and never less than the wall time that passed while it could have run but chose not to.
    That another program had the core costs it nothing.

    Args:
        watched: Its processes.
        limits: What it may use.

    Attributes:
        charged: What all commands so far have cost, in [s].
    """

    def __init__(self, watched: Watched, limits: Limits) -> None:
        self.charged = 0.0
        self._watched, self._tree, self._limits = watched, watched.tree, limits
        self._used = self._waited = 0.0
        self._spent, self._allowed = 0.0, limits.patience

    def begin(self) -> None:
        """It was built; what that took has a bound of its own."""
        self._watched.look()
        self._used = self._tree.cpu_time()

    def add_start(self, wall: float) -> None:
        """It was told of an episode's start; raises `AgentTimeout` where that took too long for too long."""
        self._used = self._tree.cpu_time()
        self._spend(wall, self._limits.episode)

    def add_command(self, wall: float) -> None:
        """It gave a command; raises `AgentTimeout` where its commands have taken too long for too long."""
        tree = self._tree
        used = tree.cpu_time() if tree.had_others else cpu_time_of(tree.agent)
        cost = used - self._used
        if wall - cost > _UNSEEN:
            waited = self._watched.waited
            if tree.look():
                used = tree.cpu_time()
                cost = used - self._used
            cost = max(cost, wall - max(tree.waited() - waited, 0.0))
        self._used = used
        self.charged += cost
        self._spend(wall, self._limits.step)

    def _spend(self, wall: float, allowed: float) -> None:
        self._spent += wall
        self._allowed += allowed
        if self._spent > self._allowed:
            raise AgentTimeout(
                f"its answers have taken {self._spent:.0f} s; {self._limits.patience:g} s and {self._limits.step:g} s for "
                f"every command are allowed"
            )

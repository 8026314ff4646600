"""The evaluator's side: an object with an agent's interface, whose agent lives in another process.

Everything that comes from there is data: an action is numbers of a checked shape, a message is JSON. What an agent does wrong
is raised here as its failure, and its process is then gone.
"""

import contextlib
import os
import select
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.copying import NotCopyable
from airhockey.errors import ActionError, EnvironmentFault
from airhockey.evaluator.isolation import channel, memory_watch
from airhockey.evaluator.isolation.answer_times import AnswerTimes
from airhockey.evaluator.isolation.cgroup import Group, new_group
from airhockey.evaluator.isolation.channel import Memory
from airhockey.evaluator.isolation.failures import AgentDied, AgentError, AgentRaised, AgentTimeout
from airhockey.evaluator.isolation.handle import AgentHandle
from airhockey.evaluator.isolation.launch import Launch
from airhockey.evaluator.isolation.limits import Limits
from airhockey.evaluator.isolation.memory_watch import Watched
from airhockey.evaluator.isolation.modes import protection
from airhockey.evaluator.isolation.output import Output
from airhockey.evaluator.isolation.pids import first_inside, only_child
from airhockey.evaluator.isolation.process_tree import ProcessTree, descendants
from airhockey.evaluator.isolation.restrict import Restrictions
from airhockey.evaluator.isolation.sandbox import SCRATCH
from airhockey.evaluator.isolation.shared_core import SharedCore
from airhockey.inputs.names import shown

Array = NDArray[np.float64]


class IsolatedAgent(NotCopyable, AgentHandle):
    """An agent in a process of its own.

    Args:
        launch: How its process is started.
        job: What `airhockey.evaluator.isolation.build_local.build_from_names` needs.
        limits: What it may use, and how long anybody waits.
        seed: Of the generators that it may draw from while it is built.
        name: Whose output it counts as; default: what it is called over there.

    Attributes:
        interpolation_order: What the agent wants. Its preprocessors are applied over there.
        times: What its answers cost.

    Raises:
        AgentError: It could not be built.
    """

    phase = "isolated"
    _process: subprocess.Popen[bytes]
    _memory: Memory
    _requests: int = -1
    _replies: int = -1
    _output: Output
    _core: SharedCore
    _watched: Watched
    times: AnswerTimes

    def __init__(
        self,
        launch: Launch,
        job: dict[str, Any],
        limits: Limits,
        seed: np.random.SeedSequence | None = None,
        name: str | None = None,
    ) -> None:
        self._limits, self._launch = limits, launch
        self._seed: np.random.SeedSequence | None = None
        self._pid = 0
        self._group: Group | None = None
        self._nonces = channel.Nonces()
        restrictions = Restrictions(limits, launch.user, launch.sandbox)
        self._start(name or str(job["agent"]))
        try:
            self._await_start()
            self._memory.write_text(job | {"restrictions": restrictions.to_json(), "seed": _words(seed)})
            self._ask(channel.BUILD, limits.start)
            self.times.begin()
            told = self._memory.read_text()
            order = told.get("interpolation_order", 3) if isinstance(told, dict) else 3
            self.interpolation_order = order if order is None or isinstance(order, int) else 3
        except BaseException:
            self.close()
            raise

    @property
    def isolation(self) -> str:
        """How far it is kept apart, and what limits it."""
        return self._isolation

    @property
    def printed(self) -> str:
        """The end of what the agent wrote to its standard output and error."""
        return self._output.tail

    def seed(self, sequence: np.random.SeedSequence) -> None:
        """Seed the generators that it draws from, when the next episode begins."""
        self._seed = sequence

    def episode_start(self) -> None:
        """A serve begins."""
        self._memory.write_text({"seed": _words(self._seed)})
        self._seed = None
        began = time.perf_counter()
        self._ask(channel.EPISODE, self._limits.patience)
        self._bounded(self.times.add_start, began)

    def act(self, observation: Array) -> Array:
        """The next command, in any shape that the agent likes.

        Raises:
            ActionError: It is not an array of numbers.
            AgentError: The agent raised, died, or did not answer within the patience.
        """
        self._core.follow()
        self._memory.write_observation(observation)
        began = time.perf_counter()
        word = self._ask(channel.ACT, self._limits.patience)
        self._bounded(self.times.add_command, began)
        if word == channel.BAD_ACTION:
            raise ActionError(_clean(self._memory.read_text()))
        return self._memory.read_action()

    def clock(self, kind: str) -> Callable[[], float]:
        """Wall time as it passes here, or what its commands cost, see `AnswerTimes`."""
        return self.cpu_clock if kind == "cpu" else time.perf_counter

    def cpu_clock(self) -> float:
        """What its commands so far have cost, in [s]."""
        return self.times.charged

    def thinks_for(self, seconds: float) -> float:
        """Wait so long; gives the CPU time that it used meanwhile, though nobody asked it anything, in [s]."""
        processes = self._watched.tree
        processes.look()
        before = processes.cpu_time()
        time.sleep(seconds)
        processes.look()
        return max(processes.cpu_time() - before, 0.0)

    def stop(self) -> None:
        """Tell the agent that it is over, and end its process."""
        try:
            self._ask(channel.STOP, self._limits.patience)
        finally:
            self.close()

    def close(self) -> None:
        """End its process and everything that it started. May be called twice."""
        process = self._process
        left = []
        if hasattr(self, "_watched"):
            memory_watch.forget(self._watched)
            left = descendants(process.pid) if process.returncode is None else []
        with contextlib.suppress(OSError):
            os.killpg(process.pid, signal.SIGKILL)
        for pid in left:  # of a plain process; in a sandbox all end with the first
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)
        process.wait()
        if self._group is not None:
            self._group.remove()
        for descriptor in (self._requests, self._replies):
            if descriptor >= 0:
                os.close(descriptor)
        self._requests = self._replies = -1
        self._output.close()
        for folder in self._launch.temporary_folders:
            shutil.rmtree(folder, ignore_errors=True)

    def __del__(self) -> None:
        with contextlib.suppress(AttributeError, OSError):
            self.close()

    def _start(self, name: str) -> None:
        """Start the process, with its pipes; what it prints counts with what others of this name have printed."""
        shared = channel.new_memory()
        their_requests, self._requests = os.pipe()
        os.set_blocking(self._requests, False)  # over there the pipe can be filled: nobody waits for room in it
        self._replies, their_replies = os.pipe()
        output, their_output = os.pipe()
        self._output = Output(output, name)
        status, their_status = os.pipe()
        theirs = (their_requests, their_replies, shared)
        command = [*self._launch.command, *map(str, theirs)]
        in_sandbox = self._launch.sandbox
        if in_sandbox:
            command[1:1] = ["--info-fd", str(their_status)]
        try:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=their_output,
                stderr=their_output,
                env=self._launch.environment,
                cwd=self._launch.folder,
                pass_fds=(*theirs, their_status),
                start_new_session=True,
            )
            self._memory = Memory(shared)
        finally:
            for descriptor in (*theirs, their_output, their_status):
                os.close(descriptor)
        self._first = first_inside(status) if in_sandbox else None
        os.close(status)
        self._poll = select.poll()
        self._poll.register(self._replies, select.POLLIN)
        self._poll.register(output, select.POLLIN)

    def _await_start(self) -> None:
        """Wait for the process to run. Nothing of the agent is loaded yet, so its process is the only one in the sandbox."""
        if self._receive(self._limits.start) != channel.HELLO:
            raise EnvironmentFault(
                f"an agent's process does not start: {self._exit_error()}"
            )  # nothing of it was loaded
        self._pid = self._process.pid if self._first is None else only_child(self._first)
        self._core = SharedCore(self._pid)
        self._group = self._new_group()
        self._isolation = protection(self._launch.sandbox, () if self._group is None else self._group.limited)
        self._watched = Watched(
            ProcessTree(self._pid, self._first), self._limits.memory, self._limits.processes, self._scratch()
        )
        self.times = AnswerTimes(self._watched, self._limits)
        for pid in (self._pid, self._first or self._pid):
            # From outside, by one who may: then nobody inside can lower it again.
            with contextlib.suppress(OSError), open(f"/proc/{pid}/oom_score_adj", "w") as score:
                score.write("1000")
        memory_watch.watch(self._watched)

    def _scratch(self) -> list[str]:
        """Where the folders in memory of a sandbox are found from here."""
        return [] if self._first is None else [f"/proc/{self._pid}/root{place}" for place in (SCRATCH, "/dev/shm")]

    def _new_group(self) -> Group | None:
        """The cgroup of all its processes; None where the machine lets us have none."""
        group = new_group(self._limits, self._launch.sandbox)
        if group is not None:
            try:
                for pid in dict.fromkeys((self._pid, self._first or self._pid)):
                    group.add(pid)
            except OSError:
                group.remove()
                return None
        return group

    def _ask(self, word: bytes, patience: float) -> bytes:
        """Send a request and wait for the reply; an agent that gives none is stopped."""
        if self._requests < 0:
            raise AgentDied("its process has ended")
        nonce = self._nonces.next()
        try:
            os.write(self._requests, word + nonce)
        except BrokenPipeError:
            raise self._exit_error() from None
        except BlockingIOError:
            self.close()
            raise AgentError("it filled the pipe of the evaluator's requests and was stopped") from None
        reply = self._receive(patience)
        if not reply:
            raise self._exit_error()
        reply, echo = reply[:1], reply[1:]
        if echo != nonce or reply not in (channel.DONE, channel.BAD_ACTION, channel.RAISED):
            self.close()
            raise AgentError("it wrote to the evaluator's pipe")
        if reply == channel.RAISED:
            raise AgentRaised(_clean(self._memory.read_text()))
        return reply

    def _bounded(self, add: Callable[[float], None], began: float) -> None:
        """Add the time since `began`; whoever has taken too much in all is stopped."""
        try:
            add(time.perf_counter() - began)
        except AgentTimeout:
            self.close()
            raise

    def _receive(self, patience: float) -> bytes:
        """The agent's reply; empty where its process has ended."""
        deadline, left = time.monotonic() + patience, patience
        while True:
            ready = self._poll.poll(left * 1e3)
            if ready and ready[0][0] == self._replies:  # registered first, so named first
                break
            if time.monotonic() >= deadline:
                self.close()
                raise AgentTimeout(f"it did not answer within {patience:g} s and was stopped")
            if not self._output.drain():
                self._poll.unregister(self._output.descriptor)
            left = max(deadline - time.monotonic(), 0.0)
        return os.read(self._replies, channel.MESSAGE + 1)  # one more, so that what is too much shows

    def _exit_error(self) -> AgentDied:
        """The error of a process that ended: how it did, and what it printed last."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(1.0)
        code = self._process.poll()
        self._output.drain_all()
        said = [line.strip() for line in self.printed.splitlines() if line.strip()]
        excess = self._watched.excess if hasattr(self, "_watched") else None
        if excess is None and self._group is not None and self._group.ran_out_of_memory():
            excess = f"its processes together took more than {self._limits.memory >> 20} MiB of memory"
        self.close()
        if excess is not None:
            return AgentDied(excess)
        last = f"; its last words: {shown(said[-1])}" if said else ""
        return AgentDied(f"its process ended ({_how(code)}){last}")


def _how(code: int | None) -> str:
    if code is None:
        return "or closed its pipe"
    number = -code if code < 0 else code - 128
    if number > 0:
        with contextlib.suppress(ValueError):
            return f"signal {signal.Signals(number).name}"
    return f"exit status {code}"


def _words(seed: np.random.SeedSequence | None) -> list[int] | None:
    return None if seed is None else seed.generate_state(4).tolist()


def _clean(message: Any) -> str:
    """A message of the agent's as one printable line."""
    what = message.get("what") if isinstance(message, dict) else None
    return shown(" ".join((what if isinstance(what, str) else "it gave no reason").split()), 1000)

"""What a child process gives up before it loads anything of an agent; nothing of it can be had again."""

import contextlib
import ctypes
import os
import platform
import signal
from dataclasses import asdict, dataclass
from typing import Any

from airhockey.evaluator.isolation import seccomp
from airhockey.evaluator.isolation.limits import Limits

_PR_SET_PDEATHSIG, _PR_SET_DUMPABLE, _PR_SET_CHILD_SUBREAPER, _PR_CAP_AMBIENT, _CLEAR_ALL = 1, 4, 36, 47, 4
_CAPSET = {"x86_64": 126, "aarch64": 91}
_CAPABILITY_VERSION_3 = 0x20080522


@dataclass(frozen=True)
class Restrictions:
    """What a child is to give up.

    Attributes:
        limits: What it may use.
        user: Number of the user whom it becomes; None to stay who it is.
        sandbox: Whether it runs in a sandbox: then its processes are counted apart from everybody else's.
    """

    limits: Limits
    user: int | None = None
    sandbox: bool = False

    def to_json(self) -> dict[str, Any]:
        """As plain values; `kernel` is for a child that cannot import this module."""
        kernel: dict[str, Any] = {}
        machine = seccomp.MACHINES.get(platform.machine())
        if self.sandbox and machine is not None:
            kernel = {"seccomp": machine.seccomp, "keyctl": machine.keyctl, "capset": _CAPSET[platform.machine()]}
            kernel["program"] = seccomp.program(machine).hex()
        return {"limits": asdict(self.limits), "user": self.user, "sandbox": self.sandbox, "kernel": kernel}

    @classmethod
    def from_json(cls, content: dict[str, Any]) -> "Restrictions":
        """What `to_json` gave."""
        return cls(Limits(**content["limits"]), content["user"], content["sandbox"])

    def apply(self) -> None:
        """Die with the evaluator, be the first to go when memory runs out, keep to the limits, be nobody, ask for little.

        Raises:
            OSError: A right could not be given up.
        """
        libc = ctypes.CDLL(None)
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the evaluator's business
        with contextlib.suppress(OSError), open("/proc/self/oom_score_adj", "w") as score:
            score.write("1000")
        self.limits.apply(count_processes=self.sandbox)
        if self.user is not None:
            os.setgroups([])
            os.setresgid(self.user, self.user, self.user)
            os.setresuid(self.user, self.user, self.user)
        if self.sandbox:
            _drop_capabilities(libc)
            failure = seccomp.apply()
            if failure is not None:
                raise OSError(failure)
        else:
            libc.prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)  # whom its children leave behind stays below it
        if self.user is not None:
            libc.prctl(_PR_SET_DUMPABLE, 1, 0, 0, 0)  # lost with the user
        libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)  # after the user: it is lost with that too


def _drop_capabilities(libc: ctypes.CDLL) -> None:
    """Have no capability, and none to hand on."""
    number = _CAPSET.get(platform.machine())
    if number is None:
        return  # the filter of system calls will say that it knows no such machine
    header = (ctypes.c_uint32 * 2)(_CAPABILITY_VERSION_3, 0)
    none = (ctypes.c_uint32 * 6)()
    libc.syscall.restype = ctypes.c_long
    libc.prctl(_PR_CAP_AMBIENT, _CLEAR_ALL, 0, 0, 0)
    if libc.syscall(ctypes.c_long(number), header, none) != 0:
        raise OSError("capabilities cannot be dropped")

"""How far an agent is kept apart: as asked, or as far as this machine can."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Final, Literal

from airhockey.agents.submission import is_submission
from airhockey.errors import ConfigurationError, unknown
from airhockey.evaluator.isolation.sandbox import why_no_sandbox

Mode = Literal["none", "process", "sandbox"]
MODES: Final = ("none", "process", "sandbox")
REMOTE: Final = "tcp://"
LIMITED: Final = {
    "memory": "memory of all processes together within 0.1 s",
    "processes": "number of processes within 0.1 s",
    "cpu": "busy cores",
}
"""What a cgroup limits -> what is not limited without one."""
_UNPROTECTED: Final = "it can read and write your files, use the network, start processes without end and send signals"


@dataclass(frozen=True)
class Choice:
    """A mode, and what the user should know about it.

    Attributes:
        warning: What is not protected; None if nothing is to be said.
    """

    mode: Mode
    warning: str | None = None


def choose(agent: str, asked: str | None = None) -> Choice:
    """The mode for an agent.

    Args:
        agent: A name of the registry, a path, or tcp://HOST:PORT.
        asked: What the user wants; None for: our own agents here, others in a sandbox, or else in a process.

    Raises:
        ConfigurationError: There is no such mode, or no sandbox on this machine.
    """
    if asked is not None and asked not in MODES:
        raise unknown("isolation", asked, MODES)
    if agent.startswith(REMOTE):
        return Choice("none")
    if asked == "sandbox":
        why = why_no_sandbox()
        if why is not None:
            raise ConfigurationError(
                f"there is no sandbox here: {why}; --isolate process needs nothing, but protects less"
            )
        return Choice("sandbox")
    if asked == "process":
        return Choice("process")
    if asked == "none" or not is_submission(agent):
        return Choice("none")
    why = why_no_sandbox()
    if why is None:
        return Choice("sandbox")
    return Choice("process", f"{agent!r} runs in a process of its own, but without a sandbox ({why}): {_UNPROTECTED}")


def protection(sandbox: bool, by_cgroup: Collection[str]) -> str:
    """How far an agent in a process of its own is kept apart, and what is not limited, as a record says it.

    Args:
        sandbox: Whether it is in one.
        by_cgroup: What the kernel limits for all its processes together, see `cgroup.Group`.
    """
    walls = ["bubblewrap", "seccomp"] if sandbox else []
    if {*LIMITED} - {*by_cgroup} <= (set() if sandbox else {"processes"}):
        kernel = ["cgroup"]
    else:
        kernel = [f"cgroup of {' and '.join(by_cgroup)}"] if by_cgroup else ["rlimits"]
    missing = [
        *([] if sandbox else ["files", "network", "signals"]),
        *(
            what
            for resource, what in LIMITED.items()
            if resource not in by_cgroup and not (sandbox and resource == "processes")
        ),
    ]
    said = f"{'sandbox' if sandbox else 'process'} ({', '.join(walls + kernel)})"
    return f"{said}; not limited: {', '.join(missing)}" if missing else said


def check_python(agent: str, isolate: str, python: str | None) -> None:
    """Only a submission in a process of its own can have another interpreter; raises `ConfigurationError`."""
    if python is not None and (agent.startswith(REMOTE) or not is_submission(agent) or isolate == "none"):
        raise ConfigurationError(
            f"--python is for submissions in a process of their own; {agent!r} runs with the evaluator "
            "(--isolate process or sandbox for a submission)"
        )


def host_and_port(address: str) -> tuple[str, int]:
    """What tcp://HOST:PORT names; raises `ConfigurationError`."""
    host, _, port = address.removeprefix(REMOTE).rstrip("/").rpartition(":")
    if not host or not port.isdigit() or not 0 < int(port) < 65536:
        raise ConfigurationError(
            f"{address!r} is no address of an agent; write tcp://HOST:PORT, as in tcp://127.0.0.1:8080"
        )
    return host.strip("[]"), int(port)

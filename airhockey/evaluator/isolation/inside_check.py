"""Looks around in a sandbox before anybody plays in one: what must not be had is tried for.

    python -P -m airhockey.evaluator.isolation.inside_check RESTRICTIONS CANARY      (JSON; a file of the host)

Prints "sound", or what can be had.
"""

import ctypes
import json
import os
import sys
from pathlib import Path

from airhockey.evaluator.isolation.restrict import Restrictions

SOUND = "sound"
_REMOUNT_BIND = 32 | 4096


def main() -> None:
    """Give up what a child gives up, then look."""
    Restrictions.from_json(json.loads(sys.argv[1])).apply()
    print(what_is_wrong(sys.argv[2]) or SOUND)


def what_is_wrong(canary: str) -> str | None:
    """The first thing that a sandbox must not have; None for a sound one.

    Args:
        canary: A file of the host's that cannot be seen in here.
    """
    status = dict(line.split(":\t", 1) for line in Path("/proc/self/status").read_text().splitlines() if ":\t" in line)
    held = [name for name in ("CapInh", "CapPrm", "CapEff", "CapAmb") if int(status[name], 16)]
    others = [line.split(":")[0].strip() for line in Path("/proc/net/dev").read_text().splitlines()[2:]]
    libc, software = ctypes.CDLL(None), os.path.dirname(os.__file__)
    wrong = {
        f"it holds capabilities ({', '.join(held)})": bool(held),
        "it may gain rights by programs (no_new_privs is not set)": status["NoNewPrivs"].strip() != "1",
        "its system calls are not filtered": status["Seccomp"].strip() != "2",
        "it runs as root": os.geteuid() == 0,
        "it may mount": libc.mount(None, b"/usr", None, _REMOUNT_BIND, None) == 0,
        "it may make namespaces": libc.unshare(0x10000000) == 0,
        f"it has a network ({', '.join(others)})": any(name != "lo" for name in others),
        "it sees the host's files": os.path.exists(canary) or os.path.exists("/etc/shadow"),
        "it may write where software lies": any(os.access(place, os.W_OK) for place in ("/", "/usr", software)),
        "it sees the host's processes": sum(name.isdigit() for name in os.listdir("/proc")) > 3,
    }  # fmt: skip
    return next((what for what, is_so in wrong.items() if is_so), None)


if __name__ == "__main__":
    main()

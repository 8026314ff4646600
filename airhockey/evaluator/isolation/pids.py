"""Which processes are the agent's, by the numbers that they have out here."""

import json
import os
from pathlib import Path


def first_inside(status: int) -> int | None:
    """The number of a sandbox's process 1, from what bubblewrap writes to `--info-fd`; None where it did not get as far."""
    text = b""
    while chunk := os.read(status, 4096):
        text += chunk
        if b"}" in chunk:
            break
    try:
        return int(json.loads(text)["child-pid"])
    except (ValueError, KeyError):
        return None


def only_child(parent: int) -> int:
    """The number of a process's only child; that of the process itself where it has none."""
    try:
        return int(Path(f"/proc/{parent}/task/{parent}/children").read_text().split()[0])
    except (OSError, IndexError):
        pass  # not every kernel has this file
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and f"\nPPid:\t{parent}\n" in (entry / "status").read_text():
                return int(entry.name)
        except OSError:
            continue
    return parent

"""A sample of the attacks of `scripts/attack`, some of each kind; `python scripts/attack` tries them all."""

import subprocess
import sys
from pathlib import Path

import pytest

from airhockey.evaluator.isolation.sandbox import why_no_sandbox

ATTACK = Path(__file__).parents[1] / "scripts" / "attack"


@pytest.mark.parametrize("kind", ["escapes", "cheats", "hijacks", "entries", "fuzz", "kills"])
def test_what_attackers_try_holds(kind: str) -> None:
    if kind in ("escapes", "cheats") and why_no_sandbox() is not None:
        pytest.skip(str(why_no_sandbox()))
    command = [sys.executable, str(ATTACK), "--sample", "--only", kind]
    done = subprocess.run(command, capture_output=True, text=True, timeout=900)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "| **all** | 0 |" not in done.stdout and "| **all** |" in done.stdout

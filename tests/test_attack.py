"""A sample of the attacks of `scripts/attack`, one of each kind that takes seconds."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from airhockey.evaluator.isolation.sandbox import why_no_sandbox

pytestmark = pytest.mark.skipif(os.environ.get("ATTACK") != "1", reason="it takes minutes: ATTACK=1 asks for it")
ATTACK = Path(__file__).parents[1] / "scripts" / "attack"


@pytest.mark.parametrize("kind", ["escapes", "cheats", "hijacks", "entries", "fuzz", "kills"])
def test_what_attackers_try_holds(kind: str) -> None:
    if kind in ("escapes", "cheats") and why_no_sandbox() is not None:
        pytest.skip(str(why_no_sandbox()))
    command = [sys.executable, str(ATTACK), "--sample", "--only", kind]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1500)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "| **all** |" in done.stdout

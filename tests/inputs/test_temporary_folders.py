"""What is unpacked for a process goes away with it, however it ends."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

PROGRAM = """
import os, signal, sys, time
from airhockey.inputs.temporary_folders import temporary_folder
folder = temporary_folder("submission")
(folder / "weights.npz").write_bytes(b"0" * 100)
print(folder, flush=True)
if sys.argv[1] == "raise":
    raise RuntimeError
if sys.argv[1] == "exit":
    sys.exit()
time.sleep(60)
"""


@pytest.mark.parametrize("end", ["exit", "raise", "SIGTERM", "SIGINT", "SIGKILL"])
def test_they_end_with_the_process(tmp_path: Path, end: str) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, end],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env=os.environ | {"TMPDIR": str(tmp_path)},
        start_new_session=True,
    )
    assert process.stdout is not None
    folder = Path(process.stdout.readline().strip())
    assert folder.parent.parent == tmp_path
    if end.startswith("SIG"):
        os.killpg(process.pid, getattr(signal, end))  # the whole group, as a terminal does
    process.wait(20)
    if not end.startswith("SIG"):
        assert list(tmp_path.iterdir()) == []
    deadline = time.monotonic() + 20
    while list(tmp_path.iterdir()) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert list(tmp_path.iterdir()) == []

"""Output that cannot be written stops nothing."""

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest

HOCKEY = [sys.executable, "-c", "from airhockey.cli import main; main()"]


def test_a_full_standard_output_is_one_line() -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run([*HOCKEY, "agents"], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode in (1, 2) and "No space left on device" in done.stderr and "Traceback" not in done.stderr


def test_a_full_standard_error_stops_nothing() -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run([*HOCKEY, "evaluate", "--agent", "nobody"], stdout=subprocess.PIPE, stderr=full)
    assert done.returncode == 2


@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
def test_closed_streams_stop_nothing(closed: str) -> None:
    line = " ".join(f"'{part}'" for part in (*HOCKEY, "agents"))
    done = subprocess.run(["sh", "-c", f"{line} {closed}"], capture_output=True, text=True)
    assert done.returncode == 0 and "Traceback" not in done.stderr


def test_letters_that_a_terminal_does_not_know() -> None:
    environment = {**os.environ, "PYTHONIOENCODING": "ascii", "LC_ALL": "C", "PYTHONUTF8": "0"}
    done = subprocess.run([*HOCKEY, "evaluate", "--help"], capture_output=True, env=environment)
    assert done.returncode == 0 and b"Traceback" not in done.stderr


def test_a_terminal_that_goes_away_stops_nothing(tmp_path: Path) -> None:
    master, slave = pty.openpty()
    code = f"""
import os, signal, sys, time
signal.signal(signal.SIGHUP, signal.SIG_IGN)
from airhockey.cli import be_patient
be_patient()
open({str(tmp_path / "ready")!r}, "w").close()
while not os.path.exists({str(tmp_path / "gone")!r}): time.sleep(0.02)
from rich.console import Console
console = Console(stderr=True)
for _ in range(20):
    console.print("progress")
    print("more", file=sys.stderr, flush=True)
open({str(tmp_path / "done")!r}, "w").close()
"""
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdin=slave, stdout=slave, stderr=slave, start_new_session=True
    )
    os.close(slave)
    while not (tmp_path / "ready").exists():
        assert process.poll() is None
    os.close(master)
    (tmp_path / "gone").touch()
    assert process.wait(60) == 0 and (tmp_path / "done").exists()


def test_a_strangers_text_commands_no_terminal(tmp_path: Path) -> None:
    (tmp_path / "profile.yaml").write_text('"\\e[2J\\u202e[red]": 1\n')
    line = ["evaluate", "--env", "3dof-hit", "--agent", "hold", "--disturbances", str(tmp_path / "profile.yaml")]
    done = subprocess.run([*HOCKEY, *line], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1
    assert "\x1b" not in done.stderr and "\u202e" not in done.stderr


def test_a_thread_that_never_ends_keeps_no_command_alive() -> None:
    code = """
import threading
from airhockey.commands import _threads
_threads.GRACE = 0.1
threading.Thread(target=threading.Event().wait).start()
_threads.end_with(3)
"""
    assert subprocess.run([sys.executable, "-c", code], timeout=60).returncode == 3


def test_ctrl_c_while_modules_are_imported_is_no_traceback() -> None:
    code = """
import sys
class CtrlC:
    def find_spec(self, name, *_):
        if name == "rich.console": raise KeyboardInterrupt
sys.meta_path.insert(0, CtrlC())
from airhockey.cli import main
main()
"""
    done = subprocess.run([sys.executable, "-c", code, "agents"], capture_output=True, text=True)
    assert done.returncode == 130 and done.stderr == ""

"""The viewer in a real browser, served by the command on this machine alone."""

import io
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from tools import chromium

QUIET = (
    "--no-sandbox",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
PATIENCE = 120.0  # [s]: a processor draws what a graphics card is meant for
SCENE = slice(175, 400)  # rows of the picture without the panel


@dataclass
class Served:
    """The command at work."""

    process: "subprocess.Popen[str]"
    address: str
    port: int


@pytest.fixture(scope="module")
def served(run_folder: Path) -> Iterator[Served]:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    line = ["replay", str(run_folder), "--port", str(port), "--no-browser"]
    command = [sys.executable, "-m", "airhockey.cli", *line]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        assert process.stdout is not None
        said = process.stdout.readline()
        address = re.search(rf"http://127.0.0.1:{port}/\?token=\S+", said)
        assert address is not None, said + process.stdout.read()
        yield Served(process, address[0], port)
        process.send_signal(signal.SIGINT)
        rest = process.stdout.read()
        assert process.wait(30) == 0, rest
        assert "Traceback" not in rest, rest


def test_it_listens_on_this_machine_alone(served: Served) -> None:
    rows = [line.split() for name in ("tcp", "tcp6") for line in Path(f"/proc/net/{name}").read_text().splitlines()[1:]]
    listening = [row[1] for row in rows if row[3] == "0A" and row[1].endswith(f":{served.port:04X}")]
    assert listening == [f"0100007F:{served.port:04X}"]
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.2", served.port), timeout=5)


def test_the_page_shows_a_puck_that_moves(served: Served) -> None:
    from playwright.sync_api import sync_playwright

    path = chromium()
    errors: list[str] = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=list(QUIET))
        page = browser.new_page(viewport={"width": 520, "height": 440})
        page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(served.address)
        first = wait_for_scene(page)
        moved = wait_for_scene(page, unlike=first)
        browser.close()
    assert errors == []
    assert puck(first) != puck(moved)


def wait_for_scene(page: Any, unlike: Any = None) -> Any:
    """A picture of the page on which the bright table and the red puck are seen, the puck elsewhere than on another one."""
    until = time.monotonic() + PATIENCE
    while time.monotonic() < until:
        pixels = np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB")).astype(int)[SCENE]
        bright = pixels.min(axis=-1) > 190
        if bright.mean() > 0.1 and puck(pixels) and (unlike is None or puck(pixels) != puck(unlike)):
            return pixels
        time.sleep(0.2)
    raise AssertionError("the page shows no table, or one on which nothing moves")


def puck(pixels: Any) -> tuple[int, int] | None:
    """Where the middle of what is red on the table is, in pixels."""
    red = (pixels[..., 0] > 150) & (pixels[..., 1] < 90) & (pixels[..., 2] < 90)
    rows, columns = np.nonzero(red)
    return (int(np.median(rows)), int(np.median(columns))) if len(rows) > 5 else None


def test_a_port_that_is_taken_is_one_line(served: Served, run_folder: Path) -> None:
    line = ["replay", str(run_folder), "--port", str(served.port), "--no-browser"]
    done = subprocess.run([sys.executable, "-m", "airhockey.cli", *line], capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert str(served.port) in done.stderr and len(done.stderr.splitlines()) == 1

"""How soon a person's mallet follows the pointer in `hockey play`, driven in Chromium.

    python benchmarks/play_latency.py [--moves 60]

A game against `hold` is played in another process. The pointer jumps; measured is the time, in the browser, until the mallet
that the page shows has begun to move towards it (1 mm). The target is a median of at most 60 ms.
"""

import argparse
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

_JUMP = """([x, y]) => new Promise((resolve) => {
  const box = canvas.getBoundingClientRect(), began = performance.now(), before = seen.mallet;
  const place = {clientX: box.left + x * box.width, clientY: box.top + y * box.height, bubbles: true};
  canvas.dispatchEvent(new PointerEvent("pointermove", place));
  const look = () => {
    const moved = Math.hypot(seen.mallet[0] - before[0], seen.mallet[1] - before[1]);
    if (moved > 0.001 || performance.now() - began > 1000) resolve(performance.now() - began); else setTimeout(look, 1);
  };
  look();
})"""


def main() -> None:
    """Play, let the pointer jump, and print the times."""
    from playwright.sync_api import sync_playwright

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--moves", type=int, default=60)
    moves = parser.parse_args().moves
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        line = [
            sys.executable,
            "-m",
            "airhockey.cli",
            "play",
            "hold",
            "--no-browser",
            "--minutes",
            "3",
            "--out",
            f"{folder}/run",
        ]
        with subprocess.Popen(
            line, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, cwd=Path(folder)
        ) as game:
            assert game.stderr is not None
            address = re.search(r"http\S+", game.stderr.readline())
            assert address is not None
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 900, "height": 520}, bypass_csp=True)
            page.goto(address.group())
            page.mouse.move(250, 300)
            page.wait_for_function("seen && seen.puck && seen.step > 100", timeout=300_000)
            times = []
            for number in range(moves):
                place = [0.2 + 0.2 * (number % 2), 0.3 + 0.4 * (number // 2 % 2)]
                times.append(page.evaluate(_JUMP, place))
                page.wait_for_timeout(600)
            browser.close()
            game.terminate()
    times.sort()
    print(f"{moves} moves: median {statistics.median(times):.0f} ms, 90th percentile {times[int(0.9 * moves)]:.0f} ms")


if __name__ == "__main__":
    main()

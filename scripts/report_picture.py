"""Make the picture of a report that the documentation shows: the top of its page, as Chromium draws it.

hockey evaluate --env 7dof-hit --agent thesis --disturbances server --clock cpu --out runs/picture
python scripts/report_picture.py runs/picture docs/images/report.png
"""

import argparse
import shutil
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

from airhockey.reporting import report

WIDTH = 1280


def main() -> None:
    """Make it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path, help="runs, matches or tournaments, and last the PNG file")
    parser.add_argument("--height", type=int, default=1000, help="of the picture, in pixels")
    parser.add_argument("--dark", action="store_true", help="in dark mode")
    given = parser.parse_args()
    *folders, target = given.folders
    page_text, _ = report(folders)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        file = Path(folder) / "report.html"
        file.write_text(page_text, encoding="utf-8")
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        size = {"width": WIDTH, "height": given.height}
        page = browser.new_page(viewport=size, color_scheme="dark" if given.dark else "light")
        page.goto(file.as_uri())
        target.parent.mkdir(parents=True, exist_ok=True)
        page.screenshot(path=target)
        browser.close()
    print(f"wrote {target} ({target.stat().st_size / 1000:.0f} kB)")


if __name__ == "__main__":
    main()

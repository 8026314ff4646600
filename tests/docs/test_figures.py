"""Every figure that a page shows is what its file says, and every file is of a figure that can be measured again."""

import json
from pathlib import Path
from types import ModuleType

import pytest
from sources import load_script

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def figures() -> ModuleType:
    return load_script(ROOT, "figures")


def test_pages_show_what_the_files_say(figures: ModuleType) -> None:
    for page in figures.PAGES:
        text = page.read_text("utf-8")
        assert figures.page_with_figures(text) == text, f"python scripts/figures.py write  # {page.name} is older"


def test_every_mark_has_its_file_and_every_file_its_commands(figures: ModuleType) -> None:
    marked = {mark["name"] for page in figures.PAGES for mark in figures.MARK.finditer(page.read_text("utf-8"))}
    files = {file.stem: json.loads(file.read_text()) for file in figures.FILES.glob("*.json")}
    assert marked <= set(files)
    assert set(files) <= set(figures.FIGURES)
    for kept in files.values():
        assert kept["runs"]
        assert {"measured", "machine", "versions"} <= set(kept)


def test_a_page_of_another_figure_is_noticed(figures: ModuleType) -> None:
    page = ROOT / "README.md"
    text = page.read_text("utf-8")
    mark = figures.MARK.search(text)
    assert mark is not None
    changed = text.replace(mark[0], mark[0].replace("%", "‰", 1).replace("Measured", "Guessed"))
    assert changed != text
    assert figures.page_with_figures(changed) == text

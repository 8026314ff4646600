"""Pages that are written by scripts: those of the rules are what the editions' files give, the reference is of these commands."""

import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
from sources import load_script

from airhockey.envs import editions

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def rules_pages() -> ModuleType:
    return load_script(ROOT, "rules_pages")


def test_the_pages_are_those_of_the_editions(rules_pages: ModuleType) -> None:
    made = rules_pages.pages()
    kept = {file.name: file.read_text("utf-8") for file in (ROOT / "docs" / "rules").iterdir()}
    assert kept == made, "python scripts/rules_pages.py docs/rules"
    assert {f"{year}.md" for year in editions.available()} <= set(made)


def test_the_reference_of_python_is_of_these_docstrings() -> None:
    api_reference = load_script(ROOT, "api_reference")
    kept = {file.name: file.read_text("utf-8") for file in (ROOT / "docs" / "api").iterdir()}
    assert kept == api_reference.pages(), "make docs"
    assert "### make\n\n```python\ndef make(" in kept["environments.md"]
    assert "- `both, only_first, only_second, neither`: " in kept["evaluator.md"]


def test_a_drawing_has_its_regions_on_the_table(rules_pages: ModuleType) -> None:
    for year in editions.available():
        rules = editions.edition(year)
        for name in rules.environments:
            svg = rules_pages.drawing(rules, name)
            width, height = map(float, re.search(r'viewBox="0 0 (\d+) (\d+)"', svg).groups())  # type: ignore[union-attr]
            boxes = [
                tuple(map(float, box))
                for box in re.findall(r'x="([\d.]+)" y="([\d.]+)" width="([\d.]+)" height="([\d.]+)"', svg)
            ]
            assert len(boxes) > len(rules.starts_of(name))
            assert all(x + w <= width and y + h <= height for x, y, w, h in boxes)


def test_the_reference_of_the_command_line_is_of_these_commands(tmp_path: Path) -> None:
    script = [sys.executable, str(ROOT / "scripts" / "command_reference.py"), str(tmp_path / "commands.md")]
    subprocess.run(script, check=True)
    assert (ROOT / "docs" / "commands.md").read_text("utf-8") == (tmp_path / "commands.md").read_text("utf-8"), (
        "make docs"
    )

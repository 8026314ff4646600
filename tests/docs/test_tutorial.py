"""The tutorial, followed to the letter by somebody in a hurry: fewer episodes, shorter games."""

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

TUTORIAL = Path(__file__).parents[2] / "docs" / "tutorial.md"
BLOCK = re.compile(
    r"^```(?P<language>\w+)(?: title=\"(?P<title>[^\"]+)\")?\n(?P<body>.*?)^```$", re.MULTILINE | re.DOTALL
)
HURRY = {"--episodes": "4", "--steps": "60", "--size": "160x90"}
"""Option -> what it gets here for a number or a size; a list of episodes stays."""


def run(line: str, folder: Path) -> str:
    """Run one command line in a folder; gives everything that it prints."""
    program, *words = shlex.split(line)
    assert program == "hockey"
    words = [
        word if "," in word else HURRY.get(before, word) for before, word in zip(["", *words], words, strict=False)
    ]
    one_core = ["--jobs", "1"] if words[0] in ("evaluate", "match", "tournament") and "--show" not in words else []
    ended = subprocess.run(
        [sys.executable, "-m", "airhockey.cli", *words, *one_core],
        cwd=folder,
        env={**os.environ, "COLUMNS": "200"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, f"{line}\n{ended.stdout}"
    return ended.stdout


def lasting_words(block: list[str]) -> list[str]:
    """What a shown output says that is the same for somebody in a hurry: files that were made, where things are stored."""
    return [line for line in block if line.startswith(("stored in ", "my_agent/", "my_agent: "))]


@pytest.mark.long
def test_the_tutorial_does_what_it_says(tmp_path: Path) -> None:
    """Every command succeeds, and the agent that it ends with is better than the one that it starts with."""
    commands = 0
    for block in BLOCK.finditer(TUTORIAL.read_text(encoding="utf-8")):
        if block["title"] is not None:
            assert (tmp_path / block["title"]).exists()  # it says: replace
            (tmp_path / block["title"]).write_text(block["body"])
        if block["language"] == "console":
            for command in re.split(r"^\$ ", block["body"], flags=re.MULTILINE)[1:]:
                line, *shown = command.splitlines()
                printed = run(line, tmp_path)
                assert [said for said in lasting_words(shown) if said not in printed] == []
                commands += 1
    assert commands > 10
    before, after = (json.loads((tmp_path / "runs" / run / "result.json").read_text()) for run in ("before", "after"))
    assert before["success"] < 0.5 < after["success"]
    assert after["penalty"] == 0
    assert (tmp_path / "runs" / "leaderboard" / "index.html").exists()
    assert (tmp_path / "runs" / "after" / "saves.mp4").stat().st_size > 0

"""The organisers' Dockerfile: checked as a file everywhere; built and run in CI where Docker is."""

import json
import os
import re
import shutil
import subprocess
from fnmatch import fnmatch
from pathlib import Path

import click
import pytest
from submission_examples import SUBMISSIONS

from airhockey.cli import hockey

ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "Dockerfile").read_text()
LINES = re.sub(r"\\\n", " ", TEXT).splitlines()
INSTRUCTIONS = [line.split(maxsplit=1) for line in LINES if line.strip() and not line.startswith("#")]


def has_docker() -> bool:
    return (
        shutil.which("docker") is not None and subprocess.run(["docker", "info"], capture_output=True).returncode == 0
    )


def test_it_is_made_of_instructions_and_begins_with_an_image() -> None:
    known = {"FROM", "RUN", "COPY", "ARG", "USER", "WORKDIR", "VOLUME", "ENTRYPOINT", "CMD", "ENV"}
    assert {name for name, _ in INSTRUCTIONS} <= known
    assert re.fullmatch(r"python:3\.1[1-4]-slim", dict(INSTRUCTIONS[:1])["FROM"])


def test_what_it_copies_is_there_and_reaches_the_build() -> None:
    rules = [rule for rule in (ROOT / ".dockerignore").read_text().split() if not rule.startswith("**/")]
    copied = [source for name, rest in INSTRUCTIONS if name == "COPY" for source in rest.split()[:-1]]
    assert {"pyproject.toml", "airhockey"} <= set(copied)
    for source in copied:
        assert (ROOT / source).exists()
        ignored = False
        for rule in rules:
            if fnmatch(source, rule.lstrip("!")):
                ignored = not rule.startswith("!")
        assert not ignored, source
    needed = re.findall(r'^(?:readme|license-files) = "(.*)"', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)
    assert set(needed) <= set(copied)


def test_its_command_is_ours_and_its_user_is_not_root() -> None:
    last = dict(INSTRUCTIONS)
    assert json.loads(last["ENTRYPOINT"]) == ["hockey"] and json.loads(last["CMD"]) == ["--help"]
    assert last["USER"] != "root"
    assert "bubblewrap" in TEXT and "libgl1" in TEXT
    context = click.Context(hockey)
    for command in re.findall(r"hockey (\w+) ", TEXT):
        options = {name for param in hockey.get_command(context, command).params for name in param.opts}  # type: ignore[union-attr]
        used = re.search(rf"hockey {command} ([^&\n]*)", TEXT)
        assert used is not None and set(re.findall(r"--[a-z-]+", used[1])) <= options


@pytest.mark.skipif(not os.environ.get("CI") or not has_docker(), reason="builds an image: in CI, where Docker is")
def test_the_image_evaluates_an_entry_without_network(tmp_path: Path) -> None:
    subprocess.run(["docker", "build", "--quiet", "--tag", "airhockey-test", str(ROOT)], check=True)
    runs = tmp_path / "runs"
    runs.mkdir(mode=0o777)
    runs.chmod(0o777)
    command = ["docker", "run", "--rm", "--network", "none", "-v", f"{SUBMISSIONS / 'template'}:/entry:ro"]
    command += ["-v", f"{runs}:/runs", "airhockey-test", "evaluate", "--agent", "/entry", "--env", "7dof-defend"]
    done = subprocess.run([*command, "--episodes", "1", "--jobs", "1", "--quiet"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert list(runs.iterdir())

"""`hockey doctor` says what works here and what does not, each with its remedy."""

import importlib.metadata
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from airhockey.commands.doctor import EXTRAS, doctor
from airhockey.evaluator.isolation import sandbox


def findings() -> dict[str, dict[str, object]]:
    """What it says, by what it is about."""
    ran = CliRunner().invoke(doctor, ["--json"])
    assert ran.exit_code == 0, ran.output
    return {finding["about"]: finding for finding in json.loads(ran.output)}


def test_it_knows_every_extra_for_users() -> None:
    offered = set(importlib.metadata.metadata("airhockey").get_all("Provides-Extra"))
    assert offered - {"all", "dev", "docs"} == set(EXTRAS)
    assert {f"extra {name}" for name in EXTRAS} <= set(findings())


def test_what_is_missing_comes_with_its_remedy(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    found = importlib.metadata.version

    def version(name: str) -> str:
        if name in ("pettingzoo", "osqp"):
            raise importlib.metadata.PackageNotFoundError(name)
        return found(name)

    monkeypatch.setattr(importlib.metadata, "version", version)
    monkeypatch.setenv("PATH", str(tmp_path))
    sandbox.why_no_sandbox.cache_clear()
    try:
        told = findings()
    finally:
        sandbox.why_no_sandbox.cache_clear()
    assert told["simulation"]["works"]
    assert not told["sandbox"]["works"]
    assert "apt-get install bubblewrap" in str(told["sandbox"]["remedy"])
    for extra, package in (("rl", "pettingzoo"), ("control", "osqp")):
        finding = told[f"extra {extra}"]
        assert not finding["works"]
        assert package in str(finding["told"])
        assert finding["remedy"] == f"pip install 'airhockey[{extra}]'"


def test_people_get_lines() -> None:
    ran = CliRunner().invoke(doctor)
    assert ran.exit_code == 0
    assert all(len(line) < 400 for line in ran.output.splitlines())
    assert "simulation" in ran.output


def test_a_compiler_that_is_disabled_is_reported(tmp_path: Path) -> None:
    told = subprocess.run(
        [sys.executable, "-P", "-m", "airhockey.cli", "doctor", "--json"],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"}, cwd=tmp_path, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert told.returncode == 1, told.stderr
    assert "Traceback" not in told.stderr
    simulation = next(finding for finding in json.loads(told.stdout) if finding["about"] == "simulation")
    assert not simulation["works"]
    assert "unset NUMBA_DISABLE_JIT" in simulation["told"]

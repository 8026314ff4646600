"""The programs on the page of exports run, and what they learn is better than standing still."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from command_line import Hockey

from airhockey.evaluator import Options, begin, evaluate

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "howto" / "export.md"
LEARN, PLAY = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text("utf-8"), re.MULTILINE | re.DOTALL)


def test_the_programs_learn_from_a_data_set_and_play(hockey: Hockey, monkeypatch: pytest.MonkeyPatch) -> None:
    evaluate(begin(Options(environments=("7dof-hit",), agent="hold", episodes=2), Path("hit")))
    assert hockey("export hit --format minari --name airhockey/7dof-hit/planner-v0 -o sets --quiet")[0] == 0
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(Path("sets").resolve()))
    torch.set_num_threads(1)  # two of them wait for each other on a busy machine
    names: dict[str, Any] = {}
    exec(LEARN.replace("range(6000)", "range(30)"), names)
    exec(PLAY, names)
    assert len(names["seen"]) == sum(len(episode.actions) for episode in names["episodes"]) > 100
    assert names["over"] and not names["reward"]
    start = names["env"].reset(seed=1)[0]
    assert np.allclose(names["clone"](start)[0], start[6:13], atol=0.3)  # its teacher stood still


@pytest.mark.long
def test_a_clone_scores_and_who_stands_still_does_not() -> None:
    done = subprocess.run(
        [sys.executable, str(ROOT / "benchmarks" / "behaviour_cloning.py")], capture_output=True, text=True, check=True
    )
    shares = {name: float(share) for name, share in re.findall(r"^(clone|hold) +([\d.]+)%", done.stdout, re.MULTILINE)}
    assert shares["clone"] > shares["hold"] == 0.0

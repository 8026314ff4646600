"""`hockey train ppo` as a user meets it: a run, which is an agent at once, and its picture."""

from pathlib import Path

import pytest
import yaml
from command_line import Hockey

SHORT = "train ppo --task 3dof-defend --envs 4 --rollout 32 --batch 64 --epochs 1 --hidden 8 --threads 1"


@pytest.mark.long
def test_a_runs_folder_is_an_agent(hockey: Hockey) -> None:
    status, out, err = hockey(f"{SHORT} --steps 256 --episodes 2 --out run")
    assert status == 0
    assert "2 unseen episodes: success" in out and "hockey evaluate --agent" in out
    assert "violations" in err
    assert yaml.safe_load(Path("run/card.yaml").read_text())["figures"]["actions"] == 256
    status, out, _ = hockey("evaluate --agent run --env 3dof-defend --episodes 2 --jobs 1 --out played")
    assert status == 0 and "episodes failed by the agent" in out
    status, out, _ = hockey("package run/air_hockey_agent --out mine.zip")
    assert status == 0
    status, _, _ = hockey("evaluate --agent mine.zip --env 3dof-defend --episodes 2 --jobs 1 --out again")
    assert status == 0
    status, out, _ = hockey("plot run")
    assert status == 0 and Path(out.strip()).read_bytes().startswith(b"\x89PNG")
    status, _, err = hockey("train ppo --resume --seed 1 --out run")
    assert status == 2 and "seed 0, not 1" in err

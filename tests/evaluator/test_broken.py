"""A file of a run that is broken is named in one line by whoever reads it, and no reader stops over it in another way."""

from pathlib import Path

import pytest
from command_line import Hockey

from airhockey.errors import ConfigurationError
from airhockey.evaluator import resume

BREAKS = {
    "cut": lambda content: content[: len(content) // 2],
    "empty": lambda content: b"",
    "noise": lambda content: bytes((byte * 31 + k * 7) % 256 for k, byte in enumerate(content)),
    "in the middle": lambda content: content[: len(content) // 3] + bytes(900) + content[len(content) // 3 + 900 :],
    "another": lambda content: b"PK\x03\x04" + content,
}


@pytest.mark.parametrize("how", BREAKS)
def test_a_finished_run(hockey: Hockey, how: str) -> None:
    assert hockey("evaluate --env 3dof-defend --agent hold --episodes 2 --jobs 1 --quiet --out run")[0] == 0
    file = Path("run/trajectories.h5")
    file.write_bytes(BREAKS[how](file.read_bytes()))
    for line in ("evaluate --resume --out run --quiet", "report run --quiet", "replay run --no-browser --episode 9"):
        status, _, err = hockey(line)
        assert "Traceback" not in err
        assert status in (0, 2), err
    if how != "in the middle":
        with pytest.raises(ConfigurationError, match=r"trajectories\.h5"):
            resume(Path("run"))


def test_a_checkpoint_of_sac(hockey: Hockey) -> None:
    pytest.importorskip("stable_baselines3")
    assert hockey("train sac --task home --robot 3dof --steps 40 --warm-up 20 --episodes 1 --quiet --out run")[0] == 0
    checkpoint = Path("run/checkpoint.pkl")
    whole = checkpoint.read_bytes()
    for content in (whole[:1000], b"", b"\x80\x05c" + whole[:50]):
        checkpoint.write_bytes(content)
        status, _, err = hockey("train sac --resume --out run --quiet")
        assert (status, err.count("\n")) == (2, 1), err
        assert "checkpoint.pkl" in err

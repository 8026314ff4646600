"""The command line in an empty folder."""

from pathlib import Path

import pytest
from command_line import Hockey

from airhockey.cli import main


@pytest.fixture
def hockey(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Hockey:
    """Runs a command line in an empty folder; gives status, standard output and standard error."""
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")

    def run(line: str) -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as end:
            main(line.split())
        out, err = capfd.readouterr()
        return int(end.value.code or 0), out, err

    return run

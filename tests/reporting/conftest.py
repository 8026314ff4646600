"""Results to report on."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from results import Results, make_results


@pytest.fixture(scope="session")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return make_results(tmp_path_factory.mktemp("played"))


@pytest.fixture
def copy(tmp_path: Path) -> Callable[..., Path]:
    """Copies a folder of results, to be spoilt."""

    def copied(folder: Path, name: str = "copy") -> Path:
        return Path(shutil.copytree(folder, tmp_path / name))

    return copied

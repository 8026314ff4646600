"""A trajectory file may be a stranger's: it shows nothing but what it holds itself."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from airhockey.evaluator.runs.disk import opened_hdf5
from airhockey.evaluator.runs.game_trajectories import read_film

NAME = "base_observations"


def _external_data(file: Any, host: Path) -> None:
    file.create_dataset(NAME, (1, 4), "f8", external=[(str(host), 0, 32)])


def _virtual_data(file: Any, host: Path) -> None:
    layout = h5py.VirtualLayout((1, 4), "f8")
    layout[:] = h5py.VirtualSource(str(host.with_suffix(".h5")), "secret", (1, 4))
    file.create_virtual_dataset(NAME, layout)


def _external_link(file: Any, host: Path) -> None:
    file[NAME] = h5py.ExternalLink(str(host.with_suffix(".h5")), "secret")


def _soft_link(file: Any, _: Path) -> None:
    file["rows"] = np.zeros((1, 4))
    file[NAME] = h5py.SoftLink("/rows")


def _nothing_that_is_terabytes(file: Any, _: Path) -> None:
    file.create_dataset(NAME, (1 << 40, 4), "f8", chunks=(1024, 4), fillvalue=0.0)


def _a_group_in_itself(file: Any, _: Path) -> None:
    file[NAME] = np.zeros((1, 4))
    again = file.create_group("again")
    again["again"] = again


@pytest.mark.parametrize(
    "make",
    [
        _external_data,
        _virtual_data,
        _external_link,
        _soft_link,
        _nothing_that_is_terabytes,
        _a_group_in_itself,
    ],
)
def test_what_points_elsewhere_is_refused(tmp_path: Path, make: Callable[[Any, Path], None]) -> None:
    host = tmp_path / "host.bin"
    host.write_bytes(b"a secret of 32 bytes of the host")
    with h5py.File(host.with_suffix(".h5"), "w") as file:
        file["secret"] = np.ones((1, 4))
    with h5py.File(tmp_path / "film.h5", "w") as file:
        make(file, host)
    with pytest.raises(OSError, match=r"HDF5|packed"):
        read_film(tmp_path / "film.h5")


def test_what_packs_well_is_read(tmp_path: Path) -> None:
    rows = np.zeros((200_000, 46), dtype=np.float32)
    with h5py.File(tmp_path / "film.h5", "w") as file:
        file.create_dataset(NAME, data=rows, chunks=True, compression="gzip", compression_opts=9, shuffle=True)
    with opened_hdf5(tmp_path / "film.h5") as file:
        assert file[NAME].nbytes == rows.nbytes

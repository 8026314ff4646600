"""Compiled code that others left beside the source is used where nothing can be written, instead of compiled again.

The child's environment names `BesideTheSource` in NUMBA_CACHE_LOCATOR_CLASSES; numba imports it from here.
"""

import contextlib
import os
import pathlib
from typing import Any

from numba.core import caching


class BesideTheSource(caching.InTreeCacheLocator):
    """The `__pycache__` of a read-only package, if it holds compiled code."""

    def ensure_cache_path(self) -> None:
        """Nothing to ensure: what cannot be written can be read."""

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> Any:
        """A locator for a function whose cache is there; None for numba to try the next kind."""
        folder = pathlib.Path(py_file).parent / "__pycache__"
        there = folder.is_dir() and any(folder.glob(f"{pathlib.Path(py_file).stem}.{py_func.__name__}-*.nbi"))
        return cls(py_func, py_file) if there and not os.access(folder, os.W_OK) else None


def _save_if_possible(self: Any, key: Any, data: Any) -> None:
    with contextlib.suppress(OSError):
        _save(self, key, data)


_save = caching.IndexDataCacheFile.save
caching.IndexDataCacheFile.save = _save_if_possible

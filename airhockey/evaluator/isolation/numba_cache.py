"""Compiled code that others left beside the source is used where nothing can be written, instead of compiled again.

The child's environment names `ReadOnlyCache` in NUMBA_CACHE_LOCATOR_CLASSES; numba imports it from here.
"""

import contextlib
import os
from typing import Any

from numba.core import caching


class ReadOnlyCache(caching.UserProvidedCacheLocator):
    """The folder that `airhockey.envs.compiling` chose, if it holds compiled code and cannot be written."""

    def ensure_cache_path(self) -> None:
        """Nothing to ensure: what cannot be written can be read."""

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> Any:
        """A locator for a function whose cache is there; None for numba to try the next kind."""
        locator = super().from_function(py_func, py_file)
        if locator is None:
            return None
        folder = locator.get_cache_path()
        return locator if os.path.isdir(folder) and not os.access(folder, os.W_OK) else None


def _save_if_possible(self: Any, key: Any, data: Any) -> None:
    with contextlib.suppress(OSError):
        _save(self, key, data)


_save = caching.IndexDataCacheFile.save
caching.IndexDataCacheFile.save = _save_if_possible

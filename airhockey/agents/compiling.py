"""One decorator, so that every compiled function of the agents is compiled in the same way."""

import pathlib

from airhockey.envs.compiled import cache_folder, chain_sources, compiler

_FOLDER = pathlib.Path(__file__).parent

_SOURCES = [*_FOLDER.rglob("*.py"), *chain_sources]

CACHE = cache_folder(_FOLDER, _SOURCES)
"""Folder of the agents' compiled code."""
compiled = compiler(_FOLDER, _SOURCES, error_model="numpy")
"""Compile a function of an agent: it may allocate and return arrays. A division by zero is infinite, as in NumPy."""
in_place = compiler(_FOLDER, _SOURCES, error_model="numpy", _nrt=False)
"""The same for a function that neither makes nor returns arrays: without reference counts it compiles in half the time."""

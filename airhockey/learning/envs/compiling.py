"""One decorator for the compiled functions of the learner's environments, which call agents' and the batch's."""

import pathlib

from airhockey.envs.compiled import compiler

_FOLDER = pathlib.Path(__file__).parent
_PACKAGE = _FOLDER.parent.parent
_SOURCES = [
    *_FOLDER.glob("*.py"),
    *(_PACKAGE / "agents").rglob("*.py"),
    *(file for folder in ("vector", "kernel", "tasks") for file in (_PACKAGE / "envs" / folder).glob("*.py")),
    _PACKAGE / "envs" / "specs.py",
]

allocating = compiler(_FOLDER, _SOURCES, error_model="numpy")
"""Compile a function that is given a few arrays: it may make others, but returns none.

It must have been called once before a `compiled` one that calls it is compiled, or numba takes that one's options for it:
each module has a `warm_up` for that.
"""
compiled = compiler(_FOLDER, _SOURCES, error_model="numpy", _nrt=False)
"""Compile a function that is given whole environments. Counting references to all their arrays would take minutes to compile."""
inlined = compiler(_FOLDER, _SOURCES, error_model="numpy", _nrt=False, inline="always")
"""The same for a function with one caller, into which it is copied: a call would have hundreds of arguments."""

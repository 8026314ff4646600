"""One decorator for the batch's compiled functions, which call those of the control step and of the referees."""

import pathlib

from airhockey.envs.compiling import compiler

_FOLDER = pathlib.Path(__file__).parent
_ENVS = _FOLDER.parent

_SOURCES = [file for folder in ("vector", "kernel", "tasks") for file in (_ENVS / folder).glob("*.py")]

compiled = compiler(_FOLDER, [*_SOURCES, _ENVS / "specs.py"], error_model="numpy", _nrt=False)
"""Compile a function of the batch."""

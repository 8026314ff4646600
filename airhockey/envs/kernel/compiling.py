"""One decorator, so that every function of the control step is compiled in the same way."""

import pathlib

from airhockey.envs.compiling import compiler

_FOLDER = pathlib.Path(__file__).parent

# Reference counting (`_nrt`) is off: passing named tuples of arrays between functions would count for a tenth of a step.
# So these functions allocate no arrays and return none; they write to those they are given.
# Fast-math stays off: it would let the compiler reorder sums, and results must not depend on the machine's vector width.
compiled = compiler(_FOLDER, [*_FOLDER.glob("*.py"), _FOLDER.parent / "specs.py"], error_model="numpy", _nrt=False)
"""Compile a function of the control step."""

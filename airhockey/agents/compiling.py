"""One decorator, so that every compiled function of the agents is compiled in the same way."""

import pathlib

from airhockey.envs import specs
from airhockey.envs.compiling import compiler
from airhockey.envs.kernel import chain

_FOLDER = pathlib.Path(__file__).parent

compiled = compiler(_FOLDER, [*_FOLDER.rglob("*.py"), pathlib.Path(specs.__file__), pathlib.Path(chain.__file__)])
"""Compile a function of an agent: it may allocate and return arrays."""

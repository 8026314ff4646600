"""The command line as a function."""

from collections.abc import Callable

Hockey = Callable[[str], tuple[int, str, str]]
"""Runs a command line; gives exit status, standard output and standard error."""

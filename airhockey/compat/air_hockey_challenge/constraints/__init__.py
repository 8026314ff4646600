"""Constraints as functions of the joints."""

from .constraints import *  # noqa: F403 - as the official package does
from .constraints import __all__ as __all__

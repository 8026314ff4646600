"""Copies of what holds addresses and views: Python's default would let the copy move the original."""

import copy
from typing import TypeVar

Object = TypeVar("Object", bound="Copyable")


class Copyable:
    """An object whose `__getstate__` leaves out addresses and views and whose `__setstate__` makes them anew.

    So it can be pickled, also into another process; and its copies are real ones, whichever way they are asked for.
    """

    def copy(self: Object) -> Object:
        """A copy of its own, with the same future; the original is left as it is."""
        return copy.deepcopy(self)

    def __copy__(self: Object) -> Object:
        return copy.deepcopy(self)

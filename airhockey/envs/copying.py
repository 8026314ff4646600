"""Copies of what holds addresses and views: Python's default would let the copy move the original."""

import copy
from typing import Any, NoReturn, TypeVar

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


class NotCopyable:
    """An object that holds something of the operating system's, of which there can be no second one: copying is refused."""

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        """Asked by `copy` and `pickle` alike."""
        raise TypeError(
            f"a {type(self).__name__} cannot be copied or pickled: it holds an open process, connection, lock or file; "
            "make another one"
        )

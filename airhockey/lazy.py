"""Attributes of packages that are imported when they are first asked for (PEP 562)."""

import importlib
from collections.abc import Mapping
from typing import Any


def attribute(package: str, name: str, homes: Mapping[str, str]) -> Any:
    """What a package offers.

    Args:
        package: Its name.
        name: Of the attribute.
        homes: Name -> module that has it.

    Raises:
        AttributeError: It offers no such thing.
        ImportError: The module cannot be imported; `from package import name` would hide an AttributeError of the module's own.
    """
    if name not in homes:
        raise AttributeError(f"module {package!r} has no attribute {name!r}")
    module = homes[name]
    try:
        return getattr(importlib.import_module(module), name)
    except AttributeError as error:
        raise ImportError(f"cannot import {module!r}: AttributeError: {error}") from error

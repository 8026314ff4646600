"""Importing a submission's code: its root first on the path, its folder known as `air_hockey_agent` whatever it is called."""

import contextlib
import functools
import importlib
import importlib.util
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

from airhockey.agents.packaging.checkout import BUILDER, PACKAGE, Checkout
from airhockey.agents.packaging.missing import missing_module
from airhockey.errors import AirHockeyError, ConfigurationError
from airhockey.inputs.temporary_folders import temporary_folder

_current: list[Checkout] = []
"""The submission whose modules imports find, if there is one."""


def load_builder(checkout: Checkout) -> Callable[..., Any]:
    """Import `agent_builder.py`, anew for every agent, and give its `build_agent`.

    Raises:
        ConfigurationError: It cannot be imported, or defines no such function.
        MissingDependencyError: It imports a package that is not installed.
    """
    make_importable(checkout)
    file = checkout.package / BUILDER
    name = f"{PACKAGE}.{file.stem}"
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise ConfigurationError(f"cannot import {str(file)!r}")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    with explaining(checkout, module):
        spec.loader.exec_module(module)
    builder = getattr(module, "build_agent", None)
    if not callable(builder):
        raise ConfigurationError(f"{str(file)!r} defines no function build_agent(env_info, **kwargs)")
    return builder  # type: ignore[no-any-return]


def make_importable(checkout: Checkout) -> None:
    """Let imports find this submission's modules, and no longer those of the one before.

    What the one before has imported stays with it; what it has yet to import is lost to it, unless it runs in a process of
    its own (`hockey evaluate --isolate process`).
    """
    if _current == [checkout] and PACKAGE in sys.modules:
        return
    while _current:
        _forget(_current.pop())
    _current.append(checkout)
    sys.path[:0] = map(str, checkout.import_path)
    sys.path.append(_known_to_children(checkout.package))
    importlib.invalidate_caches()
    init = checkout.package / "__init__.py"
    if not init.is_file():
        package = ModuleType(PACKAGE)
        package.__path__ = [str(checkout.package)]
        sys.modules[PACKAGE] = package
        return
    spec = importlib.util.spec_from_file_location(PACKAGE, init, submodule_search_locations=[str(checkout.package)])
    assert spec is not None and spec.loader is not None
    sys.modules[PACKAGE] = package = importlib.util.module_from_spec(spec)
    with explaining(checkout, package):
        spec.loader.exec_module(package)


@contextlib.contextmanager
def at_the_root(checkout: Checkout) -> Iterator[None]:
    """The root is the working directory, and the first place where children of this process look for modules."""
    before, path = os.getcwd(), os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([*_for_children(checkout), *([path] if path else [])])
    os.chdir(checkout.root)
    try:
        yield
    finally:
        os.chdir(before)
        os.environ.pop("PYTHONPATH") if path is None else os.environ.update(PYTHONPATH=path)


def _for_children(checkout: Checkout) -> list[str]:
    """What children look through first; the package's own folder is none of it, as they know the package by its name."""
    return [str(folder) for folder in checkout.import_path if folder in (checkout.root, checkout.root / "src")]


@contextlib.contextmanager
def explaining(checkout: Checkout, module: ModuleType | None = None) -> Iterator[None]:
    """What a submission's code fails with names the submission; the module that failed is not there any more."""
    try:
        yield
    except BaseException as error:
        if module is not None:
            sys.modules.pop(module.__name__, None)
        if isinstance(error, ModuleNotFoundError):
            raise missing_module(checkout, error) from error
        if module is None or isinstance(error, AirHockeyError) or not isinstance(error, Exception):
            raise
        what = f"{type(error).__name__}: {error}"
        raise ConfigurationError(f"cannot import {str(module.__file__)!r}: {what}") from error


@functools.cache
def _known_to_children(package: Path) -> str:
    """A folder from which processes that the agent spawns can import the package, by the name that it has here."""
    if package.name == PACKAGE:
        return str(package.parent)
    folder = temporary_folder("names")
    (folder / PACKAGE).symlink_to(package)
    return str(folder)


def _forget(checkout: Checkout) -> None:
    """Modules of this submission are no longer found."""
    folders = {*map(str, checkout.import_path), _known_to_children(checkout.package)}
    sys.path[:] = [entry for entry in sys.path if entry not in folders]
    gone = [
        name
        for name, module in list(sys.modules.items())
        if name.partition(".")[0] == PACKAGE or any(place.is_relative_to(checkout.root) for place in _places(module))
    ]
    for name in gone:
        del sys.modules[name]


def _places(module: ModuleType | None) -> list[Path]:
    """The file of a module, or the folders of a package without `__init__.py`."""
    file = getattr(module, "__file__", None)
    if isinstance(file, str):
        return [Path(file)]
    spec = getattr(module, "__spec__", None)
    try:
        return [Path(folder) for folder in (getattr(spec, "submodule_search_locations", None) or ())]
    except KeyError:  # the package around it is gone
        return []

"""A function that builds agents, as a submission's folder that other processes can load."""

import inspect
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

from airhockey.agents.packaging.checkout import BUILDER, CONFIG, PACKAGE
from airhockey.errors import ConfigurationError

_SOURCE = '''"""Calls a builder that lives elsewhere."""

import importlib.util
import sys

sys.path[:0] = {path!r}
_spec = importlib.util.spec_from_file_location({module!r}, {file!r})
_module = importlib.util.module_from_spec(_spec)
sys.modules[{module!r}] = _module
_spec.loader.exec_module(_module)
build_agent = _module.{name}
'''


def as_submission(builder: Callable[..., Any], folder: Path, arguments: dict[str, Any]) -> Path:
    """Write a submission that calls `builder` with `arguments`.

    Args:
        builder: A function at the top level of a file.
        folder: Made here.
        arguments: Plain values, which go to its `agent_config.yml`.

    Raises:
        ConfigurationError: The builder is no such function, or an argument is no plain value.
    """
    file = inspect.getsourcefile(builder)
    name = getattr(builder, "__name__", "")
    if file is None or not Path(file).is_file() or "." in getattr(builder, "__qualname__", "."):
        raise ConfigurationError(
            f"{builder!r} is not a function at the top level of a file, so no other process can load it"
        )
    module = "official_agent_builder" if builder.__module__ == "__main__" else builder.__module__
    package = folder / PACKAGE
    package.mkdir(parents=True)
    path = [str(Path(file).resolve().parent), *(entry for entry in sys.path if entry)]
    source = _SOURCE.format(path=path, module=module, file=str(Path(file).resolve()), name=name)
    (package / BUILDER).write_text(source, encoding="utf-8")
    try:
        (package / CONFIG).write_text(yaml.safe_dump(arguments), encoding="utf-8")
    except yaml.YAMLError as error:
        raise ConfigurationError(f"an argument of the agent is no plain value: {error}") from None
    return folder

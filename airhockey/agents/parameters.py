"""Parameters in YAML: read, checked against a frozen dataclass, and turned into one.

A parameter file holds one mapping; nested dataclasses are nested mappings. Every field must be there unless it has a
default, and nothing else may. A NamedTuple that compiled code takes may stand for a dataclass: what of it has a default is no
parameter, but filled in by the program. A `tuple[float, ...]` field may fix its length by `field(metadata={"length": 4})`.
"""

import dataclasses
import math
from pathlib import Path
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from airhockey.errors import ConfigurationError, unknown
from airhockey.inputs.plain_yaml import read_yaml

T = TypeVar("T")


def load_parameters(schema: type[T], source: str | Path, folder: Path) -> T:
    """Read a parameter file.

    Args:
        schema: The dataclass that describes the file.
        source: Name of a file that comes with the package ("tuned", "tuned.yaml"), or the path of a file.
        folder: Where the package's own files lie.

    Raises:
        ConfigurationError: No such file, not YAML, an unknown or a missing key, a value of the wrong type or length.
    """
    path = _find(source, folder)
    return convert(schema, read_yaml(path), path.name)


def convert(schema: type[T], content: Any, where: str) -> T:
    """Build a parameter dataclass from plain data.

    Args:
        schema: The dataclass.
        content: What YAML gave.
        where: Named in error messages: the file, and within it the key.

    Raises:
        ConfigurationError: As for `load_parameters`.
    """
    if not isinstance(content, dict):
        raise ConfigurationError(f"{where}: expected a mapping of parameters, not {content!r}")
    fields = _fields(schema)
    hints = get_type_hints(schema)
    for key in content:
        if key not in fields:
            raise unknown(f"parameter in {where}", key, fields)
    values = {}
    for name, (required, length) in fields.items():
        if name in content:
            values[name] = _value(hints[name], content[name], f"{where}: {name}", length)
        elif required:
            raise ConfigurationError(f"{where}: the parameter {name!r} is missing")
    return schema(**values)


def _is_schema(hint: Any) -> bool:
    return isinstance(hint, type) and (dataclasses.is_dataclass(hint) or hasattr(hint, "_field_defaults"))


def _fields(schema: type[Any]) -> dict[str, tuple[bool, int | None]]:
    """The parameters of a schema: whether each must be there, and the length of a list, where it is fixed."""
    if not dataclasses.is_dataclass(schema):
        defaults = getattr(schema, "_field_defaults")  # noqa: B009 - a NamedTuple's, which `type` does not know of
        return {name: (True, None) for name in getattr(schema, "_fields") if name not in defaults}  # noqa: B009
    missing = dataclasses.MISSING
    return {
        field.name: (field.default is missing and field.default_factory is missing, field.metadata.get("length"))
        for field in dataclasses.fields(schema)
    }


def _find(source: str | Path, folder: Path) -> Path:
    own = sorted(path.stem for path in folder.glob("*.yaml"))
    name = str(source).removesuffix(".yaml")
    if name in own:
        return folder / f"{name}.yaml"
    path = Path(source).expanduser()
    if path.is_file():
        return path
    raise unknown("parameter file", str(source), (*own, "or the path of a YAML file"))


def _value(hint: Any, value: Any, where: str, length: int | None) -> Any:
    if _is_schema(hint):
        return convert(hint, value, where)
    if get_origin(hint) is tuple:
        element = get_args(hint)[0]
        if not isinstance(value, list):
            raise ConfigurationError(f"{where}: expected a list, not {value!r}")
        if length is not None and len(value) != length:
            raise ConfigurationError(f"{where}: expected {length} values, not {len(value)}: {value!r}")
        return tuple(_value(element, item, f"{where}[{index}]", None) for index, item in enumerate(value))
    if hint is float:
        value = _number(value)
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise ConfigurationError(f"{where}: expected a finite number, not {value!r}")
        return float(value)
    if not isinstance(value, hint) or (hint is int and isinstance(value, bool)):
        raise ConfigurationError(f"{where}: expected a value of type {hint.__name__}, not {value!r}")
    return value


def _number(value: Any) -> Any:
    """YAML 1.1 reads 1e5 and 1.0e5 as text; people mean the number."""
    if isinstance(value, str):
        try:
            return float(value)
        except ValueError:
            return value
    return value

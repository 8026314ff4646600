"""`--set PART.NAME=VALUE`: players that are built meanwhile have other parameters than their files say.

A part is a dataclass of parameters that players ask for by its name: `control`, of the joint controller, or `thesis`, of the
rule-based player. A name may lead into nested parameters: `thesis.defend.predict=false`.
"""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, get_type_hints

from airhockey.errors import ConfigurationError, unknown
from airhockey.inputs.plain_yaml import load_yaml

_settings: ContextVar[tuple[tuple[str, Any], ...]] = ContextVar("settings", default=())


@contextmanager
def settings_in_use(settings: Sequence[str]) -> Iterator[None]:
    """Players that are built meanwhile have other parameters.

    Args:
        settings: As in "control.solver=osqp".

    Raises:
        ConfigurationError: A setting has no such form.
    """
    token = _settings.set(tuple(map(parsed, settings)))
    try:
        yield
    finally:
        _settings.reset(token)


def parsed(setting: str) -> tuple[str, Any]:
    """Name and value of a setting as in "control.solver=osqp"; raises `ConfigurationError` for another form."""
    name, equals, value = setting.partition("=")
    if not equals or "." not in name:
        raise ConfigurationError(f"--set {setting!r}: write PART.NAME=VALUE, as in control.solver=osqp")
    return name, load_yaml(value, f"--set {name}")


def check(settings: Sequence[str], parts: Mapping[str, type]) -> None:
    """Find the mistakes in the names of settings.

    Args:
        settings: As in "control.solver=osqp".
        parts: Part -> the dataclass of its parameters.

    Raises:
        ConfigurationError: A setting has another form, or names what there is not.
    """
    for setting in settings:
        way, _ = parsed(setting)
        schema: Any = parts
        for step in way.split("."):
            names = schema if isinstance(schema, Mapping) else _fields(schema)
            if step not in names:
                raise unknown(f"name in --set {setting!r}:", step, names)
            schema = names[step]


def _fields(schema: type) -> dict[str, type]:
    return get_type_hints(schema) if dataclasses.is_dataclass(schema) else {}


def asked_of(part: str) -> dict[str, Any]:
    """Name within a part -> value, of the settings in use."""
    return {name.removeprefix(f"{part}."): value for name, value in _settings.get() if name.startswith(f"{part}.")}


def with_settings(content: Mapping[str, Any], settings: Mapping[str, Any]) -> dict[str, Any]:
    """Plain parameters with some replaced; a new name is kept for the schema to complain about."""
    result = dict(content)
    for name, value in settings.items():
        first, dot, rest = name.partition(".")
        inner = result.get(first)
        result[first] = with_settings(inner if isinstance(inner, Mapping) else {}, {rest: value}) if dot else value
    return result


def plain(parameters: Any) -> dict[str, Any]:
    """A dataclass of parameters as it would stand in a file."""
    values: dict[str, Any] = _bare(dataclasses.asdict(parameters))
    return values


def _bare(values: Any) -> Any:
    if isinstance(values, dict):
        return {name: _bare(value) for name, value in values.items() if value is not None}
    return list(values) if isinstance(values, tuple) else values

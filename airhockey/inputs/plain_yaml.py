"""The only reader of YAML: plain values, within bounds, and every fault is one line that says where it is.

Differs from YAML 1.1 as PyYAML reads it where that surprises: `1e-3` is a number, `12:30` and `2024-02-30` are texts. Refused
are aliases (ten lines of them unfold to gigabytes), tags, keys that stand twice, numbers without end and nesting without end.
"""

import math
import os
import re
from collections.abc import Hashable
from pathlib import Path
from typing import Any

import yaml

from airhockey.errors import ConfigurationError
from airhockey.inputs.names import is_text

MAX_BYTES = 256 << 10
"""No configuration is larger, in bytes."""
MAX_DEPTH = 32
MAX_VALUES = 10_000
MAX_DIGITS = 40
_INT = re.compile(r"[-+]?(?:0|[1-9][0-9_]*|0x[0-9a-fA-F_]+|0o[0-7_]+|0[0-9_]+)")
_FLOAT = re.compile(
    r"[-+]?(?:[0-9][0-9_]*\.[0-9_]*|\.[0-9][0-9_]*|[0-9][0-9_]*(?=[eE]))(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)"
)
_PLAIN = "tag:yaml.org,2002:"
_KINDS = {_PLAIN + kind for kind in ("null", "bool", "int", "float", "str", "seq", "map")}


def read_yaml(path: str | os.PathLike[str]) -> Any:
    """What a file says; None for an empty one.

    Raises:
        ConfigurationError: It cannot be read, or is not plain YAML within the bounds.
    """
    try:
        with Path(path).open("rb") as file:
            raw = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ConfigurationError(f"cannot read {os.fspath(path)!r}: {reason}") from None
    return load_yaml(raw, os.fspath(path))


def load_yaml(content: str | bytes, source: str, aliases: bool = False) -> Any:
    """What a text says; None for an empty one.

    Args:
        content: The text, or its bytes in UTF-8.
        source: Named in messages: a file.
        aliases: Allow them: only for files of this package.

    Raises:
        ConfigurationError: It is not plain YAML within the bounds.
    """
    try:
        if len(content) > MAX_BYTES:
            raise ConfigurationError(f"it is larger than {MAX_BYTES >> 10} KiB; no configuration is")
        text = content if isinstance(content, str) else content.decode("utf-8-sig")
        return yaml.load(text, _LoaderWithAliases if aliases else _Loader)  # a SafeLoader
    except ConfigurationError as error:
        raise ConfigurationError(f"cannot read {source!r}: {error}") from None
    except UnicodeDecodeError as error:
        raise ConfigurationError(f"cannot read {source!r}: it is not UTF-8 text (byte {error.start})") from None
    except Exception as error:  # whatever a parser raises on bytes that somebody made up
        raise ConfigurationError(f"{source!r} is not valid YAML: {' '.join(str(error).split())[:300]}") from None


class _Loader(yaml.SafeLoader):
    """Plain values only."""

    aliases = False

    def __init__(self, stream: str) -> None:
        super().__init__(stream)
        self._depth = self._values = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        event: yaml.Event = self.peek_event()  # type: ignore[no-untyped-call]
        if isinstance(event, yaml.AliasEvent) and not self.aliases:
            raise _refused(event, f"the alias *{event.anchor} is not allowed; write the value out")
        self._depth += 1
        self._values += 1
        if self._depth > MAX_DEPTH:
            raise _refused(event, f"it is nested more than {MAX_DEPTH} deep")
        if self._values > MAX_VALUES:
            raise _refused(event, f"it has more than {MAX_VALUES} values")
        node: Any = super().compose_node(parent, index)
        self._depth -= 1
        if node.tag not in _KINDS:
            raise _refused(node, f"the tag {node.tag.removeprefix(_PLAIN)!r} is not allowed; write plain values")
        if isinstance(node, yaml.ScalarNode) and not is_text(node.value):
            raise _refused(
                node, "a text with half a letter in it (a surrogate): no file can hold it; write the whole letter"
            )
        return node

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Hashable, Any]:
        """A mapping whose keys are plain values that stand once."""
        mapping: dict[Hashable, Any] = {}
        for key_node, value_node in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                raise _refused(key_node, "a key must be a name, not a list or a mapping")
            key: Any = self.construct_object(key_node, deep=True)
            if key in mapping:
                raise _refused(key_node, f"the key {key!r} stands twice")
            mapping[key] = self.construct_object(value_node, deep=deep)
        return mapping

    def construct_int(self, node: Any) -> int:
        """An integer of a bounded length."""
        text = _digits(node)
        return int(text, 0) if re.match(r"[-+]?0[xo]", text) else int(text)

    def construct_float(self, node: Any) -> float:
        """A floating-point number; one too large for the machine is refused, not infinite."""
        text = _digits(node).lower()
        if text.lstrip("+-") in (".inf", ".nan"):
            return float(text.replace(".", ""))
        value = float(text)
        if math.isinf(value):
            raise _refused(node, f"the number {text} is too large")
        return value


def _mapping(loader: _Loader, node: Any) -> Any:
    return loader.construct_mapping(node, deep=True)


def _sequence(loader: _Loader, node: Any) -> Any:
    return loader.construct_sequence(node, deep=True)


def _digits(node: Any) -> str:
    if len(node.value) > MAX_DIGITS:
        raise _refused(node, f"a number of {len(node.value)} characters; {MAX_DIGITS} are allowed")
    return str(node.value).replace("_", "")


def _refused(where: Any, why: str) -> ConfigurationError:
    return ConfigurationError(f"line {where.start_mark.line + 1}, column {where.start_mark.column + 1}: {why}")


def _resolvers() -> dict[Any, list[tuple[str, re.Pattern[str]]]]:
    """PyYAML's, without dates, merges and numbers of base 60, and with all floats."""
    kept: dict[Any, list[tuple[str, re.Pattern[str]]]] = {}
    for letter, rules in yaml.SafeLoader.yaml_implicit_resolvers.items():
        for tag, pattern in rules:
            if tag in (_PLAIN + "null", _PLAIN + "bool"):
                kept.setdefault(letter, []).append((tag, pattern))
    for letter in "-+.0123456789":
        kept.setdefault(letter, [])
        kept[letter] += [(_PLAIN + "float", _whole(_FLOAT)), (_PLAIN + "int", _whole(_INT))]
    return kept


def _whole(pattern: re.Pattern[str]) -> re.Pattern[str]:
    return re.compile(rf"(?:{pattern.pattern})\Z")


_Loader.yaml_implicit_resolvers = _resolvers()
_Loader.add_constructor(_PLAIN + "map", _mapping)
_Loader.add_constructor(_PLAIN + "seq", _sequence)
_Loader.add_constructor(_PLAIN + "int", _Loader.construct_int)
_Loader.add_constructor(_PLAIN + "float", _Loader.construct_float)


class _LoaderWithAliases(_Loader):
    """For files of this package."""

    aliases = True

"""What decides a run's result and lies in files that may change: agents, parameters; known by their content."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import msgspec

from airhockey.agents.registry import AGENTS
from airhockey.errors import ConfigurationError
from airhockey.inputs.hashing import content_hash
from airhockey.inputs.names import is_text, shown

AGENTS_FIELDS = frozenset(("agent", "second_agent", "home", "away"))
"""Options that say who plays."""
KEPT_WHOLE = frozenset(("disturbances",))
"""Options whose files' content is in the manifest itself."""


def in_full(options: Any, field: str = "") -> Any:
    """The same options, with agents and parameters that are named by relative paths named by full ones.

    Raises:
        ConfigurationError: A text is none that a manifest can hold.
    """
    if isinstance(options, msgspec.Struct):
        values = {name: getattr(options, name) for name in options.__struct_fields__}
        full = {name: in_full(value, name) for name, value in values.items()}
        return options if full == values else msgspec.structs.replace(options, **full)
    if isinstance(options, tuple):
        return tuple(in_full(item, field) for item in options)
    if isinstance(options, str) and not is_text(options):
        raise ConfigurationError(f"{shown(options)} is not UTF-8 text, so no manifest can name it; rename it")
    is_path = isinstance(options, str) and (field in AGENTS_FIELDS or (field == "parameters" and "." in options))
    if not is_path or options in AGENTS or not Path(options).expanduser().exists():
        return options
    return str(Path(options).expanduser().resolve())


def hashes_of(options: Any) -> dict[str, str]:
    """The path of every file and folder that options name -> the SHA-256 of its content.

    Raises:
        ConfigurationError: One cannot be read, or a folder holds a link.
    """
    return {path: content_hash(path) for path in dict.fromkeys(_paths(options))}


def check_unchanged(path: Path, began_with: Mapping[str, str]) -> None:
    """What a run began with must be what there is now.

    Args:
        path: Of the run's folder, for the message.
        began_with: From `hashes_of`, when it began.

    Raises:
        ConfigurationError: A file or a folder is another, or gone; it is named.
    """
    for name, before in began_with.items():
        if not Path(name).exists():
            raise ConfigurationError(f"the run in {str(path)!r} began with {shown(name)!r}, which is gone; put it back")
        now = content_hash(name)
        if now != before:
            raise ConfigurationError(
                f"the run in {str(path)!r} began with another content of {shown(name)!r} (SHA-256 {before[:12]}…, now "
                f"{now[:12]}…): one result would come from two; put that content back, or begin a new run with another --out"
            )


def _paths(value: Any, field: str = "") -> Iterator[str]:
    """Every text in options that is the full path of something."""
    if field in KEPT_WHOLE:
        return
    if isinstance(value, msgspec.Struct):
        for name in value.__struct_fields__:
            yield from _paths(getattr(value, name), name)
    elif isinstance(value, (tuple, list)):
        for item in value:
            yield from _paths(item)
    elif isinstance(value, str) and value.startswith("/") and Path(value).exists():
        yield value

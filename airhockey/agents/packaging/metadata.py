"""`submission.yaml`: who made a submission, what it plays, and what it needs."""

import os
import re
from pathlib import Path
from typing import Any

import msgspec

from airhockey.agents.registry import EVERY_ENVIRONMENT
from airhockey.envs.editions import edition
from airhockey.errors import ConfigurationError, unknown
from airhockey.inputs import plain_yaml
from airhockey.inputs.names import shown
from airhockey.inputs.packages import is_installed

METADATA = "submission.yaml"
_NAME = re.compile(r"[a-z0-9][a-z0-9_.-]{0,63}")
_REQUIREMENT = re.compile(r"\s*([A-Za-z0-9][A-Za-z0-9._-]*)\s*(\[[A-Za-z0-9,._ -]*\])?\s*([<>=!~][^;@]*)?")


class Metadata(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What `submission.yaml` says.

    Attributes:
        name: Lower-case letters, digits, `-`, `_` and `.`.
        version: The authors' own numbering.
        authors: Names, with an address if they like.
        packages: Requirements as pip writes them, beyond airhockey itself.
        interpolation_order: 1, 2, 3, 4, 5, -1, or "none" for whole trajectories.
        tasks: Names of the environments that it plays.
        edition: The year whose rules it was written for, where its tasks do not say so.
    """

    name: str
    version: str = "0.1.0"
    authors: tuple[str, ...] = ()
    packages: tuple[str, ...] = ()
    interpolation_order: int | str | None = 3
    tasks: tuple[str, ...]
    edition: str | None = None

    def check(self) -> None:
        """Find values that have no meaning; raises `ConfigurationError`."""
        if not _NAME.fullmatch(self.name):
            raise ConfigurationError(
                f"{METADATA}: the name {self.name!r} is not usable; lower-case letters, digits, '-', '_' and '.' are"
            )
        for task in self.tasks:
            if task not in EVERY_ENVIRONMENT:
                raise unknown(f"task in {METADATA}", task, EVERY_ENVIRONMENT)
        if not self.tasks:
            raise ConfigurationError(f"{METADATA}: tasks is empty; name some of {', '.join(EVERY_ENVIRONMENT)}")
        if self.edition is not None:
            edition(self.edition)
        for requirement in self.packages:
            if not _REQUIREMENT.fullmatch(requirement):
                raise ConfigurationError(
                    f"{METADATA}: {requirement!r} is not a package requirement, as in 'scipy>=1.11'"
                )
        interpolation_order(self.interpolation_order)

    @property
    def missing_packages(self) -> tuple[str, ...]:
        """Requirements of which no version at all is installed."""
        return tuple(requirement for requirement in self.packages if not _is_installed(requirement))


def interpolation_order(value: Any) -> int | None:
    """An order as YAML gives it; people write None and null for whole trajectories.

    Raises:
        ConfigurationError: There is no such order.
    """
    if value in (None, "None", "none"):
        return None
    if isinstance(value, int) and not isinstance(value, bool) and value in (1, 2, 3, 4, 5, -1):
        return value
    raise ConfigurationError(f"unknown interpolation order {value!r}; allowed: 1, 2, 3, 4, 5, -1, none")


def read_yaml(file: Path) -> dict[str, Any]:
    """A file's mapping of names to values; empty for an empty file. Tags are refused: only plain values are loaded.

    Raises:
        ConfigurationError: The file is not YAML, too large, or not a mapping with text keys.
    """
    content = plain_yaml.read_yaml(file)
    if content is None:
        return {}
    if not isinstance(content, dict) or not all(isinstance(key, str) for key in content):
        raise ConfigurationError(f"{str(file)!r} must hold a mapping of names to values")
    return content


def read_yaml_if_there(file: Path) -> dict[str, Any] | None:
    """As `read_yaml`; None where there is nothing of this name.

    Raises:
        ConfigurationError: As `read_yaml`, or it is a folder, a pipe or the like.
    """
    if file.is_file():
        return read_yaml(file)
    if os.path.lexists(file):
        raise ConfigurationError(f"{shown(file)!r} is no file; put a file there, or nothing")
    return None


def read_metadata(folder: Path) -> Metadata | None:
    """What a submission says of itself; None where it has no `submission.yaml`.

    Args:
        folder: The one with `agent_builder.py`, or the one around it.

    Raises:
        ConfigurationError: The file is not usable.
    """
    for place in (folder, folder.parent):
        content = read_yaml_if_there(place / METADATA)
        if content is not None:
            try:
                metadata = msgspec.convert(content, Metadata)
            except msgspec.ValidationError as error:
                raise ConfigurationError(
                    f"{METADATA}: {error}; its keys are {', '.join(Metadata.__struct_fields__)}"
                ) from None
            metadata.check()
            return metadata
    return None


def _is_installed(requirement: str) -> bool:
    match = _REQUIREMENT.fullmatch(requirement)
    return match is not None and is_installed(match[1])

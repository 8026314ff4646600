"""What reading a file raises whose bytes are not what they were, or that is somebody else's; one set for every reader."""

import contextlib
import pickle
import struct
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path

from airhockey.errors import ConfigurationError

BROKEN = (
    OSError,
    EOFError,
    LookupError,
    ValueError,  # msgspec's, json's and Unicode's, too
    TypeError,
    AttributeError,
    ArithmeticError,
    RuntimeError,
    MemoryError,
    struct.error,
    zlib.error,
    zipfile.BadZipFile,
    pickle.UnpicklingError,
)


@contextlib.contextmanager
def reading_errors(path: Path) -> Iterator[None]:
    """What reading a broken file raises, as an error of ours that names it."""
    try:
        yield
    except ConfigurationError:
        raise
    except BROKEN as error:
        raise ConfigurationError(f"cannot read {str(path)!r}: {reason(error, path.parent)}") from error


def check_size(path: Path, most: int) -> None:
    """Before a file is read whole; raises `ConfigurationError` for one that is larger, in bytes, than what it claims to be."""
    size = path.stat().st_size
    if size > most:
        raise ConfigurationError(f"{str(path)!r} has {size} bytes; {most} are allowed")


def reason(error: BaseException, folder: Path) -> str:
    """What went wrong in a folder, in a line, without the folder's path, which stands beside it."""
    said = getattr(error, "strerror", None) or str(error) or type(error).__name__
    return " ".join(said.replace(f"{folder}/", "").split())[:200]

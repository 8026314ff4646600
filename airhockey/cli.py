"""The `hockey` command. This module imports next to nothing, so that Ctrl-C finds it at work from the very beginning."""

import sys
from collections.abc import Sequence
from typing import Any

from airhockey.lazy import attribute

INTERRUPTED = 130
_HOMES = {"hockey": "airhockey.commands._group", "be_patient": "airhockey.commands._streams"}


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line, and end with its exit status."""
    try:
        from airhockey.commands._group import run

        run(arguments)
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)


def __getattr__(name: str) -> Any:
    return attribute(__name__, name, _HOMES)


if __name__ == "__main__":
    main()

"""The commands of `hockey`, run by functions of the official package that do what a command does."""

import subprocess
import sys


def hockey(*arguments: str) -> None:
    """Run a command in a process of its own; raises `subprocess.CalledProcessError` where it fails."""
    code = "import sys; from airhockey.cli import main; sys.exit(main())"
    subprocess.run([sys.executable, "-P", "-c", code, *arguments], check=True)

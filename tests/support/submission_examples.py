"""Where the example submissions lie."""

from pathlib import Path

EXAMPLES = Path(__file__).parents[1] / "submissions" / "examples"
SUBMISSIONS = Path(__file__).parents[2] / "submissions"
ZOO = EXAMPLES.parent / "zoo"

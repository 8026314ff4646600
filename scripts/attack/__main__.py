"""Attacks the product, and says what held.

    python scripts/attack                       everything; takes hours on one core
    python scripts/attack --sample              some of each kind; half a minute
    python scripts/attack --only escapes kills  these kinds
    python scripts/attack --keep build/attack --table docs/security.md
                                                write the table there, with what other calls have kept of other kinds

Runs on this machine, against this checkout only, in folders and sandboxes of its own. Exit status 1: something did not hold.
"""

import argparse
import importlib
import json
import os
import sys
import time
from pathlib import Path

import product
from verdicts import BAD, HELD, Outcomes, outcomes, table

KINDS = ("escapes", "cheats", "hijacks", "entries", "fuzz", "kills")
BEGIN, END = "<!-- the table of scripts/attack -->\n", "<!-- end of the table -->\n"


def main() -> int:
    """Attack, print what did not hold and the table."""
    parser = argparse.ArgumentParser(prog="python scripts/attack", description=__doc__.splitlines()[0])
    parser.add_argument("--sample", action="store_true", help="some of each kind")
    parser.add_argument("--only", nargs="+", choices=KINDS, default=KINDS, metavar="KIND", help=", ".join(KINDS))
    parser.add_argument(
        "--name", metavar="PART", default="", help="only attacks whose name holds this, where a kind can be cut"
    )
    parser.add_argument("--verbose", action="store_true", help="say what held, too")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="keep there what every attack ended in")
    parser.add_argument("--table", type=Path, metavar="FILE", help="put the table into this page, where its mark is")
    given = parser.parse_args()
    os.environ.pop("PYTHONSAFEPATH", None)  # whoever calls may have it; this folder's own scripts import each other
    product.adopt_orphans()
    product.WANTED = given.name
    kept: dict[str, Outcomes] = {}
    held_all = True
    for kind in given.only:
        began = time.monotonic()
        verdicts = []
        for verdict in importlib.import_module(kind).attack(given.sample):
            verdicts.append(verdict)
            held_all = held_all and verdict.outcome not in BAD
            if given.verbose or verdict.outcome != HELD:
                print(f"{verdict.outcome:9} {verdict.kind}: {verdict.name}: {verdict.detail}", flush=True)
        file = None if given.keep is None else given.keep / f"{kind}.json"
        again = given.name and file is not None and file.exists()  # then those of other names stay as they are
        kept[kind] = outcomes(verdicts, json.loads(file.read_text()) if again and file is not None else {})
        if file is not None:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(json.dumps(kept[kind], indent=1))
        print(f"{kind}: {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)
    if given.keep is not None:
        kept = {file.stem: json.loads(file.read_text()) for file in given.keep.glob("*.json")} | kept
    shown = table([kept[kind] for kind in KINDS if kind in kept])
    print(shown)
    if given.table is not None:
        _write(given.table, shown)
    return int(not held_all)


def _write(page: Path, shown: str) -> None:
    """Replace the table of a page."""
    before, begin, rest = page.read_text().partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise SystemExit(f"{page} has no lines {BEGIN.strip()!r} and {END.strip()!r} to put the table between")
    page.write_text(f"{before}{BEGIN}\n{shown}\n\n{END}{after}")


if __name__ == "__main__":
    sys.exit(main())

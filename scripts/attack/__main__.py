"""Attacks the product, and says what held.

    python scripts/attack                       everything; takes hours on one core
    python scripts/attack --sample              some of each kind; minutes
    python scripts/attack --only escapes kills  these kinds

Runs on this machine, against this checkout only, in folders and sandboxes of its own. Exit status 1: something did not hold.
"""

import argparse
import sys
import time

import product
from verdicts import BAD, HELD, Verdict, table

KINDS = ("escapes", "cheats", "hijacks", "entries", "fuzz", "kills")


def main() -> int:
    """Attack, print what did not hold and the table."""
    parser = argparse.ArgumentParser(prog="python scripts/attack", description=__doc__.splitlines()[0])
    parser.add_argument("--sample", action="store_true", help="some of each kind")
    parser.add_argument("--only", nargs="+", choices=KINDS, default=KINDS, metavar="KIND", help=", ".join(KINDS))
    parser.add_argument("--verbose", action="store_true", help="say what held, too")
    given = parser.parse_args()
    product.adopt_orphans()
    verdicts: list[Verdict] = []
    for kind in given.only:
        began = time.monotonic()
        for verdict in __import__(kind).attack(given.sample):
            verdicts.append(verdict)
            if given.verbose or verdict.outcome != HELD:
                print(f"{verdict.outcome:9} {verdict.kind}: {verdict.name}: {verdict.detail}", flush=True)
        print(f"{kind}: {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)
    print(table(verdicts))
    return int(any(verdict.outcome in BAD for verdict in verdicts))


if __name__ == "__main__":
    sys.exit(main())

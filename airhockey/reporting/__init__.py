"""Reports: what runs, matches and tournaments left behind, as pages for people.

from airhockey.reporting import report
page, notes = report([Path("runs/7dof-prepare-planner-s0")])

A page is one HTML file without scripts, without images and without anything to fetch. Its drawings are inline SVG made here:
they take the page's colours (dark mode, print), scale to a phone, carry text alternatives, and weigh kilobytes where a
plotting library would weigh megabytes.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from airhockey.reporting.document import report
    from airhockey.reporting.leaderboard import write_site

_HOMES = {"report": "document", "write_site": "leaderboard"}

__all__ = ["report", "write_site"]


def __getattr__(name: str) -> Any:
    """Import what the layer offers when it is first asked for (PEP 562)."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"airhockey.reporting.{_HOMES[name]}"), name)

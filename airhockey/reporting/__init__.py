"""Reports: what runs, matches and tournaments left behind, as pages for people.

from airhockey.reporting import report
page, notes = report([Path("runs/7dof-prepare-planner-s0")])

A page is one HTML file without scripts, without images and without anything to fetch. Its drawings are inline SVG made here:
they take the page's colours (dark mode, print), scale to a phone, carry text alternatives, and weigh kilobytes where a
plotting library would weigh megabytes.
"""

from typing import TYPE_CHECKING, Any

from airhockey.lazy import attribute

if TYPE_CHECKING:
    from airhockey.reporting.document import report
    from airhockey.reporting.leaderboard import write_site

_HOMES = {"report": "document", "write_site": "leaderboard"}

__all__ = ["report", "write_site"]


def __getattr__(name: str) -> Any:
    """Import what the layer offers when it is first asked for (PEP 562)."""
    return attribute(__name__, name, {one: f"{__name__}.{home}" for one, home in _HOMES.items()})

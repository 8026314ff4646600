"""`hockey failures`: the episodes that went wrong, counted by cause and listed."""

import json
from pathlib import Path
from typing import TYPE_CHECKING

import rich_click as click

if TYPE_CHECKING:
    from rich.table import Table

    from airhockey.evaluator.analysis.failures import Failure

MOST = 20


@click.command()
@click.argument("run", metavar="RUN", type=click.Path(path_type=Path))
@click.option("--all", "everything", is_flag=True, help=f"List every one.  [default: the first {MOST}]")
@click.option("--json", "as_json", is_flag=True, help="Print them as JSON.")
def failures(run: Path, everything: bool, as_json: bool) -> None:
    """List the episodes of RUN that went wrong: not achieved, limits violated, or the agent failed.

    \b
    hockey failures runs/7dof-hit-planner-s0
    hockey failures runs/7dof-hit-planner-s0 --json | jq '.[].index'
    hockey replay runs/7dof-hit-planner-s0 --failed
    hockey video runs/7dof-hit-planner-s0 --failed -o failed.mp4
    """
    import msgspec

    from airhockey.commands._session import MOST_NOTES, say_notes
    from airhockey.commands._tables import output
    from airhockey.errors import ConfigurationError
    from airhockey.evaluator.analysis import failures as analysis
    from airhockey.evaluator.runs.reader import Run, open_source
    from airhockey.inputs.names import markup

    source = open_source(run)
    if not isinstance(source, Run):
        why = (
            "; ".join(source.notes)
            or "it is a match or a tournament, and games have a winner and events: hockey report"
        )
        raise ConfigurationError(f"there are no episodes in {str(run)!r}: {why}")
    say_notes(source.notes, MOST_NOTES)
    found = analysis.failures(source)
    listed = found if everything or as_json else found[:MOST]
    described = [analysis.described(source, record) for record in listed]
    if as_json:
        click.echo(json.dumps(msgspec.to_builtins(described), indent=2))
        return
    console = output()
    console.print(f"{len(found)} of {len(source.records)} episodes went wrong")
    for env, cause, number in analysis.by_cause(found):
        console.print(f"  {number:5}  {markup(f'{env}: {cause}')}")
    if not found:
        return
    console.print(_table(described, several=len(source.environments) > 1))
    if len(listed) < len(found):
        console.print(f"and {len(found) - len(listed)} more (--all)")
    console.print(f"look at them: hockey replay {run} --failed", markup=False)


def _table(described: "list[Failure]", several: bool) -> "Table":
    """A row for each; what stands in a folder may be a stranger's text."""
    from rich.table import Table

    from airhockey.inputs.names import markup

    table = Table("episode", "puck at", "with", "lasted", "what")
    for failure in described:
        where = how = "–"
        if failure.start is not None:
            x, y, x_speed, y_speed = failure.start
            where, how = f"({x:.2f}, {y:+.2f}) m", f"({x_speed:+.2f}, {y_speed:+.2f}) m/s"
        what = ", ".join(failure.causes) + (f" ({failure.told[:100]})" if failure.told else "")
        name = f"{failure.env}/{failure.index}" if several else str(failure.index)
        table.add_row(markup(name), where, how, f"{failure.seconds:.2f} s", markup(what))
    return table

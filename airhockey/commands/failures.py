"""`hockey failures`: the episodes that went wrong, counted by cause and listed."""

import json
from pathlib import Path

import rich_click as click

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
    from rich.table import Table

    from airhockey.commands._session import MOST_NOTES, say_notes
    from airhockey.commands._tables import output
    from airhockey.errors import ConfigurationError
    from airhockey.evaluator.analysis import failures as analysis
    from airhockey.evaluator.runs.reader import Run, open_source

    source = open_source(run)
    if not isinstance(source, Run):
        why = (
            "; ".join(source.notes)
            or "it is a match or a tournament, and games have a winner and events: hockey report"
        )
        raise ConfigurationError(f"there are no episodes in {str(run)!r}: {why}")
    say_notes(source.notes, MOST_NOTES)
    found = analysis.failures(source)
    if as_json:
        click.echo(json.dumps(msgspec.to_builtins(found), indent=2))
        return
    console = output()
    console.print(f"{len(found)} of {len(source.records)} episodes went wrong")
    for env, cause, number in analysis.by_cause(found):
        console.print(f"  {number:5}  {env}: {cause}", markup=False)
    if not found:
        return
    table = Table("episode", "puck at", "with", "lasted", "what", title=None)
    several = len(source.environments) > 1
    shown = found if everything else found[:MOST]
    for failure in shown:
        name = f"{failure.env}/{failure.index}" if several else str(failure.index)
        x, y, x_speed, y_speed = failure.start or (None,) * 4
        table.add_row(
            name,
            "–" if x is None else f"({x:.2f}, {y:+.2f}) m",
            "–" if x is None else f"({x_speed:+.2f}, {y_speed:+.2f}) m/s",
            f"{failure.seconds:.2f} s",
            ", ".join(failure.causes) + (f" ({failure.told[:100]})" if failure.told else ""),
        )
    console.print(table)
    if len(shown) < len(found):
        console.print(f"and {len(found) - len(shown)} more (--all)")
    console.print(f"look at them: hockey replay {run} --failed", markup=False)

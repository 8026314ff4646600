"""`hockey check-trajectory`: whether an arm may follow a joint trajectory."""

from pathlib import Path
from typing import TYPE_CHECKING

import rich_click as click

from airhockey.commands import HELP_PAGE

if TYPE_CHECKING:
    from airhockey.exporting.limit_checks import Verdict

VIOLATED = 3
MOST = 20


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.argument("files", metavar="FILE…", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--json", "as_json", is_flag=True, help="Print the verdicts as one JSON object by file, and nothing else."
)
@click.pass_context
def check_trajectory(ctx: click.RichContext, files: tuple[Path, ...], as_json: bool) -> None:
    """Check joint trajectories, as `hockey export --format csv-joints` or ros2 writes them, against the arm's limits.

    Positions and velocities within 95 % of the arm's, as in the challenge; accelerations within the arm's; the mallet over the
    table and at its height, wrist and elbow above theirs: at every point, and on the cubics between the points. The arm is the
    one with as many joints. The first violation of every kind is named.

    Exit status 3: there are violations.

    For example:

    \b
    hockey export runs/7dof-hit-planner-s0 --format csv-joints --episodes 3 -o arm
    hockey check-trajectory arm/3.csv
    hockey check-trajectory arm/*.csv --json | jq 'map_values(.violations | length)'
    """
    import msgspec

    from airhockey.exporting.joint_trajectory import read_trajectory
    from airhockey.exporting.limit_checks import check

    verdicts: dict[str, Verdict] = {}
    for path in files:
        verdicts[str(path)] = verdict = check(read_trajectory(path))
        if not as_json:
            _print(path, verdict)
    if as_json:
        click.echo(msgspec.json.encode(verdicts))
    ctx.exit(VIOLATED if any(verdict.violations for verdict in verdicts.values()) else 0)


def _print(path: Path, verdict: "Verdict") -> None:
    """What was found, in lines; the names in a file are a stranger's."""
    from airhockey.inputs.names import shown

    kinds = len(verdict.violations)
    found = f"violates {kinds} limit{'s' if kinds != 1 else ''}" if kinds else "within every limit"
    click.echo(f"{path}: {verdict.points} points, {verdict.seconds:.2f} s, {verdict.robot}: {found}")
    for violation in verdict.violations[:MOST]:
        where = f"at {violation.time:.3f} s (from point {violation.point})"
        size = f"{violation.value:+.4g} {violation.unit}, allowed {violation.allowed:.4g} {violation.unit}"
        more = f"; after {violation.points} points in all" if violation.points > 1 else ""
        click.echo(f"  {shown(violation.what)}: {size}, {where}{more}")

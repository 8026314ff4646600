"""`hockey validate`: is a submission fit to be handed in?"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import rich_click as click

from airhockey.commands import _options as common

if TYPE_CHECKING:
    from airhockey.evaluator.validation import Verdict

PROBLEMS = 3


@click.command()
@click.argument("path", metavar="DIR|FILE", type=click.Path(path_type=Path))
@click.option("--steps", type=click.IntRange(min=1), default=50, show_default=True, help="Control steps of every task.")
@common.options(common.edition, *common.ISOLATION, common.python)
@common.options(common.as_json)
@click.pass_context
def validate(ctx: click.RichContext, /, **given: Any) -> None:
    """Load a submission apart from everything, play a few steps of every task it claims, and say what to mend.

    The last line is the verdict: plays, or does not play because of what, whose cause that is, and what to do.

    Exit status 3: there are problems; each is printed with its remedy.

    \b
    hockey validate my_agent
    hockey validate path/to/a/checkout
    hockey validate my_agent-0.1.0.zip --steps 500
    """
    common.typed_options(ctx, given)
    from airhockey.commands._session import python_of, say_what_is_not_protected
    from airhockey.errors import ConfigurationError
    from airhockey.evaluator.isolation.limits import Limits
    from airhockey.evaluator.isolation.modes import choose
    from airhockey.evaluator.validation import validate

    path, patience = given["path"], given["patience"]
    if not path.exists():
        raise ConfigurationError(f"there is no {str(path)!r}; name a submission's folder or archive")
    agent = str(path.resolve())
    mode = choose(agent, given["isolate"]).mode
    say_what_is_not_protected((agent,), given["isolate"])
    limits = Limits(patience=patience, start=max(patience, Limits.start))
    verdict = validate(path, mode, limits, given["steps"], python_of(given["python"]), given["edition"])
    ctx.exit(_print(verdict, given["as_json"]))


def _print(verdict: "Verdict", as_json: bool) -> int:
    """The verdict; gives the exit status."""
    import msgspec

    count = len(verdict.problems)
    if as_json:
        click.echo(msgspec.json.encode(verdict))
        return PROBLEMS if count else 0
    for trial in verdict.trials:
        click.echo(
            f"{trial.env:12} {trial.steps} steps; draw_action {trial.median * 1e3:.2f} ms (median), "
            f"{trial.longest * 1e3:.2f} ms (longest), {trial.first * 1e3:.2f} ms (first); loaded in {trial.start:.1f} s"
        )
    for name, why in verdict.left_out.items():
        click.echo(f"left out by hockey package: {name} ({why})")
    for problem in verdict.problems:
        click.echo(f"problem in {problem.where}: {problem.what}\n  remedy: {problem.remedy}")
    for note in verdict.notes:
        click.echo(f"note: {note}")
    click.echo(verdict.conclusion)
    return PROBLEMS if count else 0

"""`hockey validate`: is a submission fit to be handed in?"""

from pathlib import Path
from typing import Any

import rich_click as click

from airhockey.commands._isolation import isolation_options


@click.command()
@click.argument("path", metavar="DIR|FILE", type=click.Path(path_type=Path))
@click.option("--steps", type=click.IntRange(min=1), default=50, show_default=True, help="Control steps of every task.")
@isolation_options
@click.option("--json", "as_json", is_flag=True, help="Print the verdict as one JSON object, and nothing else.")
@click.pass_context
def validate(ctx: click.RichContext, /, **given: Any) -> None:
    """Load a submission apart from everything, play a few steps of every task it claims, and say what to mend.

    Exit status 3: there are problems; each is printed with its remedy.

    \b
    hockey validate my_agent
    hockey validate my_agent-0.1.0.zip --steps 500
    """
    from airhockey.commands._validation import run

    ctx.exit(run(given))

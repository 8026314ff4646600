"""`hockey new`: a submission to start from."""

from pathlib import Path

import rich_click as click


@click.command()
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
def new(folder: Path) -> None:
    """Make a submission that works: an agent that follows the puck, its configuration and its description.

    DIR must not exist or be empty. What `submission.yaml` needs to know is explained in it.

    \b
    hockey new my_agent
    hockey validate my_agent
    hockey evaluate --agent my_agent --task hit --episodes 20
    """
    from airhockey.agents.packaging.template_folder import make

    for file in make(folder):
        click.echo(f"{folder / file}")

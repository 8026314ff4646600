"""`hockey agents`: who there is to play."""

import rich_click as click


@click.command()
def agents() -> None:
    """List the agents that come with the package, and what each one plays."""
    from airhockey.agents import AGENTS

    width = max(map(len, AGENTS))
    for entry in AGENTS.values():
        click.echo(f"{entry.name:{width}}  {entry.summary}  [{', '.join(entry.environments)}]")

"""`hockey serve-agent`: an agent behind a TCP port."""

from typing import Any

import rich_click as click

from airhockey.commands._isolation import isolation_options


@click.command(name="serve-agent")
@click.argument("agent", metavar="AGENT")
@click.option(
    "--host", default="127.0.0.1", show_default=True, help="Address to listen on; loopback is this machine only."
)
@click.option(
    "--port", type=click.IntRange(0, 65535), default=8080, show_default=True, help="Port; 0 for any free one."
)
@click.option("--env", default="tournament", show_default=True, metavar="NAME", help="Environment that it will play.")
@click.option("--agent-id", type=click.IntRange(1, 2), default=1, show_default=True, help="Which robot it plays.")
@click.option("--games", type=click.IntRange(min=1), help="End after so many connections.  [default: never]")
@isolation_options
def serve_agent(**given: Any) -> None:
    """Offer an agent to players elsewhere, in the protocol of the challenge's Docker images.

    There is no password: whoever reaches the port can play. The agent's interpolation order is printed; the other side must use
    the same.

    \b
    hockey serve-agent thesis --env 7dof-hit --port 8080
    hockey evaluate --env 7dof-hit --agent tcp://127.0.0.1:8080        (elsewhere)
    """
    from airhockey.commands._serving import run

    run(given)

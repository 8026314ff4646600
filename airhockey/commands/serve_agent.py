"""`hockey serve-agent`: an agent behind a TCP port."""

import contextlib
from pathlib import Path
from typing import Any

import rich_click as click

from airhockey.commands import _options as common


@click.command(name="serve-agent")
@click.argument("agent", metavar="AGENT")
@click.option(
    "--host", default="127.0.0.1", show_default=True, help="Address to listen on; loopback is this machine only."
)
@click.option(
    "--port", type=click.IntRange(0, 65535), default=8080, show_default=True, help="Port; 0 for any free one."
)
@click.option("--env", default="tournament", show_default=True, metavar="NAME", help="Environment that it will play.")
@common.options(common.edition)
@click.option("--agent-id", type=click.IntRange(1, 2), default=1, show_default=True, help="Which robot it plays.")
@click.option("--games", type=click.IntRange(min=1), help="End after so many connections.  [default: never]")
@common.options(*common.ISOLATION)
@click.pass_context
def serve_agent(ctx: click.RichContext, /, **given: Any) -> None:
    """Offer an agent to players elsewhere, in the protocol of the challenge's Docker images.

    There is no password: whoever reaches the port can play. The agent's interpolation order is printed; the other side must use
    the same.

    \b
    hockey serve-agent thesis --env 7dof-hit --port 8080
    hockey evaluate --env 7dof-hit --agent tcp://127.0.0.1:8080        (elsewhere)
    """
    common.typed_options(ctx, given)
    from airhockey import envs
    from airhockey.agents.submission import is_submission, wanted_order
    from airhockey.commands._session import agent_of, edition_of, say_what_is_not_protected
    from airhockey.errors import ConfigurationError
    from airhockey.evaluator.checks import check_agent
    from airhockey.evaluator.isolation.build import build_agent
    from airhockey.evaluator.isolation.limits import Limits
    from airhockey.evaluator.isolation.modes import choose
    from airhockey.evaluator.isolation.serving import LOOPBACK, listen, serve

    name = given["agent"]
    agent_name = agent_of(name)
    edition = edition_of(given, (agent_name,), (given["env"],))
    check_agent(agent_name, (given["env"],))
    say_what_is_not_protected((agent_name,), given["isolate"])
    order = wanted_order(Path(agent_name)) if is_submission(agent_name) else 3
    env = envs.make(given["env"], order, edition=edition)
    waiting = listen(given["host"], given["port"])
    with waiting:
        agent = build_agent(
            agent_name,
            env,
            given["agent_id"],
            mode=choose(agent_name, given["isolate"]).mode,
            limits=Limits(patience=given["patience"]),
        )
        wanted = agent.interpolation_order
        if wanted != order:
            raise ConfigurationError(f"the agent's interpolation order is {wanted}; name it in its agent_config.yml")
        host, port = waiting.getsockname()[:2]
        if host not in (LOOPBACK, "::1"):
            click.echo(f"hockey: warning: everybody who reaches {host}:{port} can play with this agent", err=True)
        click.echo(f"serving {name} for {given['env']} (interpolation order {order}) at tcp://{host}:{port}")
        size = env.env_info["rl_info"].observation_space.shape[0]
        with contextlib.suppress(KeyboardInterrupt):
            serve(waiting, agent, size, given["games"])
        with contextlib.suppress(KeyboardInterrupt):
            agent.stop()

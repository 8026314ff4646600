"""What `hockey serve-agent` does once its options are read."""

import contextlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from airhockey.agents import AGENTS
from airhockey.commands._isolation import isolation_of, say_what_is_not_protected
from airhockey.errors import ConfigurationError
from airhockey.evaluator.engines.workers import ONE_THREAD


def run(given: Mapping[str, Any]) -> None:
    """Serve until the user has enough."""
    os.environ.update(ONE_THREAD)
    from airhockey import envs
    from airhockey.agents.submission import is_submission, wanted_order
    from airhockey.evaluator.checks import check_agent
    from airhockey.evaluator.isolation.build import build_agent
    from airhockey.evaluator.isolation.limits import Limits
    from airhockey.evaluator.isolation.serving import LOOPBACK, listen, serve

    name = given["agent"]
    path = Path(name).expanduser()
    agent_name = name if name in AGENTS or not path.exists() else str(path.resolve())
    check_agent(agent_name, (given["env"],))
    say_what_is_not_protected((agent_name,), given["isolate"])
    order = wanted_order(Path(agent_name)) if is_submission(agent_name) else 3
    env = envs.make(given["env"], order)
    waiting = listen(given["host"], given["port"])
    with waiting:
        agent = build_agent(
            agent_name,
            env,
            given["agent_id"],
            mode=isolation_of(agent_name, given["isolate"]),
            limits=Limits(patience=given["patience"]),
        )
        if agent.interpolation_order != order:
            raise ConfigurationError(
                f"the agent's interpolation order is {agent.interpolation_order}; name it in its agent_config.yml"
            )
        host, port = waiting.getsockname()[:2]
        if host not in (LOOPBACK, "::1"):
            click.echo(f"hockey: warning: everybody who reaches {host}:{port} can play with this agent", err=True)
        click.echo(f"serving {name} for {given['env']} (interpolation order {order}) at tcp://{host}:{port}")
        size = env.env_info["rl_info"].observation_space.shape[0]
        with contextlib.suppress(KeyboardInterrupt):
            serve(waiting, agent, size, given["games"])
        with contextlib.suppress(KeyboardInterrupt):
            agent.stop()

"""What can be said about a run's options before anything is built or written."""

import re
from pathlib import Path

from airhockey.agents import AGENTS
from airhockey.agents.submission import is_submission, submission_config
from airhockey.agents.thesis.parameters import thesis_parameters
from airhockey.envs.disturbances import load_disturbances
from airhockey.envs.editions import Edition, edition
from airhockey.errors import ConfigurationError, unknown
from airhockey.evaluator.isolation.handle import CLOCKS
from airhockey.evaluator.isolation.modes import REMOTE, check_python, choose, host_and_port
from airhockey.evaluator.runs.game_records import VARIANTS, GameOptions
from airhockey.evaluator.runs.records import Options

RULE_BASED = ("thesis", "thesis-final")  # agents whose numbers are in a file
ORDERS = (1, 2, 3, 4, 5, -1, "none", "agent")


def check_options(options: Options) -> None:
    """Find the mistakes in a run's options.

    Raises:
        ConfigurationError: Something in them has no meaning; the message says what would have.
    """
    rules = edition(options.edition)
    if options.episodes < 1:
        raise ConfigurationError(f"the number of episodes must be positive, not {options.episodes}")
    check_seed(options.seed)
    check_agent_seed(options.agent_seed)
    if options.interpolation_order not in ORDERS:
        raise unknown("interpolation order", options.interpolation_order, map(str, ORDERS))
    if options.clock not in CLOCKS:
        raise unknown("clock", options.clock, CLOCKS)
    if not options.environments:
        raise ConfigurationError(f"no environment to evaluate on; there are {', '.join(rules.tasks)}")
    for name in options.environments:
        _check_environment(name, rules)
    load_disturbances(options.disturbances)
    check_agent(options.agent, options.environments)
    _check_parameters(options)
    check_settings(options.agent, options.settings)
    check_python(options.agent, options.isolate, options.python)
    choose(options.agent, options.isolate)
    if options.patience <= 0.0:
        raise ConfigurationError(f"the patience must be positive, not {options.patience:g} s")


def _check_parameters(options: Options) -> None:
    """Only the rule-based players read a parameter file, and it must be one."""
    if options.parameters is None:
        return
    if options.agent not in RULE_BASED:
        raise ConfigurationError(
            f"agent {options.agent!r} reads no parameter file; those that do: {', '.join(RULE_BASED)}"
        )
    thesis_parameters(options.parameters)


def check_settings(agent: str, settings: tuple[str, ...]) -> None:
    """Only our own players have such parameters, and they must have these; raises `ConfigurationError`."""
    if settings and agent not in AGENTS:
        raise ConfigurationError(f"--set is for the players of airhockey ({', '.join(AGENTS)}), not for {agent!r}")
    if agent in AGENTS:
        AGENTS[agent].check_settings(settings)


def check_agent_seed(secret: str | None) -> None:
    """The secret of the agents' seeds is a hexadecimal number; raises `ConfigurationError` where it is not."""
    if secret is not None and not re.fullmatch(r"[0-9a-f]{1,64}", secret):
        raise ConfigurationError(f"the agents' seed must be 1 to 64 hexadecimal digits, not {secret!r}")


def check_seed(seed: int) -> None:
    """Seeds are natural numbers; raises `ConfigurationError` where one is not."""
    if seed < 0:
        raise ConfigurationError(f"the seed must not be negative, as {seed} is")


def _check_environment(name: str, rules: Edition) -> None:
    if rules.official_name(name) not in rules.tasks:
        raise ConfigurationError(
            f"{name!r} is a game of two players, not a task; the tasks are {', '.join(rules.tasks)}"
        )


def check_game_options(options: GameOptions) -> None:
    """Find the mistakes in how games are to be played; raises `ConfigurationError`."""
    edition(options.edition)
    if options.steps < 1:
        raise ConfigurationError(f"the number of steps must be positive, not {options.steps}")
    if options.clock not in CLOCKS:
        raise unknown("clock", options.clock, CLOCKS)
    check_agent_seed(options.agent_seed)
    if options.variant not in VARIANTS:
        raise unknown("variant of the rules", options.variant, VARIANTS)
    load_disturbances(options.disturbances)


def check_agent(agent: str, environments: tuple[str, ...]) -> None:
    """An agent of the registry must play these environments; a submission's folder must be one.

    Raises:
        ConfigurationError: It does not, or it is not.
    """
    if agent.startswith(REMOTE):
        host_and_port(agent)
        return
    if agent not in AGENTS:
        if is_submission(agent):
            submission_config(Path(agent))
            return
        raise unknown("agent (or path of a submission's folder)", agent, AGENTS)
    for name in environments:
        if name not in AGENTS[agent].environments:
            playable = ", ".join(AGENTS[agent].environments)
            raise ConfigurationError(f"agent {agent!r} does not play {name!r}; it plays {playable}")

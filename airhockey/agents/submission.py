"""Players of other people: a folder or an archive with `agent_builder.py` and, if they like, `agent_config.yml`.

The layout is the challenge's: `agent_builder.py` defines `build_agent(env_info, **kwargs)`; the keys of `agent_config.yml`
that are not the evaluation's own are its keyword arguments. Whatever the folder is called, it is the package
`air_hockey_agent` to the code in it; the root of the checkout is first on the import path and the working directory.
"""

import inspect
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from airhockey.agents.packaging.checkout import BUILDER, CONFIG, PACKAGE, find_checkout
from airhockey.agents.packaging.importing import at_the_root, explaining, load_builder
from airhockey.agents.packaging.metadata import interpolation_order, read_metadata, read_yaml_if_there
from airhockey.errors import ConfigurationError

__all__ = ["BUILDER", "CONFIG", "EVALUATION_KEYS", "PACKAGE", "build_submission", "is_submission", "submission_config"]

# Keys of agent_config.yml that configure the evaluation; every other key goes to the agent.
EVALUATION_KEYS = frozenset(
    (
        "interpolation_order", "render", "quiet", "n_episodes", "n_cores", "env", "log_dir", "seed", "generate_score",
        "steps_per_game",
    )
)  # fmt: skip


def is_submission(name: str) -> bool:
    """Whether the name of an agent means a submission's folder or archive, rather than a player of the registry."""
    from airhockey.agents.registry import AGENTS

    return name not in AGENTS and (Path(name).expanduser().exists() or "/" in name or name.startswith("."))


def submission_folder(path: Path) -> Path:
    """The folder that holds `agent_builder.py`; see `airhockey.agents.packaging.checkout`.

    Raises:
        ConfigurationError: There is none, or the archive is refused.
    """
    return find_checkout(path).package


def submission_config(path: Path) -> dict[str, Any]:
    """Everything that a submission's `agent_config.yml` says; empty when there is no such file.

    Raises:
        ConfigurationError: The file is not YAML, or not a mapping with text keys.
    """
    return read_yaml_if_there(submission_folder(path) / CONFIG) or {}


def wanted_order(path: Path, default: int | None = 3) -> int | None:
    """The interpolation order that a submission names: in its configuration, else in its metadata.

    Raises:
        ConfigurationError: There is no such order, or a file cannot be read.
    """
    config = submission_config(path)
    if "interpolation_order" in config:
        return interpolation_order(config["interpolation_order"])
    metadata = read_metadata(submission_folder(path))
    return default if metadata is None else interpolation_order(metadata.interpolation_order)


def build_submission(
    path: Path,
    env_info: Mapping[str, Any],
    agent_id: int = 1,
    prepare: Callable[[], None] | None = None,
    **kwargs: Any,
) -> Any:
    """Import a submission's builder and call it, with the submission's root as working directory.

    The interpolation order that the submission names becomes the agent's. The official package never says on which side an
    agent plays, so `agent_id` is handed only to a builder that has a parameter of this name.

    Args:
        path: Folder or archive.
        env_info: Handed to the builder.
        agent_id: 1 or 2.
        prepare: Called between the import of the submission's code and the call of its builder.
        kwargs: Handed to the builder; they win over `agent_config.yml`.

    Raises:
        ConfigurationError: The folder, its configuration or its builder is not usable.
        MissingDependencyError: It imports a package that is not installed.
    """
    checkout = find_checkout(path)
    folder = checkout.package
    config = submission_config(folder)
    arguments = {key: value for key, value in config.items() if key not in EVALUATION_KEYS} | kwargs
    with at_the_root(checkout):
        builder = load_builder(checkout)
        if prepare is not None:
            prepare()
        if "agent_id" in inspect.signature(builder).parameters:
            arguments["agent_id"] = agent_id
        with explaining(checkout):
            agent = builder(env_info, **arguments)
    if not callable(getattr(agent, "draw_action", None)):
        raise ConfigurationError(f"build_agent of {str(folder)!r} returned {type(agent).__name__}, without draw_action")
    named = wanted_order(folder, default=getattr(agent, "interpolation_order", 3))
    if named != getattr(agent, "interpolation_order", 3) or "interpolation_order" in config:
        agent.interpolation_order = named
    return agent

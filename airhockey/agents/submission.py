"""Players of other people: a folder or an archive with `agent_builder.py` and, if they like, `agent_config.yml`.

The layout is the challenge's: `agent_builder.py` defines `build_agent(env_info, **kwargs)`; the keys of `agent_config.yml`
that are not the evaluation's own are its keyword arguments. Whatever the folder is called, it is the package
`air_hockey_agent` to the code in it, and its modules can also be imported as neighbours.
"""

import importlib.util
import sys
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

from airhockey.agents.packaging.metadata import interpolation_order, read_metadata, read_yaml
from airhockey.errors import AirHockeyError, ConfigurationError, MissingDependencyError

BUILDER, CONFIG, PACKAGE = "agent_builder.py", "agent_config.yml", "air_hockey_agent"

# Keys of agent_config.yml that configure the evaluation; every other key goes to the agent.
EVALUATION_KEYS = frozenset(
    (
        "interpolation_order", "render", "quiet", "n_episodes", "n_cores", "env", "log_dir", "seed", "generate_score",
        "steps_per_game",
    )
)  # fmt: skip

# What pip calls a package whose modules have another name.
_DISTRIBUTIONS = {
    "PIL": "pillow",
    "cv2": "opencv-python-headless",
    "mushroom_rl": "'airhockey[mushroom]'",
    "pinocchio": "pin",
    "skimage": "scikit-image",
    "sklearn": "scikit-learn",
    "torch": "'airhockey[mushroom]'",
    "yaml": "pyyaml",
}


def is_submission(name: str) -> bool:
    """Whether the name of an agent means a submission's folder or archive, rather than a player of the registry."""
    from airhockey.agents.registry import AGENTS

    return name not in AGENTS and (Path(name).expanduser().exists() or "/" in name or name.startswith("."))


def submission_folder(path: Path) -> Path:
    """The folder that holds `agent_builder.py`: `path` itself, its `air_hockey_agent/`, or these in its only sub-folder.

    Args:
        path: A folder, or an archive, which is unpacked.

    Raises:
        ConfigurationError: There is none, or the archive is refused.
    """
    if path.is_file():
        from airhockey.agents.packaging.archive import opened

        root = opened(path)
    else:
        root = path
    visible = [entry for entry in root.iterdir() if not entry.name.startswith(".")] if root.is_dir() else []
    inner = [root / visible[0].name] if len(visible) == 1 and visible[0].is_dir() else []
    for folder in (root, root / PACKAGE, *inner, *(folder / PACKAGE for folder in inner)):
        if (folder / BUILDER).is_file():
            return folder.resolve()
    raise ConfigurationError(f"no agent at {str(path)!r}: neither it nor its sub-folder {PACKAGE}/ contains {BUILDER}")


def submission_config(path: Path) -> dict[str, Any]:
    """Everything that a submission's `agent_config.yml` says; empty when there is no such file.

    Raises:
        ConfigurationError: The file is not YAML, or not a mapping with text keys.
    """
    file = submission_folder(path) / CONFIG
    return read_yaml(file) if file.is_file() else {}


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


def build_submission(path: Path, env_info: Mapping[str, Any], agent_id: int = 1, **kwargs: Any) -> Any:
    """Import a submission's builder and call it.

    The interpolation order that the submission names becomes the agent's.

    Raises:
        ConfigurationError: The folder, its configuration or its builder is not usable.
        MissingDependencyError: It imports a package that is not installed.
    """
    folder = submission_folder(path)
    config = submission_config(folder)
    arguments = {key: value for key, value in config.items() if key not in EVALUATION_KEYS} | kwargs
    if agent_id != 1:
        arguments["agent_id"] = agent_id
    _make_importable(folder)
    builder = getattr(_import_builder(folder), "build_agent", None)
    if not callable(builder):
        raise ConfigurationError(f"{str(folder / BUILDER)!r} defines no function build_agent(env_info, **kwargs)")
    try:
        agent = builder(env_info, **arguments)
    except ModuleNotFoundError as error:
        raise _missing(folder, error) from error
    if not callable(getattr(agent, "draw_action", None)):
        raise ConfigurationError(f"build_agent of {str(folder)!r} returned {type(agent).__name__}, without draw_action")
    named = wanted_order(folder, default=getattr(agent, "interpolation_order", 3))
    if named != getattr(agent, "interpolation_order", 3) or "interpolation_order" in config:
        agent.interpolation_order = named
    return agent


def _make_importable(folder: Path) -> None:
    """Let imports find this submission's modules, and no longer those of the one before.

    What the one before has imported stays with it; what it has yet to import is lost to it, unless it runs in a process of
    its own (`hockey evaluate --isolate`).
    """
    present = sys.modules.get(PACKAGE)
    if present is not None and list(getattr(present, "__path__", ())) == [str(folder)]:
        return
    for path in getattr(present, "__path__", ()):
        _forget(Path(path))
    sys.modules.pop(PACKAGE, None)
    sys.path.insert(0, str(folder))
    importlib.invalidate_caches()
    init = folder / "__init__.py"
    locations = [str(folder)]
    if not init.is_file():
        package = ModuleType(PACKAGE)
        package.__path__ = locations
        sys.modules[PACKAGE] = package
        return
    spec = importlib.util.spec_from_file_location(PACKAGE, init, submodule_search_locations=locations)
    assert spec is not None and spec.loader is not None
    sys.modules[PACKAGE] = package = importlib.util.module_from_spec(spec)
    _run(folder, package, spec.loader.exec_module)


def _forget(folder: Path) -> None:
    """Modules from this folder are no longer found."""
    if str(folder) in sys.path:
        sys.path.remove(str(folder))
    for name, module in list(sys.modules.items()):
        file = getattr(module, "__file__", None)
        if isinstance(file, str) and Path(file).is_relative_to(folder):
            del sys.modules[name]


def _import_builder(folder: Path) -> ModuleType:
    """`agent_builder.py`, run anew for every agent."""
    name = f"{PACKAGE}.{Path(BUILDER).stem}"
    spec = importlib.util.spec_from_file_location(name, folder / BUILDER)
    if spec is None or spec.loader is None:
        raise ConfigurationError(f"cannot import {str(folder / BUILDER)!r}")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    _run(folder, module, spec.loader.exec_module)
    return module


def _run(folder: Path, module: ModuleType, execute: Any) -> None:
    """Run a module's code; what it fails with names the submission."""
    try:
        execute(module)
    except AirHockeyError:
        sys.modules.pop(module.__name__, None)
        raise
    except ModuleNotFoundError as error:
        sys.modules.pop(module.__name__, None)
        raise _missing(folder, error) from error
    except Exception as error:
        sys.modules.pop(module.__name__, None)
        raise ConfigurationError(f"cannot import {str(module.__file__)!r}: {type(error).__name__}: {error}") from error


def _missing(folder: Path, error: ModuleNotFoundError) -> AirHockeyError:
    """What to say about a module that is not there."""
    name = (error.name or "?").partition(".")[0]
    if name == "air_hockey_challenge":
        return MissingDependencyError(
            f"the agent in {str(folder)!r} imports {error.name!r}, which the compatibility layer does not have"
        )
    if name == PACKAGE:
        return ConfigurationError(f"the agent in {str(folder)!r} imports {error.name!r}, but has no such file")
    return MissingDependencyError(
        f"the agent in {str(folder)!r} imports {name!r}, which is not installed: pip install {_DISTRIBUTIONS.get(name, name)}"
    )

"""Another interpreter for an agent's process: what it is, where its files lie, and what it is told."""

import functools
import json
import subprocess
from pathlib import Path
from typing import Any, NamedTuple

from airhockey.agents.packaging.checkout import Checkout
from airhockey.agents.packaging.metadata import interpolation_order
from airhockey.agents.submission import EVALUATION_KEYS, submission_config, wanted_order
from airhockey.envs import scene
from airhockey.errors import ConfigurationError

FOREIGN = Path(__file__).with_name("foreign_process.py")
_OLDEST, _NEWEST = (3, 8), (3, 14)
_ASK = """
import json, site, sys
try:
    import numpy
    where = numpy.__version__
except ImportError:
    where = None
print(json.dumps([list(sys.version_info[:2]), where, [sys.prefix, sys.base_prefix, *site.getsitepackages()]]))
"""


class Interpreter(NamedTuple):
    """A Python that can run an agent.

    Attributes:
        path: Its executable.
        folders: Where it and its packages lie.
    """

    path: str
    folders: tuple[str, ...]


@functools.cache
def interpreter(path: str) -> Interpreter:
    """Ask an interpreter what it is.

    Raises:
        ConfigurationError: It is none, has no NumPy, or is of a version that cannot run an agent.
    """
    executable = Path(path).expanduser().absolute()  # not resolved: a link decides which environment it is
    try:
        told = subprocess.run(
            [str(executable), "-I", "-c", _ASK], capture_output=True, text=True, timeout=60, check=True
        )
        version, numpy, folders = json.loads(told.stdout)
    except (OSError, subprocess.SubprocessError, ValueError) as error:
        raise ConfigurationError(f"--python: {path!r} is no Python interpreter that starts ({error})") from None
    name = ".".join(map(str, version))
    if not _OLDEST <= tuple(version) <= _NEWEST:
        oldest, newest = (".".join(map(str, bound)) for bound in (_OLDEST, _NEWEST))
        raise ConfigurationError(f"--python: {path!r} is Python {name}; agents run in {oldest} to {newest}")
    if numpy is None:
        raise ConfigurationError(f"--python: {path!r} has no NumPy: {path} -m pip install numpy")
    return Interpreter(str(executable), tuple(folders))


def foreign_job(checkout: Checkout, inside: str, env: Any, agent_id: int, arguments: dict[str, Any]) -> dict[str, Any]:
    """All that the other interpreter needs to build the agent, as plain data.

    Args:
        checkout: The submission.
        inside: The path of its root over there.
        env: The environment that it is to play.
        agent_id: 1 or 2.
        arguments: Of the builder, beside those of its configuration.
    """
    config = submission_config(checkout.package)
    named = wanted_order(checkout.package, default=0)
    package = str(Path(inside) / checkout.package.relative_to(checkout.root))
    info, arm = env.env_info, env.simulation.arm
    boxes = info["rl_info"].observation_space, info["rl_info"].action_space
    robot = {key: value for key, value in info["robot"].items() if key not in ("robot_model", "robot_data")}
    plain = {key: value for key, value in info.items() if key not in ("rl_info", "constraints", "robot")}
    plain["robot"] = {key: value.tolist() if hasattr(value, "tolist") else value for key, value in robot.items()}
    plain["robot"]["base_frame"] = [frame.tolist() for frame in robot["base_frame"]]
    plain["rl_info"] = {
        "seen": [boxes[0].low.tolist(), boxes[0].high.tolist()],
        "done": [boxes[1].low.tolist(), boxes[1].high.tolist()],
        **{key: getattr(info["rl_info"], key) for key in ("gamma", "horizon", "dt")},
    }
    return {
        "root": inside,
        "package": package,
        "import_path": [str(Path(inside) / folder.relative_to(checkout.root)) for folder in checkout.import_path],
        "arguments": {key: value for key, value in config.items() if key not in EVALUATION_KEYS} | arguments,
        "agent_id": agent_id,
        "size": len(boxes[0].low),
        "named_order": "agent" if named == 0 else interpolation_order(named),
        "env_info": plain,
        "robot_xml": scene.robot_xml(env.simulation.robot),
        "chain": {name: getattr(arm, name).tolist() for name in ("offset", "rotation", "tip")},
    }

"""`evaluate`: the official entry point of an evaluation, carried out by `hockey evaluate`."""

import json
import shutil
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from airhockey.compat.commands import hockey
from airhockey.compat.wrapping import as_submission
from airhockey.envs.editions import DEFAULT, edition, edition_of_names

_PHASES = {"phase-1": ["3dof-hit", "3dof-defend"], "phase-2": ["7dof-hit", "7dof-defend", "7dof-prepare"]}
_TASKS_OF_2025 = ["hit", "defend", "prepare"]


def evaluate(
    agent_builder: Callable[..., Any],
    log_dir: str | Path,
    env_list: Sequence[str],
    n_episodes: int = 1000,
    n_cores: int = -1,
    seed: int | None = None,
    generate_score: str | None = None,
    quiet: bool = True,
    render: bool = False,
    interpolation_order: int | None = 3,
    **kwargs: Any,
) -> Path:
    """Evaluate an agent, and leave the official files.

    Args:
        agent_builder: `build_agent` of a submission, or any function of a module that builds an agent.
        log_dir: Where the official files go: per environment, and `results.json`.
        env_list: Names of environments; those of 2025 ("hit") choose its rules, unless names of 2023 stand beside them.
        n_episodes: Episodes of each.
        n_cores: Processes that play; -1 for as many as there are.
        seed: Of the run; default 0.
        generate_score: "phase-1" or "phase-2": the environments that this score needs.
        quiet: No progress.
        render: Not possible during an evaluation: look at it afterwards with `hockey replay LOG_DIR`.
        interpolation_order: Of the agent's actions.
        kwargs: Handed to the builder.

    Returns:
        The folder with the official files.

    Raises:
        subprocess.CalledProcessError: The evaluation failed; why was printed.
    """
    target = Path(log_dir)
    with tempfile.TemporaryDirectory(prefix="airhockey-official-") as place:
        agent = as_submission(
            agent_builder, Path(place) / "agent", kwargs | {"interpolation_order": interpolation_order}
        )
        options = ["--agent", str(agent), "--episodes", str(n_episodes), "--seed", str(seed or 0)]
        options += ["--jobs", str(n_cores)] if n_cores > 0 else []
        options += ["--quiet"] if quiet else []
        results: dict[str, Any] = {}
        for k, what in enumerate(_runs(_environments(env_list, generate_score))):
            run = Path(place) / f"run{k}"
            hockey("evaluate", *what, *options, "--out", str(run), "--official-dataset", "--isolate", "process")
            shutil.copytree(run / "official", target, dirs_exist_ok=True)
            results |= json.loads((target / "results.json").read_text())
        (target / "results.json").write_text(json.dumps(results, indent=2) + "\n")
    return target


def _runs(environments: list[str]) -> list[list[str]]:
    """Options of the evaluations needed: one for a whole phase, which has a score; else one an environment."""
    for robot, phase in (("3dof", _PHASES["phase-1"]), ("7dof", _PHASES["phase-2"])):
        if set(environments) == set(phase):
            return [["--task", "all", "--robot", robot, "--edition", "2023"]]
    if set(environments) == set(_TASKS_OF_2025):
        return [["--task", "all", "--edition", "2025"]]
    return [["--env", name] for name in environments]


def _environments(env_list: Sequence[str], score: str | None) -> list[str]:
    if score in _PHASES:
        return _PHASES[score]
    names = [env_list] if isinstance(env_list, str) else list(env_list)
    return [edition(edition_of_names(names) or DEFAULT).counterpart(name) for name in names]

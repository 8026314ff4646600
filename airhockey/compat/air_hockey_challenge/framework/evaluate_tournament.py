"""`run_tournament`: the official entry point of a game between two agents, carried out by `hockey match`."""

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from airhockey.compat.commands import hockey
from airhockey.compat.wrapping import as_submission


def run_tournament(
    build_agent_1: Callable[..., Any],
    build_agent_2: Callable[..., Any] | None = None,
    log_dir: str | Path = "runs/official-tournament",
    steps_per_game: int = 45000,
    n_episodes: int = 1,
    seed: int | None = None,
    agent_1_kwargs: dict[str, Any] | None = None,
    agent_2_kwargs: dict[str, Any] | None = None,
    quiet: bool = True,
    **kwargs: Any,
) -> Path:
    """Let two agents play games under the rules of the challenge's tournament.

    Args:
        build_agent_1, build_agent_2: Their builders; without a second one, the first plays itself.
        log_dir: Where the games are stored.
        steps_per_game: Length of a game, in control steps.
        n_episodes: Number of games.
        seed: Of everything; default 0.
        agent_1_kwargs, agent_2_kwargs: Handed to the builders, with `kwargs`.
        quiet: No progress.

    Returns:
        The folder of the games, for `hockey report` and `hockey replay`.

    Raises:
        subprocess.CalledProcessError: The match failed; why was printed.
    """
    with tempfile.TemporaryDirectory(prefix="airhockey-official-") as place:
        home = as_submission(build_agent_1, Path(place) / "agent_1", kwargs | (agent_1_kwargs or {}))
        away = as_submission(build_agent_2 or build_agent_1, Path(place) / "agent_2", kwargs | (agent_2_kwargs or {}))
        options = ["--games", str(n_episodes), "--steps", str(steps_per_game), "--seed", str(seed or 0)]
        options += ["--out", str(log_dir), *(["--quiet"] if quiet else [])]
        hockey("match", str(home), str(away), *options, "--isolate", "process")
    return Path(log_dir)

"""What cloning an agent from its recordings brings: the programs of docs/howto/export.md, counted.

    python benchmarks/behaviour_cloning.py [--episodes 400] [--games 200]

`planner` plays episodes of 7dof-hit, they are exported, the first program learns from the data set, and the second one plays
episodes with seeds that were not recorded; `hold`, which stands still, plays the same.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch

from airhockey.agents import build_agent
from airhockey.evaluator.judging.tasks import wilson_interval

PAGE = Path(__file__).parent.parent / "docs" / "howto" / "export.md"
LEARN, PLAY = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text("utf-8"), re.MULTILINE | re.DOTALL)
FIRST_SEED = 10_000
Act = Callable[[Any], Any]


def record(folder: Path, episodes: int) -> None:
    """Play and export, as the page says."""
    hockey = [sys.executable, "-m", "airhockey.cli"]
    run = ["evaluate", "--env", "7dof-hit", "--episodes", str(episodes), "--out", "hit", "--quiet"]
    for line in (run, ["export", "hit", "--format", "minari", "-o", "sets", "--quiet"]):
        subprocess.run([*hockey, *line], cwd=folder, stdout=subprocess.DEVNULL, check=True)
    os.environ["MINARI_DATASETS_PATH"] = str(folder / "sets")


def count(env: Any, act: Act, start: Callable[[], None], games: int) -> tuple[int, int]:
    """Numbers of episodes that succeeded, and that violated a limit."""
    successes = violations = 0
    for seed in range(FIRST_SEED, FIRST_SEED + games):
        observation, _ = env.reset(seed=seed)
        start()
        over = violated = False
        while not over:
            observation, reward, terminated, truncated, info = env.step(act(observation))
            violated |= any((values > 0.0).any() for values in info["constraints_value"].values())
            over = terminated or truncated
        successes += int(reward)
        violations += violated
    return successes, violations


def main() -> None:
    """Learn and count."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--episodes", type=int, default=400, help="recorded")
    parser.add_argument("--games", type=int, default=200, help="episodes that are counted")
    options = parser.parse_args()
    torch.set_num_threads(1)
    names: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as folder:
        record(Path(folder), options.episodes)
        exec(LEARN, names)
        exec(PLAY, names)
    env = names["env"]
    hold = build_agent("hold", env.unwrapped.environment.env_info)
    print(f"learned from {options.episodes} episodes, {len(names['seen'])} steps; {options.games} new episodes each")
    print("agent   success  95 % interval    episodes with violations")
    players: dict[str, tuple[Act, Callable[[], None]]] = {
        "clone": (names["clone"], lambda: None),
        "hold": (lambda seen: np.asarray(hold.draw_action(seen)), hold.episode_start),
    }
    for name, (act, start) in players.items():
        successes, violations = count(env, act, start, options.games)
        low, high = wilson_interval(successes, options.games)
        share = successes / options.games
        print(f"{name:6} {share:8.1%}  {low:6.1%} – {high:6.1%} {violations:15}", flush=True)


if __name__ == "__main__":
    main()

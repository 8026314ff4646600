"""How fast the ten lines of docs/learning.md learn: success over actions and CPU time.

    python benchmarks/ten_lines.py [--task 7dof-defend] [--seed 0] [--until 0.6]

The lines are taken from the page and run as they stand, except for task and seed; training ends as soon as that share of the
latest 100 episodes succeeds. CPU time is that of all threads, so that a busy machine does not matter.
"""

import argparse
import re
import time
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.callbacks import BaseCallback

PAGE = Path(__file__).parent.parent / "docs" / "learning.md"
LINES = re.compile(r"```\n(import gymnasium\nfrom stable_baselines3.*?)model\.learn\(([\d_]+)\)\n```", re.DOTALL)
EVERY = 12
"""Rollouts of a printed line."""


class Watch(BaseCallback):
    """Prints how training goes, and ends it when it went far enough.

    Args:
        until: Share of successes at which it ends.
    """

    def __init__(self, until: float) -> None:
        super().__init__()
        self._until, self._began, self._rollouts = until, time.process_time(), 0

    def _on_step(self) -> bool:
        latest: Any = self.model.ep_success_buffer
        return not (len(latest) == latest.maxlen and np.mean(latest) >= self._until)

    def _on_rollout_end(self) -> None:
        if self._rollouts % EVERY == 0:
            self.tell()
        self._rollouts += 1

    def tell(self) -> None:
        """A line."""
        vec: Any = self.training_env
        batch, latest = vec.env.batch, self.model.ep_success_buffer
        print(
            f"{self.num_timesteps:>9} {batch.learner.played.sum():>13} {np.mean(latest or [0.0]):>8.1%} "
            f"{batch.violations:>11.4%} {time.process_time() - self._began:>12.0f}",
            flush=True,
        )


def main() -> None:
    """Run the lines."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--task", default="7dof-defend", help="7dof-defend, 7dof-hit, …")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--until", type=float, default=0.6, help="share of successes")
    options = parser.parse_args()
    found = LINES.search(PAGE.read_text("utf-8"))
    assert found is not None, f"{PAGE} has no such lines"
    torch.set_num_threads(1)
    names: dict[str, Any] = {}
    exec(found[1].replace("7dof-defend", options.task).replace("seed=0", f"seed={options.seed}"), names)
    print("  actions control steps  success  violations  CPU time [s]", flush=True)
    watch = Watch(options.until)
    names["model"].learn(int(found[2]), watch)
    watch.tell()


if __name__ == "__main__":
    main()

"""How large the recordings of a run are, by what is kept of them, and what it costs to compute the rest again.

python benchmarks/trajectory_size.py [--env 7dof-prepare] [--episodes 60]
"""

import argparse
import tempfile
import time
from pathlib import Path

from airhockey.evaluator import Options, begin, evaluate
from airhockey.evaluator.runs.episode_folder import EpisodeFolder
from airhockey.evaluator.runs.keeping import ACTIONS, FULL, NONE, Recipe
from airhockey.evaluator.runs.trajectories import merge, read_episodes, write


def main() -> None:
    """Play once, keep it in every way."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--env", default="7dof-prepare")
    parser.add_argument("--agent", default="planner")
    parser.add_argument("--episodes", type=int, default=60)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        run = Path(place) / "run"
        evaluate(begin(Options(environments=(given.env,), agent=given.agent, episodes=given.episodes), run))
        manifest = EpisodeFolder.read(run)
        recipe = Recipe(seed=manifest.options.seed, edition=manifest.options.edition, profile=manifest.profile)
        whole = list(read_episodes(run / "trajectories.h5", given.env))
        steps = sum(episode.record.steps for episode in whole)
        bare = sum(array.nbytes for episode in whole for array in episode.trajectory.values())
        print(
            f"{given.episodes} episodes of {given.env} by {given.agent}, {steps} steps; sizes are of 1000 such episodes"
        )
        print(f"{'unpacked':9} {1e-3 * bare / given.episodes:6.0f} MB")
        for keep in (FULL, ACTIONS, NONE):
            part, file = Path(place) / "part.h5", Path(place) / f"{keep}.h5"
            write(part, whole, keep, recipe)
            merge([part], file)
            began = time.process_time()
            again = list(read_episodes(file, given.env))
            spent = time.process_time() - began
            same = keep != NONE and all(
                one.trajectory[name].tobytes() == other.trajectory[name].tobytes()
                for one, other in zip(whole, again, strict=True)
                for name in one.trajectory
            )
            told = (
                ""
                if keep == NONE
                else f"   read in {1e6 * spent / steps:4.0f} µs a step, {'equal' if same else 'not equal'} to the bit"
            )
            print(f"{keep:9} {1e-3 * file.stat().st_size / given.episodes:6.0f} MB{told}")


if __name__ == "__main__":
    main()

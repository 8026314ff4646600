"""Environment steps per second in training and in evaluation, of the same agent on the same task, interleaved.

    python benchmarks/train_rate.py [--robot 7dof] [--task hit] [--rounds 6]

In each round PGPE does an iteration (sampling, building a player for each candidate, episodes with the thesis's reward,
update, journal) and the evaluator plays and stores as many episodes. CPU time, so that a busy machine does not matter;
the bound is 0.7.
"""

import argparse
import os
import tempfile
import time
from pathlib import Path

from airhockey.evaluator.engines.workers import ONE_THREAD

os.environ.update(ONE_THREAD)

import numpy as np

from airhockey.agents.thesis.parameters import thesis_parameters
from airhockey.evaluator import InProcess, Options, begin
from airhockey.evaluator.play.episode import EpisodePlayer
from airhockey.evaluator.runs.records import Job
from airhockey.learning.pgpe import training
from airhockey.learning.pgpe.records import Iteration, Settings
from airhockey.learning.pgpe.trainable import names_of, ranges, read

WARM_UP = 1  # rounds that are not counted


class Evaluation:
    """An evaluation that is played a few episodes at a time.

    Attributes:
        rates: Steps per second of each portion.
    """

    def __init__(self, options: Options, path: Path, portion: int) -> None:
        self.rates: list[float] = []
        self._folder, self._portion, self._next = begin(options, path), portion, 0
        self._player = EpisodePlayer(options, self._folder.manifest.profile)
        self._env = options.environments[0]

    def go_on(self) -> None:
        """Play and store the next portion."""
        began, steps = time.process_time(), 0
        for index in range(self._next, self._next + self._portion):
            episode = self._player(Job(self._env, index))
            self._folder.add(episode)
            steps += episode.record.steps
        self._folder.flush()
        self._next += self._portion
        self.rates.append(steps / (time.process_time() - began))


def measure(robot: str, task: str, rounds: int, candidates: int, episodes: int) -> tuple[list[float], list[float]]:
    """Steps per second in training and in evaluation, one of each per round."""
    start = thesis_parameters("tuned")
    names = names_of(task)
    settings = Settings(
        task=task,
        robot=robot,
        names=tuple(names),
        mean=tuple(map(float, read(start, names))),
        sigma=tuple(0.1 * ranges()[name].sigma for name in names),  # all about the same player
        candidates=candidates,
        episodes=episodes,
        iterations=rounds + WARM_UP,
    )
    trained: list[float] = []
    with tempfile.TemporaryDirectory() as folder:
        count = candidates * episodes * (rounds + WARM_UP)
        options = Options(environments=(f"{robot}-{task}",), agent="thesis", episodes=count)
        evaluation = Evaluation(options, Path(folder) / "evaluation", candidates * episodes)
        began = time.process_time()

        def on_iteration(iteration: Iteration) -> None:
            nonlocal began
            trained.append(iteration.steps / (time.process_time() - began))
            evaluation.go_on()
            began = time.process_time()

        run = training.begin(settings, start, Path(folder) / "training")
        training.train(run, InProcess(), on_iteration=on_iteration)
    return trained[WARM_UP:], evaluation.rates[WARM_UP:]


def main() -> None:
    """Print both rates and their ratio."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robot", default="7dof")
    parser.add_argument("--task", default="hit")
    parser.add_argument("--rounds", type=int, default=6)
    parser.add_argument("--candidates", type=int, default=4)
    parser.add_argument("--episodes", type=int, default=2)
    trained, evaluated = measure(**vars(parser.parse_args()))
    ratios = np.array(trained) / np.array(evaluated)
    print(f"training    {np.median(trained):7.0f} steps/s")
    print(f"evaluation  {np.median(evaluated):7.0f} steps/s")
    print(f"ratio       {np.median(ratios):7.2f}  (rounds: {', '.join(f'{ratio:.2f}' for ratio in ratios)})")


if __name__ == "__main__":
    main()

"""Training runs as a whole: the loop against a problem in closed form, and against real episodes."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import AbstractContextManager
from pathlib import Path

import msgspec
import numpy as np
import pytest

from airhockey.agents.thesis.parameters import thesis_parameters
from airhockey.errors import AirHockeyError, ConfigurationError
from airhockey.evaluator.engines.engine import InProcess
from airhockey.evaluator.engines.processes import Processes
from airhockey.evaluator.runs.disk import write_record
from airhockey.evaluator.runs.journal import read_journal
from airhockey.evaluator.runs.manifest import TRAINING, read_manifest, sealed
from airhockey.learning.diverged import DivergedError
from airhockey.learning.pgpe import training
from airhockey.learning.pgpe.records import Iteration, Outcome, PgpeManifest, RolloutJob, Settings
from airhockey.learning.pgpe.rollouts import Rollouts
from airhockey.learning.pgpe.trainable import ranges, read, replaced

TUNED = thesis_parameters("tuned")


def settings(names=("hit.theta.0", "hit.theta.2"), start=TUNED, **others) -> Settings:
    given = {"task": "hit", "robot": "3dof", "candidates": 4, "episodes": 1, "iterations": 3}
    return Settings(
        names=names,
        mean=tuple(map(float, read(start, names))),
        sigma=tuple(ranges()[name].sigma for name in names),
        **given | others,
    )


class Bowl(AbstractContextManager):
    """An engine that plays nothing: the nearer θ is to the top, the better; past some iteration it breaks."""

    def __init__(self, breaks_at=10**6, outcome=None):
        self.breaks_at, self.outcome, self.jobs = breaks_at, outcome, []

    def pool(self, function):
        return self

    def __exit__(self, *_):
        return None

    def run(self, jobs):
        for job in jobs:
            self.jobs.append(job)
            good = Outcome(value=-sum((x - 0.1) ** 2 for x in job.theta), steps=1)
            yield job, good if job.iteration < self.breaks_at else self.outcome


def run(path, bowl, **others):
    training.train(training.begin(settings(**others), TUNED, path), bowl)
    return read_journal(path, Iteration).records


def test_parameters_get_better_and_are_left_as_a_file(tmp_path):
    iterations = run(tmp_path, Bowl(), iterations=30)
    assert iterations[-1].mean_return > iterations[0].mean_return
    left = thesis_parameters(tmp_path / "parameters.yaml")
    assert read(left, ["hit.theta.0", "hit.theta.2"]) == pytest.approx(iterations[-1].mean)
    assert left.hit.gap == TUNED.hit.gap
    assert [path.name for path in sorted((tmp_path / "checkpoints").iterdir())] == [f"0000{k}0.yaml" for k in (1, 2, 3)]
    rows = (tmp_path / "progress.csv").read_text().splitlines()
    assert len(rows) == 31 and rows[0].startswith("iteration,return,success,penalty,")
    assert float(rows[-1].split(",")[1]) == pytest.approx(iterations[-1].mean_return, rel=1e-4)


def test_every_candidate_plays_its_episodes(tmp_path):
    bowl = Bowl()
    run(tmp_path, bowl, iterations=2, episodes=3)
    assert len(bowl.jobs) == 2 * 4 * 3
    assert len({(job.iteration, job.theta) for job in bowl.jobs}) == 2 * 4


@pytest.mark.parametrize("optimizer", ["pgpe", "cma"])
@pytest.mark.parametrize("budget", [None, 0.1])
def test_a_run_taken_up_goes_on_as_if_nothing_had_happened(tmp_path, optimizer, budget):
    others = {"optimizer": optimizer, "max_penalty": budget, "baseline": "moving"}
    whole = run(tmp_path / "whole", Bowl(), iterations=6, **others)
    run(tmp_path / "parts", Bowl(), iterations=2, **others)
    with (tmp_path / "parts" / "journal.jsonl").open("ab") as journal:
        journal.write(b'{"iteration":2,"theta":[[0.0')  # what a kill in the middle of a line leaves
    training.train(training.resume(tmp_path / "parts", {"iterations": 6}), Bowl())
    parts = read_journal(tmp_path / "parts", Iteration).records
    assert [one.theta for one in parts] == [one.theta for one in whole]
    assert parts[-1].mean == whole[-1].mean and parts[-1].sigma == whole[-1].sigma
    assert len((tmp_path / "parts" / "progress.csv").read_text().splitlines()) == 7


@pytest.mark.parametrize(
    ("outcome", "message"),
    [(Outcome(value=float("nan")), "not finite"), (Outcome(error="ValueError: no"), "ValueError: no")],
)
def test_a_diverging_run_stops_and_keeps_what_was_good(tmp_path, outcome, message):
    with pytest.raises(DivergedError, match=message):
        run(tmp_path, Bowl(breaks_at=2, outcome=outcome), iterations=9)
    iterations = read_journal(tmp_path, Iteration).records
    assert len(iterations) == 2
    left = thesis_parameters(tmp_path / "parameters.yaml")
    assert read(left, ["hit.theta.0", "hit.theta.2"]) == pytest.approx(iterations[-1].mean)


def test_a_sigma_that_explodes_stops_the_run(tmp_path):
    with pytest.raises(DivergedError, match=r"σ (exploded|collapsed)"):
        run(tmp_path, Bowl(), iterations=50, learning_rate=60.0)
    assert all(np.isfinite(one.mean).all() for one in read_journal(tmp_path, Iteration).records)


@pytest.mark.parametrize(
    "change",
    [
        lambda line: line["theta"][0].pop(),
        lambda line: line["theta"].pop(),
        lambda line: line["returns"].pop(),
        lambda line: line["penalties"].append(0.0),
        lambda line: line["mean"].reverse(),
        lambda line: line.update(sigma=[]),
    ],
)
def test_a_broken_journal_ends_in_a_line_that_names_it(tmp_path, change):
    run(tmp_path, Bowl(), iterations=2)
    lines = [json.loads(line) for line in (tmp_path / "journal.jsonl").read_text().splitlines()]
    change(lines[-1])
    (tmp_path / "journal.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    with pytest.raises(AirHockeyError, match="journal"):
        training.train(training.resume(tmp_path, {"iterations": 3}), Bowl())


def test_a_journal_of_another_search_is_not_taken_up(tmp_path):
    run(tmp_path, Bowl(), iterations=2)
    manifest = read_manifest(tmp_path, TRAINING, Settings, PgpeManifest)
    other = msgspec.structs.replace(manifest, options=msgspec.structs.replace(manifest.options, seed=1))
    write_record(tmp_path / TRAINING, other)
    with pytest.raises(ConfigurationError, match=r"train.json' was edited since it was written"):
        training.resume(tmp_path, {"iterations": 3})
    write_record(tmp_path / TRAINING, sealed(other))  # by whoever can make seals
    with pytest.raises(AirHockeyError, match="iteration 0 of the journal"):
        training.train(training.resume(tmp_path, {"iterations": 3}), Bowl())


def test_only_the_number_of_iterations_may_change(tmp_path):
    run(tmp_path, Bowl(), iterations=2)
    with pytest.raises(ConfigurationError, match="candidates 4, not 5"):
        training.resume(tmp_path, {"candidates": 5})


@pytest.mark.parametrize(
    ("others", "message"),
    [
        ({"task": "prepare"}, "no task 'prepare' for the 3dof"),
        ({"discount": 1.5}, "discount"),
        ({"discount": 1.0}, "below 1"),
        ({"candidates": 1}, "at least 2"),
        ({"learning_rate": -1.0}, "learning rate"),
        ({"max_penalty": -0.1}, "budget"),
        ({"max_penalty": float("nan")}, "budget"),
        ({"multiplier_rate": -1.0}, "multiplier rate"),
        ({"mean": (0.9, 0.01)}, "hit.theta.0 starts at 0.9"),
    ],
)
def test_nothing_is_written_where_a_setting_is_wrong(tmp_path, others, message):
    with pytest.raises(ConfigurationError, match=message):
        training.begin(msgspec.structs.replace(settings(), **others), TUNED, tmp_path / "run")
    assert not (tmp_path / "run").exists()


# Real episodes from here on: a strike that comes soon, so that they are short.
REAL = {"iterations": 3, "candidates": 2, "seed": 4}
COMMAND = [sys.executable, "-m", "airhockey.cli", "train", "pgpe", "--quiet", "--robot", "3dof", "--seed", "4"]
SAME = ["--iterations", "3", "--candidates", "2", "--episodes", "1", "--jobs", "1", "--train", "hit.theta.0"]


def last_mean(path: Path) -> tuple[float, ...]:
    iterations = read_journal(path, Iteration).records
    assert len(iterations) == 3
    return iterations[-1].mean


def test_same_seed_same_parameters_whatever_the_jobs_and_after_a_kill(tmp_path):
    asked = settings(names=("hit.theta.0",), **REAL)
    training.train(training.begin(asked, TUNED, tmp_path / "one"), InProcess())
    training.train(training.begin(asked, TUNED, tmp_path / "two"), Processes(2))
    assert last_mean(tmp_path / "one") == last_mean(tmp_path / "two") != asked.mean
    out = ["--out", str(tmp_path / "killed")]
    killed = subprocess.Popen([*COMMAND, *SAME, *out], start_new_session=True)
    journal = tmp_path / "killed" / "journal.jsonl"
    deadline = time.monotonic() + 120.0
    while time.monotonic() < deadline and not (journal.exists() and journal.stat().st_size):
        time.sleep(0.01)
    os.kill(killed.pid, signal.SIGKILL)
    killed.wait()
    assert 1 <= len(read_journal(tmp_path / "killed", Iteration).records) <= 3
    training.train(training.resume(tmp_path / "killed"), InProcess())
    assert last_mean(tmp_path / "killed") == last_mean(tmp_path / "one")


def outcomes(asked: Settings, jobs, start=TUNED):
    from airhockey import envs
    from airhockey.agents.settings import plain
    from airhockey.envs.disturbances import load_disturbances
    from airhockey.learning.pgpe.records import PgpeManifest

    profile = load_disturbances(asked.disturbances)
    manifest = PgpeManifest(
        options=asked, parameters=plain(start), profile=profile, versions=envs.versions(), created=""
    )
    play = Rollouts(manifest)
    return [play(job) for job in jobs]


def test_an_outcome_depends_on_its_job_alone():
    asked = settings(names=("hit.theta.0",))
    a, b = RolloutJob(0, 0, 0, (0.05,)), RolloutJob(0, 1, 0, (0.2,))
    first = outcomes(asked, [a, b, a])
    assert first[0] == first[2] != first[1]
    assert outcomes(asked, [b]) == [first[1]]


def test_common_random_numbers_give_every_candidate_the_same_episodes():
    jobs = [RolloutJob(0, candidate, 0, (0.05,)) for candidate in range(2)]
    common = outcomes(settings(names=("hit.theta.0",), common_random_numbers=True), jobs)
    assert common[0] == common[1]
    own = outcomes(settings(names=("hit.theta.0",)), jobs)
    assert own[0] != own[1]


def test_a_value_beyond_its_bound_is_played_as_the_bound():
    asked = settings(names=("hit.theta.0",), common_random_numbers=True)
    beyond, bound = outcomes(asked, [RolloutJob(0, 0, 0, (7.0,)), RolloutJob(0, 1, 0, (0.5,))])
    assert beyond == bound


def test_success_as_a_reward_is_one_or_zero():
    (outcome,) = outcomes(settings(names=("hit.theta.0",), reward="success"), [RolloutJob(0, 0, 0, (0.05,))])
    assert outcome.value == float(outcome.success) == 1.0


def test_commands_beyond_the_velocity_limit_cost_points():
    """At 1.2 of the joints' limits the first stroke violates joint_vel_constr, which costs 1 point per episode."""
    fast = replaced(TUNED, {"margins.velocity_share": 1.2, "margins.acceleration_share": 1.5, "hit.fastest_step": 0.08})
    asked = settings(names=("margins.velocity_share",), start=fast)
    seen = outcomes(asked, [RolloutJob(0, k, 0, (1.2,)) for k in range(3)], fast)
    points = {"joint_pos_constr": 2.0, "joint_vel_constr": 1.0, "ee_constr": 3.0}
    assert any("joint_vel_constr" in one.violated for one in seen)
    assert all(one.penalty == sum(points[name] for name in one.violated) for one in seen)


def test_the_way_home_is_trained_from_elsewhere():
    names = ("home.step_size",)
    (good, lame) = outcomes(
        settings(names=names, task="home", common_random_numbers=True),
        [RolloutJob(0, 0, 0, (0.012,)), RolloutJob(0, 1, 0, (0.0005,))],
    )
    assert good.success and good.steps == 150 and good.value == pytest.approx(1000.0 * 0.997**149)
    assert not lame.success and lame.value == pytest.approx(-100.0 * 0.997**149)


def test_a_switcher_is_trained_on_every_task_of_the_robot():
    """The first episode is a hit and the second a defence; a defence needs a threshold that a puck can exceed."""
    names = ("switcher.defend_speed",)
    asked = settings(names=names, task="switcher", episodes=2, reward="success")
    keen = outcomes(asked, [RolloutJob(0, 0, episode, (0.3,)) for episode in (0, 1)])
    lazy = outcomes(asked, [RolloutJob(0, 0, episode, (3.0,)) for episode in (0, 1)])
    assert keen[0].success and keen[1].success
    assert lazy[0].success and not lazy[1].success

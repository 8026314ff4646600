"""The pictures of a run: that they are there, show what the journal says, and say what is missing."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from airhockey.agents.thesis.parameters import thesis_parameters
from airhockey.errors import ConfigurationError
from airhockey.evaluator.runs.journal import read_journal
from airhockey.learning.pgpe import plots, training
from airhockey.learning.pgpe.folder import TrainingFolder
from airhockey.learning.pgpe.records import Iteration, Outcome, Settings
from airhockey.learning.pgpe.sweep import sweep
from airhockey.learning.sac.plots import LOG, plot_training

NAMES = ("hit.theta.0", "hit.theta.2")


class Slope:
    """An engine for which less of everything is better."""

    def pool(self, function):
        return self

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None

    def run(self, jobs):
        for job in jobs:
            yield job, Outcome(value=-sum(job.theta), success=job.episode == 0, penalty=1.0, steps=1)


@pytest.fixture
def run(tmp_path):
    tuned = thesis_parameters("tuned")
    asked = Settings(
        robot="3dof", names=NAMES, mean=(0.05, 0.008), sigma=(0.01, 0.001), iterations=4, candidates=4, max_penalty=0.5
    )
    training.train(training.begin(asked, tuned, tmp_path / "run"), Slope())
    return tmp_path / "run"


@pytest.mark.parametrize(("form", "begins"), [("png", b"\x89PNG"), ("svg", b"<?xml")])
def test_every_picture_is_drawn(run, tmp_path, form, begins):
    files = plots.plot_run(run, tmp_path / "out", form)
    assert [file.name for file in files] == [f"{name}.{form}" for name in ("learning_curve", "parameters", "updates")]
    assert all(file.read_bytes().startswith(begins) for file in files)


def test_the_curves_are_the_journals(run):
    settings, iterations = TrainingFolder.read(run).options, read_journal(run, Iteration).records
    figure = Figure()
    plots.draw_learning_curve(figure, settings, iterations)
    returns, success, penalty = (axis.lines[0].get_ydata() for axis in figure.axes)
    np.testing.assert_allclose(returns, [one.mean_return for one in iterations])
    np.testing.assert_allclose(success, 0.2)  # one of five episodes
    np.testing.assert_allclose(penalty, 1.0)
    figure = Figure()
    plots.draw_parameters(figure, settings, iterations)
    np.testing.assert_allclose(figure.axes[0].lines[0].get_ydata(), [0.05, *(one.mean[0] for one in iterations)])
    np.testing.assert_allclose(figure.axes[3].lines[0].get_ydata(), [0.001, *(one.sigma[1] for one in iterations)])


def test_the_histogram_counts_every_update(run):
    figure = Figure()
    plots.draw_updates(figure, TrainingFolder.read(run).options, read_journal(run, Iteration).records)
    for axis in figure.axes:
        assert sum(bar.get_height() for bar in axis.patches) == 4


def test_a_moving_average_by_hand():
    np.testing.assert_allclose(plots.moving_average(np.array([1.0, 3.0, 5.0, 9.0]), 2), [1.0, 2.0, 4.0, 7.0])


def test_a_sweep_plays_the_same_episodes_with_every_value(run):
    manifest, mean = TrainingFolder.read(run), read_journal(run, Iteration).records[-1].mean
    points = sweep(manifest, mean, "hit.theta.2", points=2, episodes=2)
    assert [point.value for point in points] == [0.0, 0.03]
    assert points[0].returns != points[1].returns and points[0].deviation > 0.0
    assert points[1].success == 1.0
    figure = Figure()
    plots.draw_sweep(figure, "hit.theta.2", mean[1], points)
    np.testing.assert_allclose(figure.axes[1].lines[0].get_xdata(), [0.0, 0.03])


def test_a_run_without_an_iteration_has_nothing_to_plot(run, tmp_path):
    (run / "journal.jsonl").write_bytes(b"")
    with pytest.raises(ConfigurationError, match="nothing to plot"):
        plots.plot_run(run, tmp_path / "out")
    with pytest.raises(ConfigurationError, match=r"no train\.json"):
        plots.plot_run(tmp_path, tmp_path / "out")


@pytest.mark.parametrize(
    "log",
    [
        b"steps,mean_return,success,violations\n1,2,3,x\n",
        b"steps,mean_return,success,violations\n1,2,3\n",
        b"steps,mean_return,success,violations\n1,2,3,4\n1,2\n",
        b"steps,mean_return\n1,2\n",
        b"\xff\xfe,steps\n1,2\n",
        b"steps,mean_return,success,violations\n",
        b"",
    ],
)
def test_a_broken_log_ends_in_a_line_that_names_it(tmp_path: Path, log: bytes) -> None:
    (tmp_path / LOG).write_bytes(log)
    with pytest.raises(ConfigurationError, match=LOG):
        plot_training(tmp_path, tmp_path)

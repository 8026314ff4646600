"""Pictures of a training run: the kinds of the thesis's figures 5.1 to 5.5."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.errors import ConfigurationError, MissingDependencyError
from airhockey.evaluator.runs.journal import read_journal
from airhockey.learning.pgpe.folder import TrainingFolder
from airhockey.learning.pgpe.records import Iteration, Settings
from airhockey.learning.pgpe.sweep import SweepPoint

Array = NDArray[np.float64]
FORMATS = ("png", "svg")
WINDOW = 20
"""Iterations of the moving average (figure 5.2); a fifth of a run that has fewer than 100."""


def plot_run(path: Path, out: Path, form: str = "png") -> list[Path]:
    """Draw what a run's journal tells.

    Args:
        path: The run's folder.
        out: Folder for the pictures.
        form: "png" or "svg".

    Returns:
        The files: learning curve, μ and σ of every θ, histogram of the updates.

    Raises:
        ConfigurationError: There is no run, or none of its iterations is finished.
        MissingDependencyError: There is no matplotlib.
    """
    settings, iterations = TrainingFolder.read(path).options, read_journal(path, Iteration).records
    if not iterations:
        raise ConfigurationError(
            f"the run in {str(path)!r} has not finished an iteration yet: there is nothing to plot"
        )
    drawings: dict[str, Callable[[Any], None]] = {
        "learning_curve": lambda figure: draw_learning_curve(figure, settings, iterations),
        "parameters": lambda figure: draw_parameters(figure, settings, iterations),
        "updates": lambda figure: draw_updates(figure, settings, iterations),
    }
    return [save(draw, out / f"{name}.{form}") for name, draw in drawings.items()]


def save(draw: Callable[[Any], None], path: Path) -> Path:
    """Draw on a figure of its own and write it to a file."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingDependencyError(
            "plots need the package matplotlib; install it with: pip install 'airhockey[learn]'"
        ) from error
    figure = Figure(layout="constrained")  # without pyplot, no display is looked for
    draw(figure)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)
    return path


def moving_average(values: Array, window: int) -> Array:
    """Mean of each value and those up to `window` − 1 before it. Shape (n,)."""
    sums = np.concatenate(([0.0], np.cumsum(values)))
    ends = np.arange(1, values.size + 1)
    starts = np.maximum(ends - window, 0)
    return np.asarray((sums[ends] - sums[starts]) / (ends - starts))


def draw_learning_curve(figure: Any, settings: Settings, iterations: Sequence[Iteration]) -> None:
    """Return, success and penalty over the iterations (figures 5.1, 5.2, 5.4)."""
    figure.set_size_inches(8.0, 7.0)
    axes = figure.subplots(3, 1, sharex=True)
    series = {
        "mean return J(ρ)": [one.mean_return for one in iterations],
        "success": [one.mean_success for one in iterations],
        "penalty points per episode": [one.mean_penalty for one in iterations],
    }
    window = min(WINDOW, max(2, len(iterations) // 5))
    for axis, (label, values) in zip(axes, series.items(), strict=True):
        axis.plot(values, color="0.6", label="iteration")
        axis.plot(moving_average(np.array(values), window), color="C0", label=f"moving average of {window}")
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
    best, ideal = max(series["mean return J(ρ)"]), ideal_return(settings)
    if ideal is not None:
        axes[0].axhspan(best, max(ideal, best), color="0.9", label=f"slack to the ideal {ideal:g}")
    if settings.max_penalty is not None:
        axes[2].axhline(settings.max_penalty, color="C3", linestyle="--", label="budget")
        axes[2].legend()
    axes[0].legend()
    axes[0].set_title(f"{settings.robot}-{settings.task}, {settings.optimizer}, seed {settings.seed}")
    axes[2].set_xlabel("iteration")


def ideal_return(settings: Settings) -> float | None:
    """What a run without failures and violations would make; None where it has no fixed value."""
    if settings.reward == "success":
        return 1.0
    return None  # B is discounted by how long an episode takes, and a hit's triangles have no end


def draw_parameters(figure: Any, settings: Settings, iterations: Sequence[Iteration]) -> None:
    """μ and σ of every θ over the iterations (figure 5.5)."""
    axes = _grid(figure, settings)
    for row, name in enumerate(settings.names):
        for axis, start, values in (
            (axes[row, 0], settings.mean[row], [one.mean[row] for one in iterations]),
            (axes[row, 1], settings.sigma[row], [one.sigma[row] for one in iterations]),
        ):
            axis.plot([start, *values])
            axis.grid(alpha=0.3)
        axes[row, 0].set_ylabel(name, fontsize="small")
    axes[0, 0].set_title("μ")
    axes[0, 1].set_title("σ")
    for axis in axes[-1]:
        axis.set_xlabel("update")


def draw_updates(figure: Any, settings: Settings, iterations: Sequence[Iteration]) -> None:
    """Histogram of the updates of μ and σ of every θ (figure 5.3)."""
    axes = _grid(figure, settings)
    for column, (symbol, starts, field) in enumerate((("μ", settings.mean, "mean"), ("σ", settings.sigma, "sigma"))):
        values = np.array([starts, *(getattr(one, field) for one in iterations)])
        for row, changes in enumerate(np.diff(values, axis=0).T):
            axes[row, column].hist(changes, bins=min(30, max(5, len(iterations) // 2)), color="C0")
            axes[row, column].axvline(0.0, color="0.3", linewidth=0.8)
            share = float((changes > 0.0).mean())
            axes[row, column].set_title(f"Δ{symbol}, {share:.0%} upwards", fontsize="small")
            axes[row, column].tick_params(labelsize="small")
            axes[row, column].locator_params(axis="x", nbins=5)
    for row, name in enumerate(settings.names):
        axes[row, 0].set_ylabel(name, fontsize="small")


def draw_sweep(figure: Any, name: str, start: float, points: Sequence[SweepPoint]) -> None:
    """Return, success and penalty against one θ with the others fixed."""
    figure.set_size_inches(8.0, 7.0)
    axes = figure.subplots(3, 1, sharex=True)
    values = [point.value for point in points]
    for axis, label in zip(axes, ("returns", "success", "penalty"), strict=True):
        if label == "returns":
            deviations = [point.deviation for point in points]
            axis.errorbar(values, [point.returns for point in points], yerr=deviations, marker="o", capsize=3)
            axis.set_ylabel("return, with its standard error")
        else:
            axis.plot(values, [getattr(point, label) for point in points], marker="o")
            axis.set_ylabel(label)
        axis.axvline(start, color="C3", linestyle="--", label="trained")
        axis.grid(alpha=0.3)
    axes[0].legend()
    axes[2].set_xlabel(name)


def _grid(figure: Any, settings: Settings) -> Any:
    """A row per θ and two columns."""
    count = len(settings.names)
    figure.set_size_inches(8.0, 1.0 + 1.6 * count)
    return figure.subplots(count, 2, squeeze=False)

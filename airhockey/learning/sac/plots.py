"""A picture of a skill's training: return, success and violations over its actions."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.errors import ConfigurationError, MissingDependencyError
from airhockey.inputs.broken import reading_errors

Array = NDArray[np.float64]

LOG = "log.csv"
"""In a run's folder."""
PANELS = (
    ("mean_return", "return", 1.0),
    ("success", "success [%]", 100.0),
    ("violations", "steps with a violation [%]", 100.0),
)
"""Column of the log, label, and factor."""


def plot_training(run: Path, out: Path, form: str = "png") -> Path:
    """Draw a run's log.

    Args:
        run: The run's folder.
        out: Folder for the picture.
        form: "png" or "svg".

    Raises:
        ConfigurationError: There is no log, or nothing in it.
        MissingDependencyError: There is no matplotlib.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingDependencyError(
            "plots need the package matplotlib; install it with: pip install 'airhockey[learn]'"
        ) from error
    log = read_log(run)
    figure = Figure(figsize=(9.0, 2.6), layout="constrained")
    for axes, (column, label, factor) in zip(figure.subplots(1, len(PANELS)), PANELS, strict=True):
        draw(axes, log["steps"], factor * log[column])
        axes.set_xlabel("actions")
        axes.set_title(label, fontsize="medium")
    figure.axes[2].axhline(1.0, color="tab:red", linestyle=":")  # what training may violate
    figure.axes[2].set_ylim(-0.05, 1.2)
    out.mkdir(parents=True, exist_ok=True)
    path = out / f"training.{form}"
    figure.savefig(path, dpi=100)
    return path


def draw(axes: Any, steps: Array, values: Array) -> None:
    """The log's lines, and their moving average over a tenth of the run."""
    window = max(1, len(values) // 10)
    axes.plot(steps, values, color="tab:blue", alpha=0.35, linewidth=1.0)
    kept = np.convolve(values, np.ones(window) / window, mode="valid")
    axes.plot(steps[window - 1 :], kept, color="tab:blue")
    axes.grid(alpha=0.3)


def read_log(run: Path) -> dict[str, Array]:
    """Columns of a run's log.

    Raises:
        ConfigurationError: There is no log, nothing in it, or something else.
    """
    path = run / LOG
    with reading_errors(path):
        lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
        names = lines[0].split(",") if lines else []
        values = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
        if values.size and (missing := {"steps", *(column for column, _, _ in PANELS)}.difference(names)):
            raise ConfigurationError(f"{str(path)!r} has no column {', '.join(sorted(missing))}")
        if not values.size:
            raise ConfigurationError(f"the run in {str(run)!r} has written no line to its {LOG} yet: nothing to plot")
        return dict(zip(names, values.T, strict=True))

"""Sections of the page for the thesis's figures: what its trainings show, drawn again from ours."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from airhockey.evaluator.runs.journal import read_journal
from airhockey.learning.pgpe.folder import TrainingFolder
from airhockey.learning.pgpe.plots import WINDOW, moving_average
from airhockey.learning.pgpe.records import Iteration, Settings
from airhockey.reporting.blocks import figure, figures, paragraphs, section
from airhockey.reporting.draw.curves import Curve, curves
from airhockey.reporting.draw.distribution import Axes, Series, histogram, round_edges
from airhockey.reporting.markup import Markup
from airhockey.reproduction.printed import FIGURES

Array = NDArray[np.float64]

_WHY = {
    "figure-5.1": "The thesis does not say how many θ it tried in an update, nor with how many episodes. Here the learning rate "
    "is the printed 10⁻⁴ with natural gradients: with plain ones it throws θ from bound to bound.",
    "figure-5.2": "Drawn grey in the thesis is the gap to a return without violations and failures, 1000.",
    "figure-5.3": "Updates of the mean and of σ of θ0.",
    "figure-5.4": "Bands are the least and the largest of the seeds.",
    "figure-5.5": "The thesis draws log σ.",
}
_OVER = "update"


def figure_section(part: str, folder: Path, keys: list[str]) -> Markup:
    """One of the figures 5.1 to 5.5.

    Args:
        part: Which.
        folder: Of the reproduction.
        keys: Of the finished trainings that it shows; at least one.
    """
    runs = {key: Training(folder / key) for key in keys}
    drawn = {"figure-5.3": _updates, "figure-5.5": _distributions}.get(part, _returns)(runs)
    number = part.partition("-")[2]
    notes = paragraphs([f"Printed: {FIGURES[part]}", _WHY[part]], class_="note")
    return section(part, f"Figure {number}", figures(*drawn), notes)


class Training:
    """A finished training.

    Attributes:
        settings, iterations: Its own.
    """

    def __init__(self, path: Path) -> None:
        self.settings: Settings = TrainingFolder.read(path).options
        self.iterations: list[Iteration] = read_journal(path, Iteration).records

    @property
    def returns(self) -> Array:
        """Mean return of every update. Shape (n,)."""
        return np.array([one.mean_return for one in self.iterations])

    def path_of(self, field: str) -> Array:
        """`mean` or `sigma` from the start to the end. Shape (n + 1, d)."""
        return np.array([getattr(self.settings, field), *(getattr(one, field) for one in self.iterations)])


def _returns(runs: dict[str, Training]) -> list[Markup]:
    """Learning curves: those of the same θ and several seeds in one plot."""
    together: dict[tuple[str, ...], list[Training]] = {}
    for run in runs.values():
        together.setdefault(run.settings.names, []).append(run)
    drawn = []
    for names, same in together.items():
        rows = np.array([run.returns for run in same])
        window = min(WINDOW, max(2, rows.shape[1] // 5))
        smooth = np.array([moving_average(row, window) for row in rows])
        lines = [Curve("mean return", rows, "a"), Curve(f"moving average of {window}", smooth, "b")]
        caption = f"{', '.join(names)}; seeds {', '.join(str(run.settings.seed) for run in same)}"
        picture = curves(lines, _OVER, "J(ρ)", f"Mean return over the updates of {caption}")
        drawn.append(figure(caption, picture, legend=[(line.class_, line.name) for line in lines]))
    return drawn


def _updates(runs: dict[str, Training]) -> list[Markup]:
    """Histograms of the updates of mean and σ; learning curves where something of the start is fixed."""
    drawn: list[Markup] = []
    for run in runs.values():
        if run.settings.fixed_start != "none":
            caption = f"the puck's {_FIXED[run.settings.fixed_start]} fixed"
            picture = curves([Curve("mean return", run.returns, "a")], _OVER, "J(ρ)", f"Mean return with {caption}")
            drawn.append(figure(caption, picture))
            continue
        for field, symbol in (("mean", "μ"), ("sigma", "σ")):
            changes = np.diff(run.path_of(field)[:, 0])
            edges = round_edges(float(changes.min()), float(changes.max()), 24)
            counts = np.histogram(changes, edges)[0]
            axes = Axes(f"update of {symbol}", "updates")
            upwards = float((changes > 0.0).mean())
            caption = f"updates of {symbol} of {run.settings.names[0]}: {upwards:.0%} of {changes.size} upwards"
            drawn.append(
                figure(caption, histogram(edges, [Series("updates", counts, "a")], axes, caption, [(0.0, "0")]))
            )
    return drawn


_FIXED = {"position": "starting position", "velocity": "starting velocity", "both": "starting position and velocity"}


def _distributions(runs: dict[str, Training]) -> list[Markup]:
    """Mean and log σ of every θ over the updates."""
    trainings = list(runs.values())
    drawn = []
    for k, name in enumerate(trainings[0].settings.names):
        means = np.array([run.path_of("mean")[:, k] for run in trainings])
        spreads = np.log([run.path_of("sigma")[:, k] for run in trainings])
        for values, symbol, class_ in ((means, "μ", "a"), (spreads, "log σ", "b")):
            caption = f"{symbol} of {name}"
            drawn.append(
                figure(caption, curves([Curve(caption, values, class_)], _OVER, symbol, f"{caption} over the updates"))
            )
    return drawn

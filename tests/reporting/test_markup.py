"""Other people's strings stay text, wherever they stand."""

import itertools
from html.parser import HTMLParser

import pytest

from airhockey.reporting.draw.axes import Plot, Scale, round_step
from airhockey.reporting.draw.intervals import Interval, interval_plot
from airhockey.reporting.markup import Markup, element, joined, number

NASTY = "<script>alert('1')</script>\"' onload=x &amp; \x00\x1b[31m \ud800"


class Seen(HTMLParser):
    """Collects tags, attributes and text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str | None]] = []
        self.text = ""
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += attrs

    def handle_data(self, data: str) -> None:
        self.text += data


def test_text_and_attributes_are_escaped() -> None:
    seen = Seen(element("p", NASTY, element("b", NASTY), title=NASTY))
    assert seen.tags == ["p", "b"]
    assert [name for name, _ in seen.attributes] == ["title"]
    shown = NASTY.replace("\x00", "\ufffd").replace("\x1b", "\ufffd").replace("\ud800", "?")
    assert seen.attributes[0][1] == shown
    assert seen.text == 2 * shown


def test_text_in_a_drawing_is_escaped() -> None:
    drawing = interval_plot([Interval(NASTY[:38], NASTY, 0.0, 1.0, 2.0)], Scale(0.0, 2.0), NASTY, NASTY)
    seen = Seen(drawing)
    assert "script" not in seen.tags
    assert not [name for name, _ in seen.attributes if name.startswith("on")]
    drawing.encode()


def test_markup_is_not_escaped_again_and_none_is_left_out() -> None:
    inner = element("b", "<")
    assert isinstance(inner, Markup)
    assert element("p", None, [inner, [inner, 3]]) == "<p><b>&lt;</b><b>&lt;</b>3</p>"
    assert joined("a", None, "&") == "a&amp;"
    assert element("br", class_=None, hidden=True) == "<br hidden>"


@pytest.mark.parametrize(
    ("value", "written"), [(0.0, "0"), (-0.04, "0"), (1.25, "1.2"), (3.0, "3"), (-12.34, "-12.3"), (100.0, "100")]
)
def test_coordinates_are_short(value: float, written: str) -> None:
    assert number(value) == written


@pytest.mark.parametrize(
    "scale", [Scale(0.0, 1.0), Scale(-3.7, 12.2), Scale(0.0, 12345.0), Scale(1e-4, 2e3, log=True), Scale(-0.003, 0.0)]
)
def test_ticks_are_round_lie_within_and_are_a_few(scale: Scale) -> None:
    ticks = scale.ticks()
    assert 2 <= len(ticks) <= 8
    assert all(scale.low - 1e-9 <= tick <= scale.high + 1e-9 for tick in ticks)
    fractions = [scale(tick) for tick in ticks]
    assert fractions == sorted(fractions)
    gaps = [b - a for a, b in itertools.pairwise(fractions)]
    assert gaps == pytest.approx([gaps[0]] * len(gaps))


def test_round_steps() -> None:
    assert [round_step(value) for value in (0.9, 1.0, 1.1, 3.0, 7.0, 0.02)] == pytest.approx([1, 1, 2, 5, 10, 0.02])


def test_a_plot_maps_its_scales_to_its_area() -> None:
    plot = Plot(Scale(0.0, 10.0), Scale(0.0, 4.0), "x", "y")
    assert (plot.at_x(0.0), plot.at_x(10.0), plot.at_x(99.0)) == (plot.left, plot.right, plot.right)
    assert (plot.at_y(0.0), plot.at_y(4.0)) == (plot.bottom, plot.top)

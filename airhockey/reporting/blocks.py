"""The blocks that sections are built of: tables that scroll in their own box, figures with the data behind them."""

from collections.abc import Iterable, Sequence

from airhockey.reporting.markup import Child, Markup, element, joined

Row = Sequence[Child]


def section(identifier: str, heading: str, *content: Child) -> Markup:
    """A section that the page's navigation can point to."""
    return element("section", element("h2", heading), content, id=identifier)


def table(caption: str, head: Row, rows: Iterable[Row], *, numbers_from: int = 1, prose: bool = False) -> Markup:
    """A table in a box that scrolls sideways and can be reached by keyboard.

    Args:
        caption: What it shows; read out, not shown.
        head: The columns' names; the first cell of every row names the row.
        numbers_from: The first column that holds numbers, which stand on the right.
        prose: Whether cells hold sentences, which may break.
    """
    parts = [
        element("caption", caption, class_="hidden"),
        element("thead", element("tr", *(_head(cell, k >= numbers_from) for k, cell in enumerate(head)))),
        element("tbody", *(element("tr", *_cells(row, numbers_from)) for row in rows)),
    ]
    whole = element("table", *parts, class_="prose" if prose else None)
    return element("div", whole, class_="scroll", tabindex=0, role="region", aria_label=caption)


def figure(
    caption: Child, drawing: Markup, *, legend: Sequence[tuple[str, str]] = (), data: Markup | None = None
) -> Markup:
    """A drawing with its caption, a legend of (class, meaning), and a table of what it shows to unfold."""
    key = [element("span", element("i", class_=class_), meaning) for class_, meaning in legend]
    return element(
        "figure",
        element("figcaption", caption),
        drawing,
        element("p", *key, class_="legend") if key else None,
        details("Data", data) if data is not None else None,
    )


def wide(drawing: Markup, label: str) -> Markup:
    """A drawing that keeps a readable size and scrolls in its own box on a narrow page."""
    return element("div", drawing, class_="scroll wide", tabindex=0, role="region", aria_label=label)


def tables(*those: tuple[str, Markup]) -> Markup:
    """Tables with their headings, beside each other where there is room."""
    return element("div", *(element("div", element("h3", heading), one) for heading, one in those), class_="tables")


def figures(*those: Markup | None) -> Markup:
    """Figures beside each other, as many as the page is wide."""
    return element("div", *(one for one in those if one is not None), class_="figures")


def details(summary: str, *content: Child) -> Markup:
    """Something to unfold."""
    return element("details", element("summary", summary), content)


def facts(pairs: Iterable[tuple[str, Child]]) -> Markup:
    """Terms and what they are."""
    return element("dl", *(element("div", element("dt", term), element("dd", value)) for term, value in pairs))


def paragraphs(sentences: Iterable[Child], class_: str | None = None) -> Markup:
    """A paragraph each."""
    return joined(element("p", sentence, class_=class_) for sentence in sentences)


def badge(deployability: str) -> Markup:
    """A deployability class, with its colour."""
    return element("span", deployability, class_=f"class {deployability.lower()}")


def _head(cell: Child, is_number: bool) -> Markup:
    return element("th", cell, scope="col", class_="number" if is_number else None)


def _cells(row: Row, numbers_from: int) -> list[Markup]:
    first = element("th", row[0], scope="row")
    rest = [
        element("td", cell, class_="number" if k >= numbers_from else None) for k, cell in enumerate(row[1:], start=1)
    ]
    return [first, *rest]

"""Results in notebooks: what `_repr_html_` gives, a table for people."""

import html
from collections.abc import Iterable, Sequence

from airhockey.inputs.names import shown


def table(caption: str, head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table; what stands in it may be a stranger's text.

    Args:
        caption: Above it.
        head: The columns' names.
        rows: The first cell of each names it.
    """

    def line(cells: Sequence[object], tag: str) -> str:
        first, *others = (html.escape(shown(cell)) for cell in cells)
        return f"<tr><th>{first}</th>{''.join(f'<{tag}>{cell}</{tag}>' for cell in others)}</tr>"

    body = "".join(line(row, "td") for row in rows)
    title = html.escape(shown(caption, 500))
    return f"<table><caption>{title}</caption><thead>{line(head, 'th')}</thead><tbody>{body}</tbody></table>"

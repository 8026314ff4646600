"""HTML and SVG as nested calls: whatever is not markup already is escaped, so that nobody's name can become code."""

import html
from collections.abc import Iterable
from typing import Any


class Markup(str):
    """Text that is markup: only `element` and `joined` make it."""

    __slots__ = ()


Child = str | int | None | Iterable["Child"]

_VOID = frozenset(("br", "hr", "link", "meta"))
_UNPRINTABLE = dict.fromkeys((*range(9), 11, 12, *range(14, 32), 127), "\N{REPLACEMENT CHARACTER}")


def element(tag: str, *children: Child, **attributes: Any) -> Markup:
    """An element.

    Args:
        tag: Its name.
        children: Text, which is escaped; markup, which is not; None, which is left out; or iterables of these.
        attributes: `class_` stands for class, `_` elsewhere for `-`. None and False leave an attribute out, True gives it no
            value; numbers are written as briefly as a drawing allows.
    """
    given = "".join(_attribute(name, value) for name, value in attributes.items())
    if tag in _VOID:
        return Markup(f"<{tag}{given}>")
    return Markup(f"<{tag}{given}>{joined(*children)}</{tag}>")


def joined(*children: Child) -> Markup:
    """Children without an element around them."""
    return Markup("".join(_child(child) for child in children))


def number(value: float) -> str:
    """A coordinate to a tenth of a unit, as short as it can be."""
    short = f"{value:.1f}".removesuffix(".0")
    return "0" if short == "-0" else short


def _child(child: Child) -> str:
    if child is None:
        return ""
    if isinstance(child, Markup):
        return child
    if isinstance(child, (str, int, float)):
        return _escaped(str(child))
    return "".join(_child(each) for each in child)


def _attribute(name: str, value: Any) -> str:
    if value is None or value is False:
        return ""
    name = name.rstrip("_").replace("_", "-")
    if value is True:
        return f" {name}"
    text = number(value) if isinstance(value, float) else _escaped(str(value))
    return f' {name}="{text}"'


def _escaped(text: str) -> str:
    return html.escape(text.encode("utf-8", "replace").decode().translate(_UNPRINTABLE))

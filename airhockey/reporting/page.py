"""A page: one HTML file with its style in it, which asks the network for nothing and may not."""

from collections.abc import Sequence
from functools import cache
from importlib import resources

from airhockey.reporting.markup import Child, Markup, element, joined

_POLICY = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"


def page(
    title: str,
    subtitle: Child,
    content: Sequence[Markup],
    links: Sequence[tuple[str, str]],
    foot: Child,
    here: str = "",
) -> str:
    """A whole page.

    Args:
        title: Its heading and its name in the browser.
        subtitle: Below the heading.
        content: Sections.
        links: Target and name of everything in the navigation.
        foot: The last line.
        here: The target that is this page.
    """
    head = element(
        "head",
        element("meta", charset="utf-8"),
        element("meta", http_equiv="Content-Security-Policy", content=_POLICY),
        element("meta", name="viewport", content="width=device-width, initial-scale=1"),
        element("meta", name="color-scheme", content="light dark"),
        element("meta", name="generator", content="hockey"),
        element("title", title),
        element("style", Markup(_style())),
    )
    anchors = (
        element("a", name, href=target, aria_current="page" if target == here else None) for target, name in links
    )
    navigation = element("nav", *anchors, aria_label="Contents")
    body = element(
        "body",
        element("a", "Skip to the content", class_="skip", href="#content"),
        element("header", element("h1", title), element("p", subtitle), navigation if links else None),
        element("main", *content, id="content", tabindex=-1),
        element("footer", element("p", foot)),
    )
    return "<!doctype html>\n" + element("html", head, body, lang="en") + "\n"


def contents(sections: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Links to sections of the same page, from identifiers and names."""
    return [(f"#{identifier}", name) for identifier, name in sections]


def link(target: str, name: str) -> Markup:
    """A link to another page of the same site."""
    return joined(element("a", name, href=target))


@cache
def _style() -> str:
    return resources.files("airhockey.reporting").joinpath("style.css").read_text(encoding="utf-8")

"""Pages in a real browser: no errors, no requests, no sideways scrolling, dark mode, keyboard, print."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from results import ENV, Results
from tools import chromium

from airhockey.reporting import report, write_site

QUIET = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)
PHONE, DESK = {"width": 375, "height": 800}, {"width": 1280, "height": 900}


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    path = chromium()
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=list(QUIET))
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def pages(results: Results, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Reports of every kind and the pages of a leaderboard."""
    folder = tmp_path_factory.mktemp("pages")
    everything = [results.swings, results.holds, results.other, results.match, results.tournament]
    for name, sources in (
        ("everything", everything),
        ("run", [results.swings]),
        ("gap", [results.holds, folder / "nowhere"]),
    ):
        (folder / f"{name}.html").write_text(report(sources)[0])
    write_site(results.root, folder / "site")
    found = {"everything": folder / "everything.html", "run": folder / "run.html", "gap": folder / "gap.html"}
    site = {
        name: folder / "site" / f"{name}.html"
        for name in ("index", "games", f"task-{ENV}", "entry-hold", "reports/match")
    }
    return {**found, **site}


NAMES = ["everything", "run", "gap", "index", "games", f"task-{ENV}", "entry-hold", "reports/match"]


def opened(browser: Any, path: Path, viewport: dict[str, int], **options: Any) -> tuple[Any, list[str]]:
    """The page, and what it complained about or asked the network for."""
    page = browser.new_page(viewport=viewport, **options)
    trouble: list[str] = []
    page.on("console", lambda message: trouble.append(f"console: {message.text}"))
    page.on("pageerror", lambda error: trouble.append(f"error: {error}"))
    page.on(
        "request", lambda request: trouble.append(f"request: {request.url}") if request.url != path.as_uri() else None
    )
    page.goto(path.as_uri())
    return page, trouble


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("viewport", [PHONE, DESK], ids=["phone", "desk"])
def test_a_page_is_quiet_asks_for_nothing_and_does_not_scroll_sideways(
    browser: Any, pages: dict[str, Path], name: str, viewport: dict[str, int]
) -> None:
    page, trouble = opened(browser, pages[name], viewport)
    page.evaluate("document.querySelectorAll('details').forEach(one => one.open = true)")
    assert page.evaluate("document.documentElement.scrollWidth") <= viewport["width"]
    assert trouble == []
    beyond = page.evaluate(
        """[...document.querySelectorAll('main *')].filter(one => !one.closest('.scroll') && !one.closest('svg')
           && !one.classList.contains('hidden') && one.getBoundingClientRect().right > innerWidth + 1)
           .map(one => one.outerHTML)"""
    )
    assert beyond == []
    page.close()


def test_drawings_have_names_and_words_that_can_be_read_on_a_phone(browser: Any, pages: dict[str, Path]) -> None:
    page, _ = opened(browser, pages["everything"], PHONE)
    drawings = page.get_by_role("img").all()
    assert len(drawings) > 20
    assert all(drawing.get_attribute("aria-label") for drawing in drawings)
    sizes = page.evaluate(
        """[...document.querySelectorAll('svg')].filter(one => one.checkVisibility()).map(one =>
           parseFloat(getComputedStyle(one).fontSize) * one.getBoundingClientRect().width / one.viewBox.baseVal.width)"""
    )
    assert min(sizes) > 9.0
    page.close()


def test_dark_mode_turns_paper_and_ink_and_keeps_them_apart(browser: Any, pages: dict[str, Path]) -> None:
    light, dark = (colours(browser, pages["everything"], scheme) for scheme in ("light", "dark"))
    assert luminance(light["paper"]) > 0.9 and luminance(dark["paper"]) < 0.05
    for scheme in (light, dark):
        for part in ("ink", "note", "link", "label"):
            assert contrast(scheme[part], scheme["paper"]) >= 4.5, part  # WCAG 2.2, level AA
    assert light["bar"] != dark["bar"]


def test_the_keyboard_reaches_the_content_the_tables_and_what_is_folded(browser: Any, pages: dict[str, Path]) -> None:
    page, _ = opened(browser, pages["everything"], DESK)
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    assert page.evaluate("document.activeElement.getBoundingClientRect().left") >= 0
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "content"
    seen = set()
    for _ in range(30):
        page.keyboard.press("Tab")
        seen.add(page.evaluate("document.activeElement.tagName + ' ' + document.activeElement.className"))
        if page.evaluate("document.activeElement.tagName") == "SUMMARY":
            page.keyboard.press("Enter")
            assert page.evaluate("document.activeElement.parentElement.open")
            break
    assert {"DIV scroll", "SUMMARY "} <= seen
    outline = page.evaluate("getComputedStyle(document.activeElement).outlineStyle")
    assert outline != "none"
    page.close()


def test_tables_are_tables_with_captions_and_headed_rows_and_columns(browser: Any, pages: dict[str, Path]) -> None:
    page, _ = opened(browser, pages["everything"], DESK)
    tables = page.evaluate(
        """[...document.querySelectorAll('table')].map(one => [one.caption?.textContent, one.tHead.rows[0].cells.length,
           [...one.tBodies[0].rows].every(row =>
             row.cells.length == one.tHead.rows[0].cells.length && row.cells[0].scope == 'row')])"""
    )
    assert len(tables) > 15
    assert all(caption and columns > 1 and whole for caption, columns, whole in tables)
    page.close()


def test_a_page_prints_on_paper_without_what_is_only_for_the_screen(browser: Any, pages: dict[str, Path]) -> None:
    page, _ = opened(browser, pages["run"], DESK, color_scheme="dark")
    page.emulate_media(media="print", color_scheme="dark")
    assert not page.locator("nav").is_visible()
    assert luminance(page.evaluate("getComputedStyle(document.body).backgroundColor")) > 0.9
    assert luminance(page.evaluate("getComputedStyle(document.body).color")) < 0.1
    page.close()


def test_the_links_of_a_site_work_from_the_disk(browser: Any, pages: dict[str, Path]) -> None:
    page, _ = opened(browser, pages["index"], DESK)
    page.get_by_role("link", name=ENV).first.click()
    assert page.title() == ENV
    page.get_by_role("link", name="report").first.click()
    assert page.get_by_role("heading", name="Summary").is_visible()
    page.get_by_role("link", name="Leaderboard").click()
    assert page.title() == "Leaderboard"
    page.close()


def colours(browser: Any, path: Path, scheme: str) -> dict[str, str]:
    """Colours as the browser computes them."""
    page, _ = opened(browser, path, DESK, color_scheme=scheme)
    found: dict[str, str] = page.evaluate(
        """Object.fromEntries(Object.entries({paper: ['body', 'backgroundColor'], ink: ['body', 'color'],
             note: ['.note', 'color'], link: ['nav a', 'color'], label: ['svg text.label', 'fill'],
             bar: ['svg circle.a', 'fill']}).map(([name, [where, what]]) =>
             [name, getComputedStyle(document.querySelector(where))[what]]))"""
    )
    page.close()
    return found


def luminance(colour: str) -> float:
    """Relative luminance of "rgb(r, g, b)" (WCAG 2.2)."""
    channels = [int(part) / 255 for part in colour.removeprefix("rgb(").removesuffix(")").split(",")]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    """Contrast of two colours, 1 … 21 (WCAG 2.2)."""
    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)

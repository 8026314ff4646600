"""The documentation as it is built: no dead link, nothing from elsewhere, every command and option described."""

import re
import shlex
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag

import click
import pytest
import yaml
from tools import chromium

from airhockey.cli import hockey

ROOT = Path(__file__).parents[2]
PAGES = [page for page in sorted((ROOT / "docs").rglob("*.md")) if page.name != "commands.md"]
COMMANDS = hockey.list_commands(click.Context(hockey))
CODE_BLOCK = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)


class Page(HTMLParser):
    """What a page links to, what it loads, and the places in it that can be linked to."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: set[str] = set()
        self.loads: set[str] = set()
        self.anchors: set[str] = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value for name, value in attrs if value is not None}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        if tag == "a" and "href" in given:
            self.links.add(given["href"])
        if tag == "link" and given.get("rel") in ("stylesheet", "preload", "preconnect", "icon"):
            self.loads.add(given["href"])
        if tag in ("script", "img", "iframe", "video", "source") and "src" in given:
            self.loads.add(given["src"])


def build(folder: Path) -> subprocess.CompletedProcess[str]:
    """Build a copy of the documentation as `make docs` does."""
    script = [sys.executable, str(ROOT / "scripts" / "command_reference.py"), "docs/commands.md"]
    subprocess.run(script, cwd=folder, check=True)
    zensical = [sys.executable, "-m", "zensical", "build", "--strict", "--clean"]
    return subprocess.run(zensical, cwd=folder, capture_output=True, text=True, check=False)


def copy_sources(folder: Path) -> Path:
    shutil.copytree(ROOT / "docs", folder / "docs")
    shutil.copy(ROOT / "mkdocs.yml", folder)
    return folder


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the sources, with the site in build/site."""
    folder = copy_sources(tmp_path_factory.mktemp("documentation"))
    built = build(folder)
    assert built.returncode == 0, built.stdout + built.stderr
    return folder


@pytest.fixture(scope="module")
def site(sources: Path) -> dict[Path, Page]:
    """The pages that were built, by their paths; the page for what is not found is no page of its own."""
    folder = sources / "build" / "site"
    return {path: Page(path) for path in sorted(folder.rglob("*.html")) if path.name != "404.html"}


def test_every_source_became_a_page(site: dict[Path, Page]) -> None:
    assert len(site) == len(PAGES) + 1  # the reference of the commands


def test_every_link_leads_somewhere(site: dict[Path, Page]) -> None:
    dead = []
    for path, page in site.items():
        for link in page.links | page.loads:
            address, anchor = urldefrag(link)
            if ":" in address.split("/")[0]:
                continue  # elsewhere
            target = (path.parent / unquote(address)).resolve() if address else path
            target = target / "index.html" if target.is_dir() else target
            if not target.is_file() or (anchor and target in site and unquote(anchor) not in site[target].anchors):
                dead.append(f"{path.name}: {link}")
    assert dead == []


def test_nothing_is_fetched_from_elsewhere(site: dict[Path, Page]) -> None:
    assert [load for page in site.values() for load in page.loads if load.startswith(("http:", "https:", "//"))] == []


def test_pages_are_whole_in_a_browser_on_a_phone(site: dict[Path, Page]) -> None:
    """Opened from the disk: every picture is there, nothing is asked of the network, nothing sticks out sideways."""
    path = chromium()
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox", "--disable-gpu"])
        tab = browser.new_page(viewport={"width": 375, "height": 800})
        asked: list[str] = []
        tab.on("request", lambda request: asked.append(request.url))
        for path in site:
            tab.goto(path.as_uri())
            assert tab.evaluate("[...document.images].every(image => image.naturalWidth > 0)"), path.name
            assert tab.evaluate("document.documentElement.scrollWidth <= innerWidth"), path.name
        browser.close()
    assert [url for url in asked if not url.startswith(("file:", "data:"))] == []


@pytest.mark.parametrize("link", ["[a page](nowhere.md)", "[a heading](scaling.md#nowhere)"])
def test_a_dead_link_fails_the_build(tmp_path: Path, link: str) -> None:
    index = copy_sources(tmp_path) / "docs" / "index.md"
    index.write_text(f"{index.read_text()}\n{link}\n")
    assert build(tmp_path).returncode != 0


def test_every_page_is_in_the_navigation(sources: Path) -> None:
    listed = set(re.findall(r"[\w/-]+\.md", yaml.safe_dump(yaml.safe_load((ROOT / "mkdocs.yml").read_text())["nav"])))
    assert listed == {str(page.relative_to(sources / "docs")) for page in (sources / "docs").rglob("*.md")}


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_is_described_with_its_options_and_examples(sources: Path, name: str) -> None:
    page = (sources / "docs" / "commands.md").read_text(encoding="utf-8")
    section = re.split(r"^## ", page.partition(f"\n## hockey {name}\n")[2], maxsplit=1, flags=re.MULTILINE)[0]
    command = hockey.get_command(click.Context(hockey), name)
    options = [option for parameter in command.params for option in parameter.opts if option.startswith("-")]
    assert [option for option in options if f"`{option}`" not in section] == []
    examples = [line.strip() for line in command.help.splitlines() if line.startswith(f"hockey {name} ")]
    assert [example for example in examples if example not in section] == []


def command_lines() -> list[str]:
    """Every command line of ours that a page shows."""
    sources = [*PAGES, ROOT / "README.md", ROOT / "submissions" / "README.md"]
    texts = (re.sub(r"\\\n\s*", " ", page.read_text(encoding="utf-8")) for page in sources)
    lines = (line.removeprefix("$ ") for text in texts for line in text.splitlines())
    return sorted({re.split(r"\s{2,}", line)[0] for line in lines if re.match(r"hockey [a-z-]+ ", line)})


@pytest.mark.parametrize("line", command_lines())
def test_a_command_line_that_is_shown_has_options_that_exist(line: str) -> None:
    """Options and their values; whether an agent or a folder exists is not looked at."""
    _, name, *arguments = shlex.split(line, comments=True)
    command = hockey.get_command(click.Context(hockey), name)
    command.make_context(name, arguments)


@pytest.mark.parametrize("page", [*PAGES, ROOT / "README.md", ROOT / "submissions" / "README.md"], ids=lambda p: p.stem)
def test_files_of_the_repository_that_are_named_exist(page: Path) -> None:
    text = CODE_BLOCK.sub("", page.read_text(encoding="utf-8"))
    links = [link for link in re.findall(r"\]\(([^)#\s]+)", text) if ":" not in link and link != "commands.md"]
    paths = re.findall(r"`((?:airhockey|benchmarks|docs|scripts|tests)/[\w./-]+)`", text)
    missing = [link for link in links if not (page.parent / link).exists() and not link.endswith("commands.md")]
    files = [path for path in paths if not re.search(r"-v\d$", path)]  # those are Gymnasium's ids
    assert missing + [path for path in files if not (ROOT / path).exists()] == []

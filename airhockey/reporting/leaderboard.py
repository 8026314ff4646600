"""A static site of everything below a folder: `write_site` finds the results, ranks them and writes the pages."""

import datetime
import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from airhockey import __version__
from airhockey.envs.editions import available, edition
from airhockey.errors import AirHockeyError, ConfigurationError
from airhockey.evaluator.judging.tasks import OFFICIAL_EPISODES
from airhockey.evaluator.runs.reader import MANIFESTS, Match, Run, Source, Tournament, Unreadable, open_source
from airhockey.reporting import words
from airhockey.reporting.document import report
from airhockey.reporting.entries import boards, in_order, phases
from airhockey.reporting.markup import Markup
from airhockey.reporting.page import link, page
from airhockey.reporting.results import Task
from airhockey.reporting.sections.board import history_section, overall_section, see, task_section
from airhockey.reporting.sections.match import matches_section
from airhockey.reporting.sections.summary import missing
from airhockey.reporting.sections.tournament import standings_section
from airhockey.reporting.site import SiteFolder, check_place, slug

Say = Callable[[str], None]
INDEX = "index.html"
GAMES = "games.html"
_LATEST = 5  # tournaments and matches on the first page


def write_site(folder: Path, site: Path, say: Say = lambda _: None) -> tuple[int, list[str]]:
    """Write the site of a folder of results.

    Args:
        folder: Runs, matches and tournaments lie anywhere below it.
        site: Where the pages go: a new or empty folder, or an earlier site.
        say: Told what is being done.

    Returns:
        Number of pages, and a line for everything that is missing.

    Raises:
        ConfigurationError: There are no results, or the site's folder holds something else.
        AirHockeyError: The disk is full or cannot be written to.
    """
    if not folder.is_dir():
        raise ConfigurationError(f"there is no folder {str(folder)!r}")
    check_place(site)
    sources = []
    for path in results_below(folder, site):
        say(f"reading {path}")
        sources.append(open_source(path))
    if all(isinstance(source, Unreadable) for source in sources):
        lost = "; ".join(f"{source.path}: {note}" for source in sources for note in source.notes)
        raise ConfigurationError(f"no results below {str(folder)!r}" + (f": {lost}" if lost else ""))
    try:
        return _Site(folder, sources, SiteFolder(site)).write(say)
    except OSError as error:
        raise AirHockeyError(f"cannot write to {str(site)!r}: {error}") from error


def results_below(folder: Path, site: Path) -> Iterator[Path]:
    """Folders of results, in the order of their paths; links to folders, hidden folders and the site are passed over."""
    skipped = site.resolve()
    for here, below, files in os.walk(folder):
        if any(name in MANIFESTS and not (Path(here) / name).is_symlink() for name in files):
            below.clear()
            yield Path(here)
        below[:] = sorted(
            name for name in below if not name.startswith(".") and (Path(here) / name).resolve() != skipped
        )


class _Site:
    """Which page holds what.

    Args:
        folder: Of the results.
        sources: What was found there.
        site: Where the pages go.
    """

    def __init__(self, folder: Path, sources: Sequence[Source], site: SiteFolder) -> None:
        self.folder, self.sources, self.site = folder, sources, site
        self.usable = [source for source in sources if not isinstance(source, Unreadable)]
        self.slugs = {id(source): _slug_below(folder, source.path) for source in self.usable}
        runs = [source for source in self.usable if isinstance(source, Run)]
        self.boards = boards(Task(run, run.agent, env, run.of(env)) for run in runs for env in run.environments)
        self.entries = sorted({name for board in self.boards for name in board.results})
        self.environments = in_order({env for board in self.boards for env in board.environments})
        games = [source for source in self.usable if isinstance(source, (Match, Tournament))]
        self.games = sorted(games, key=lambda source: source.created, reverse=True)

    def write(self, say: Say) -> tuple[int, list[str]]:
        """Write all pages; gives their number, and what is missing."""
        notes = [f"{source.path}: {note}" for source in self.sources for note in source.notes]
        for source in self.usable:
            say(f"reporting on {source.path}")
            text, found = report([source.path], back=f"../{INDEX}", below=self.folder)
            notes += found
            self.site.write(self._report_file(source), text)
            for video in _videos(source):
                self.site.copy(video, self._video_file(source, video))
        self._page(INDEX, "Leaderboard", self._subtitle(), self._overall())
        for env in self.environments:
            parts = [
                task_section(board, env, self._entry, self._see) for board in self.boards if env in board.environments
            ]
            self._page(self._task_file(env), env, "Ranked within each class of deployability.", parts)
        for name in self.entries:
            self._page(self._entry_file(name), name, "All runs of this entry.", self._history(name))
        if self.games:
            self._page(GAMES, "Games", "Tournaments and matches.", self._games())
        self.site.end()
        return self.site.pages, list(dict.fromkeys(notes))

    def _overall(self) -> list[Markup]:
        parts: list[Markup | None] = []
        for board in self.boards:
            known = board.condition.edition in available()
            rules = edition(board.condition.edition if known else available()[0])
            parts += [overall_section(board, phase, weights, self._entry) for phase, weights in phases(rules).items()]
        parts += [*self._games(_LATEST), missing(self.sources, self.folder)]
        return [part for part in parts if part is not None]

    def _history(self, name: str) -> list[Markup]:
        histories = [history_section(board, name, self._see) for board in self.boards]
        return [history for history in histories if history is not None]

    def _games(self, most: int | None = None) -> list[Markup]:
        """Every tournament's standings, then the matches, the latest first; or only some of each."""
        tournaments = [source for source in self.games if isinstance(source, Tournament)][:most]
        matches = [source for source in self.games if isinstance(source, Match)][:most]
        parts = [standings_section(one, self.slugs[id(one)], see(self._links(one))) for one in tournaments]
        return parts + ([matches_section([(match, see(self._links(match))) for match in matches])] if matches else [])

    def _subtitle(self) -> str:
        runs = sum(isinstance(source, Run) for source in self.usable)
        games = sum(len(source.records) for source in self.games)
        entries = f"{len(self.entries)} {'entry' if len(self.entries) == 1 else 'entries'}"
        return " · ".join([entries, words.count(runs, "run"), words.count(games, "game")])

    def _page(self, name: str, title: str, subtitle: str, parts: Sequence[Markup]) -> None:
        links = [(INDEX, "Overall"), *((self._task_file(env), env) for env in self.environments)]
        if self.games:
            links.append((GAMES, "Games"))
        made = datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M")
        foot = (
            f"* fewer than {OFFICIAL_EPISODES} episodes; the class is that of the penalty at the rate of so many. Of several "
            f"runs of a task the one with the most episodes, up to {OFFICIAL_EPISODES}, counts, and of those the latest. "
            f"Made by hockey {__version__} on {made}."
        )
        self.site.write(name, page(title, subtitle, parts, links, foot, here=name))

    def _see(self, task: Task) -> Markup:
        return see(self._links(task.run))

    def _links(self, source: Source) -> list[tuple[str, str]]:
        videos = [(self._video_file(source, video), f"▶ {video.stem}") for video in _videos(source)]
        return [(self._report_file(source), "report"), *videos]

    def _entry(self, name: str) -> Markup:
        return link(self._entry_file(name), name)

    def _entry_file(self, name: str) -> str:
        return f"entry-{slug(name)}.html"

    def _task_file(self, env: str) -> str:
        return f"task-{slug(env)}.html"

    def _report_file(self, source: Source) -> str:
        return f"reports/{self.slugs[id(source)]}.html"

    def _video_file(self, source: Source, video: Path) -> str:
        return f"videos/{self.slugs[id(source)]}/{slug(video.stem)}.mp4"


def _slug_below(folder: Path, path: Path) -> str:
    return slug(path.relative_to(folder).as_posix() if path != folder else path.resolve().name)


def _videos(source: Source) -> list[Path]:
    return sorted(file for file in source.path.glob("*.mp4") if file.is_file() and not file.is_symlink())

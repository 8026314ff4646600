"""A report: folders of results in, one page out."""

import datetime
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from airhockey import __version__
from airhockey.errors import ConfigurationError
from airhockey.evaluator.analysis.game import GameAnalysis, analyse_game
from airhockey.evaluator.runs.reader import Match, Run, Source, Tournament, Unreadable, open_source
from airhockey.inputs.broken import BROKEN, reason
from airhockey.reporting import words
from airhockey.reporting.episodes import TaskData, read_task
from airhockey.reporting.markup import Markup
from airhockey.reporting.page import contents, page
from airhockey.reporting.results import Task
from airhockey.reporting.sections.comparison import comparison_section
from airhockey.reporting.sections.games import PlayedGame
from airhockey.reporting.sections.match import match_section
from airhockey.reporting.sections.quantities import FEW
from airhockey.reporting.sections.summary import conditions, missing, summary
from airhockey.reporting.sections.task import task_section
from airhockey.reporting.sections.tournament import tournament_section

Say = Callable[[str], None]
_MOST_FILMS = 60
"""Films of a folder that are analysed; reading the film of a whole game takes about a third of a second."""


@dataclass
class Part:
    """A section with its place in the navigation."""

    identifier: str
    name: str
    section: Markup


def report(
    paths: Sequence[Path], say: Say = lambda _: None, back: str | None = None, below: Path | None = None
) -> tuple[str, list[str]]:
    """The page of some folders.

    Args:
        paths: Folders of runs, matches and tournaments.
        say: Told what is being read.
        back: Relative link to the leaderboard that the page belongs to.
        below: The page shows paths below this folder.

    Returns:
        The page, and a line for everything that is missing.

    Raises:
        ConfigurationError: None of the folders holds anything that can be shown.
    """
    sources = _opened(paths, say)
    notes = [f"{source.path}: {note}" for source in sources for note in source.notes]
    usable = [source for source in sources if not isinstance(source, Unreadable)]
    if not usable:
        raise ConfigurationError(f"there is nothing to report on: {'; '.join(notes)}")
    labels = labels_of(usable)
    tasks = [task for source in usable if isinstance(source, Run) for task in _tasks(source, labels[id(source)], say)]
    parts = _task_parts(tasks)
    for number, source in enumerate(usable):
        if isinstance(source, (Match, Tournament)):
            parts.append(_game_part(source, f"games-{number}", say))
    lost = missing(sources, below)  # after reading: that may have found more
    parts = ([Part("missing", "What is missing", lost)] if lost else []) + parts
    parts.append(Part("conditions", "Conditions", conditions(usable, labels)))
    notes = [f"{source.path}: {note}" for source in sources for note in source.notes]
    links = contents([(part.identifier, part.name) for part in parts])
    if back:
        links.insert(0, (back, "← Leaderboard"))
    heading = _title(usable, labels)
    made = datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M")
    foot = f"Made by hockey {__version__} on {made} from {words.count(len(usable), 'folder')}."
    return page(heading, _subtitle(usable), [part.section for part in parts], links, foot), notes


def labels_of(sources: Sequence[Source]) -> dict[int, str]:
    """A name for every folder, as short as tells it from the others; by the folder object's id."""
    ways: list[Callable[[Source], str]] = [
        _who,
        lambda source: f"{_who(source)}, {source.disturbances}",
        lambda source: f"{_who(source)}, {source.path.name}",
        lambda source: f"{_who(source)}, {source.path}",
    ]
    for way in ways:
        named = {id(source): way(source) for source in sources}
        if len(set(named.values())) == len(named):
            return named
    return {id(source): f"{_who(source)} ({number})" for number, source in enumerate(sources, start=1)}


def _opened(paths: Sequence[Path], say: Say) -> list[Source]:
    """Every folder once, whichever way it was spelled."""
    unique = {path.resolve(): path for path in reversed(paths)}
    sources = []
    for path in reversed(unique.values()):
        say(f"reading {path}")
        sources.append(open_source(path))
    return sources


def _who(source: Source) -> str:
    if isinstance(source, Run):
        return source.agent
    return source.path.name


def _tasks(run: Run, label: str, say: Say) -> list[Task]:
    tasks = []
    for env in run.environments:
        say(f"reading {env} of {run.path}")
        tasks.append(Task(run, label, env, run.of(env), _data(run, env)))
    return tasks


def _data(run: Run, env: str) -> TaskData | None:
    """The trajectories of a task; what cannot be read is noted."""
    try:
        return read_task(run.files, env)
    except BROKEN as error:
        run.notes.append(f"cannot read the trajectories of {env}: {reason(error, run.path)}")
        return None


def _task_parts(tasks: Sequence[Task]) -> list[Part]:
    if not tasks:
        return []
    parts = [Part("summary", "Summary", summary(tasks))]
    by_env: dict[str, list[Task]] = {}
    for task in tasks:
        by_env.setdefault(task.env, []).append(task)
    for env, same in by_env.items():
        if len(same) > 1:
            parts.append(Part(f"compare-{env}", f"Comparison: {env}", comparison_section(env, same, len(tasks) > FEW)))
    for number, task in enumerate(tasks):
        name = task.env if len(by_env[task.env]) == 1 else f"{task.env}: {task.label}"
        parts.append(Part(f"task-{number}", name, task_section(task, f"task-{number}")))
    return parts


def _game_part(source: Match | Tournament, identifier: str, say: Say) -> Part:
    games = []
    for number, record in enumerate(source.records):
        film: GameAnalysis | None = None
        path = source.film(record)
        if path is not None and number < _MOST_FILMS:
            say(f"reading {path}")
            try:
                film = analyse_game(path, record)
            except BROKEN as error:
                source.notes.append(f"cannot read {path.relative_to(source.path)}: {reason(error, source.path)}")
        games.append(PlayedGame(record, film))
    if len(source.records) > _MOST_FILMS:
        source.notes.append(f"only the first {_MOST_FILMS} of {len(source.records)} films are analysed")
    if isinstance(source, Match):
        return Part(identifier, f"Match: {source.path.name}", match_section(source, games, identifier))
    return Part(identifier, f"Tournament: {source.path.name}", tournament_section(source, games, identifier))


def _title(sources: Sequence[Source], labels: dict[int, str]) -> str:
    if len(sources) > 1:
        names = list(dict.fromkeys(labels[id(source)] for source in sources))
        return "Report: " + ", ".join(names[:3]) + ("…" if len(names) > 3 else "")
    source = sources[0]
    if isinstance(source, Run):
        return f"{source.agent}: {', '.join(source.environments)}"
    return ("Match " if isinstance(source, Match) else "Tournament ") + source.path.name


def _subtitle(sources: Sequence[Source]) -> str:
    episodes = sum(len(source.records) for source in sources if isinstance(source, Run))
    games = sum(len(source.records) for source in sources if isinstance(source, (Match, Tournament)))
    parts = [words.count(episodes, "episode")] * bool(episodes) + [words.count(games, "game")] * bool(games)
    profiles = list(dict.fromkeys(source.disturbances for source in sources))
    seeds = list(dict.fromkeys(str(source.manifest.options.seed) for source in sources if source.manifest))
    parts.append(f"disturbances {', '.join(profiles)}")
    if seeds:
        parts.append(f"seed {', '.join(seeds)}")
    return " · ".join(parts)

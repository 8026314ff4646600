"""A session: one command over one run. It opens or resumes, warns, plays with progress, says how to go on, prints."""

import contextlib
import os
import secrets
import shlex
import sys
from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import click
import msgspec

from airhockey.agents import AGENTS
from airhockey.envs.disturbances import available
from airhockey.envs.editions import DEFAULT, edition_of_names
from airhockey.errors import ConfigurationError, EnvironmentFault, SimulationError
from airhockey.evaluator.engines.cluster import engine_of
from airhockey.evaluator.engines.engine import Engine
from airhockey.evaluator.isolation.modes import REMOTE, choose
from airhockey.evaluator.runs.folder import RunFolder
from airhockey.evaluator.runs.game_records import GameOptions
from airhockey.evaluator.runs.manifest import has_option, option_of
from airhockey.inputs.names import one_line, shown
from airhockey.learning.diverged import DivergedError

AGENT_FAILED, NOBODYS_FAULT, INTERRUPTED = 3, 4, 130
"""Exit statuses: an agent failed; environment, profile, machine or a training did, and no agent; the user stopped it."""
RUNS = Path("runs")
MOST_NOTES = 5

Folder = TypeVar("Folder", bound=RunFolder[Any, Any])
Options = TypeVar("Options")
Progress = TypeVar("Progress")
Result = TypeVar("Result")


@dataclass(frozen=True)
class Session:
    """One command over one run.

    Attributes:
        command: As typed, without `hockey`.
        given: Every option's value by its name.
        typed: Names of those that the user typed.
    """

    command: str
    given: Mapping[str, Any]
    typed: set[str]

    @property
    def quiet(self) -> bool:
        """Whether no progress is shown."""
        return any(self.given.get(name) for name in ("quiet", "as_json", "as_csv"))

    def engine(self, most: int | None = None, isolated: bool = False) -> Engine:
        """Where to play, with at most so many jobs at once."""
        count = self.given["jobs"] or cpus()
        return engine_of(self.given["cluster"], count if most is None else min(count, most), isolated=isolated)

    def open(
        self,
        options: Options,
        name: str,
        begin: Callable[[Options, Path], Folder],
        resume: Callable[[Path, dict[str, Any]], Folder],
        agents: Iterable[str] = (),
    ) -> Folder:
        """The run to take up, or a new one.

        Args:
            options: What is asked for.
            name: Of a new folder under runs/.
            begin, resume: Of this kind of run; `resume` gets the options that the user repeated.
            agents: Who plays, to warn of what is not protected once everything else was found to be right.
        """
        out = self.given["out"]
        if self.given["resume"]:
            asked = {field: option_of(options, field) for field in sorted(self.typed) if has_option(options, field)}
            resumed = resume(Path(out), asked)
            say_notes(resumed.notes)
            return resumed
        folder = begin(options, Path(out) if out is not None else new_folder(name))
        say_what_is_not_protected(agents, self.given.get("isolate"))
        return folder

    def run(
        self,
        folder: Folder,
        whole: str,
        progress: AbstractContextManager[Progress],
        play: Callable[[Progress], Result],
        show: Callable[[Result], int],
    ) -> int:
        """Play to the end, and show what came of it.

        Args:
            folder: From `open`.
            whole: How much there is to do, as in "60 episodes"; empty where nothing is counted.
            progress: Shows how far it is.
            play: Does the work.
            show: Prints the result; gives the exit status.

        Returns:
            The exit status.
        """
        try:
            with stdout_for_the_result(), progress as shown:
                result = play(shown)
        except KeyboardInterrupt:
            self._say_how_to_go_on(folder, "interrupted", whole)
            return INTERRUPTED
        except (EnvironmentFault, SimulationError) as error:
            self._say_how_to_go_on(folder, f"{one_line(str(error))}; stopped", whole)
            return NOBODYS_FAULT
        except DivergedError as error:
            click.echo(f"hockey: the training diverged: {error}; the run keeps what was good before", err=True)
            return NOBODYS_FAULT
        return show(result)

    def _say_how_to_go_on(self, folder: Folder, why: str, whole: str) -> None:
        after = f" after {len(folder.records)} of {whole}" if whole else ""
        click.echo(
            f"hockey: {why}{after}; continue with:\n"
            f"  hockey {self.command} --resume --out {shlex.quote(str(folder.path))}",
            err=True,
        )

    def print(self, folder: Folder, result: msgspec.Struct, table: Callable[[], None]) -> None:
        """Print a result as JSON, or as a table that says itself where the result is stored."""
        if not self.given["as_json"]:
            table()
            return
        click.echo(msgspec.json.encode(result))
        self.say_where(folder)

    def say_where(self, folder: Folder) -> None:
        """On the standard error."""
        if not self.given["quiet"]:
            click.echo(f"hockey: stored in {folder.path}", err=True)


def from_anywhere(given: str, names: Container[str] = ()) -> str:
    """A name as it is, the path of something that exists in full, and what is neither for the checks to complain about."""
    path = Path(given).expanduser()
    return given if given in names or not path.exists() else str(path.resolve())


def agent_of(given: str) -> str:
    """A name of the registry, a full path, or an address."""
    return from_anywhere(given, AGENTS)


def disturbances_of(given: Mapping[str, Any]) -> str:
    """A profile's name or a full path."""
    return from_anywhere(given["disturbances"], available())


def agent_seed_of(given: str | None, agents: Iterable[str]) -> str | None:
    """The secret of the agents' seeds: as typed, or drawn where somebody else's code plays."""
    if given is not None or all(agent in AGENTS for agent in agents):
        return given
    return secrets.token_hex(16)


def edition_of(given: Mapping[str, Any], agents: Iterable[str], names: Iterable[str] = ()) -> str:
    """The year whose rules apply: as typed, or as the environments or the submissions say; the user is told where it is theirs.

    Args:
        given: The options.
        agents: Who plays.
        names: Of environments that were typed.

    Raises:
        ConfigurationError: Submissions of several editions are to play each other.
    """
    if given.get("edition") is not None or given.get("resume"):
        return given.get("edition") or DEFAULT
    from airhockey.agents.packaging.edition import edition_of_entry
    from airhockey.agents.submission import is_submission

    by_name = edition_of_names(names)
    if by_name is not None:
        return by_name
    entries = [agent for agent in dict.fromkeys(agents) if not agent.startswith(REMOTE) and is_submission(agent)]
    years = {agent: year for agent in entries if (year := edition_of_entry(Path(agent))) is not None}
    if len(set(years.values())) > 1:
        made_for = ", ".join(f"{Path(agent).name} for {year}" for agent, year in years.items())
        raise ConfigurationError(f"submissions of several editions ({made_for}): say whose rules apply, with --edition")
    for agent, year in years.items():
        if year != DEFAULT:
            click.echo(
                f"hockey: {agent!r} was made for the edition of {year}, whose rules apply (--edition chooses)", err=True
            )
            return year
    return DEFAULT


def python_of(given: str | None) -> str | None:
    """The full path of an interpreter that can run agents; raises `ConfigurationError` for one that cannot."""
    from airhockey.evaluator.isolation.interpreters import interpreter

    return None if given is None else interpreter(given).path


def real_time_of(given: Mapping[str, Any], agents: Mapping[str, str | None], environment: str, edition: str) -> float:
    """The pace asked for, or the one that the agents need; the user is told where it is theirs.

    Args:
        given: The options.
        agents: Who plays -> another interpreter for its process, or None.
        environment, edition: Where.
    """
    if given.get("real_time") is not None:
        return float(given["real_time"])
    if given.get("resume"):
        return 0.0  # the run keeps its own
    from airhockey.evaluator.pacing import pace_for

    for agent, python in agents.items():
        if pace_for(agent, environment, given["isolate"], given["patience"], python, edition):
            click.echo(
                f"hockey: {agent!r} thinks between its steps, in threads or processes: they are paced as on the robot "
                "(--real-time 0 plays as fast as possible)",
                err=True,
            )
            return 1.0
    return 0.0


def game_options_of(given: Mapping[str, Any], agents: Mapping[str, str | None]) -> GameOptions:
    """How games are played, from the options that are there and by what the agents need; `agents` as in `real_time_of`."""
    edition = edition_of(given, agents)
    return GameOptions(
        steps=given["steps"],
        disturbances=disturbances_of(given),
        clock=given.get("clock", "cpu"),
        variant=given.get("variant", "package"),
        isolate=given["isolate"] or "auto",
        patience=given["patience"],
        edition=edition,
        real_time=real_time_of(given, agents, "tournament", edition),
        agent_seed=agent_seed_of(given.get("agent_seed"), agents),
    )


def new_folder(name: str) -> Path:
    """A folder under runs/ that is not there yet."""
    number = 1
    while (RUNS / (name if number == 1 else f"{name}-{number}")).exists():
        number += 1
    return RUNS / (name if number == 1 else f"{name}-{number}")


def cpus() -> int:
    """How many CPUs this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def say_what_is_not_protected(agents: Iterable[str], asked: str | None) -> None:
    """Warn on the standard error."""
    for agent in dict.fromkeys(agents):
        warning = choose(agent, asked).warning
        if warning is not None:
            click.echo(f"hockey: warning: {warning}", err=True)


def say_notes(notes: Iterable[str], most: int | None = None) -> None:
    """What is missing, on the standard error, a line each; a long list is cut."""
    notes = list(notes)
    for note in notes[:most]:
        click.echo(f"hockey: {shown(' '.join(note.split()), 1000)}", err=True)
    if most is not None and len(notes) > most:
        click.echo(f"hockey: … and {len(notes) - most} more of this kind", err=True)


@contextlib.contextmanager
def stdout_for_the_result() -> Iterator[None]:
    """What an agent prints, here or in a worker, goes to the standard error."""
    sys.stdout.flush()
    stdout = os.dup(1)
    os.dup2(2, 1)
    try:
        with contextlib.redirect_stdout(sys.stderr):
            yield
    finally:
        sys.stdout.flush()
        os.dup2(stdout, 1)
        os.close(stdout)

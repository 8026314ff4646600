"""A tournament: every entry plays every other one at home and away, in one phase or two."""

import datetime
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import msgspec

from airhockey import envs
from airhockey.envs.disturbances import Disturbances, load_disturbances
from airhockey.errors import ConfigurationError
from airhockey.evaluator.checks import check_agent, check_game_options, check_versions
from airhockey.evaluator.engines import Engine
from airhockey.evaluator.games.folder import GameFolder, read_game_manifest, read_games
from airhockey.evaluator.games.match import play_games
from airhockey.evaluator.games.player import GamePlayer
from airhockey.evaluator.games.records import GameJob, GameOptions, GameRecord
from airhockey.evaluator.games.standings import Standings, standings, write_standings
from airhockey.evaluator.records import Order
from airhockey.evaluator.seeding import game_seed

TOURNAMENT = "tournament.json"
_NAME_LETTERS = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._")


class Entry(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One competitor.

    Attributes:
        name: Letters, digits, "." and "_"; unique in the tournament.
        agent: A name of the registry, or the absolute path of a submission.
        second_agent: Plays in phase 2 instead, if given.
        interpolation_order: See `records.Order`.
    """

    name: str
    agent: str
    second_agent: str | None = None
    interpolation_order: Order = "agent"

    def agent_in(self, phase: int) -> str:
        """Who plays for this entry in a phase, 1 or 2."""
        return self.second_agent if phase == 2 and self.second_agent is not None else self.agent


class TournamentOptions(msgspec.Struct, frozen=True, kw_only=True):
    """What a tournament is.

    Attributes:
        entries: Who takes part.
        phases: 1 or 2 double round robins.
        seed: A game's seed comes from it, the phase and the two names: not from who else takes part.
        game: How each game is played.
    """

    entries: tuple[Entry, ...]
    phases: int = 1
    seed: int = 0
    game: GameOptions = GameOptions()


class TournamentManifest(msgspec.Struct, frozen=True, kw_only=True):
    """`tournament.json`."""

    options: TournamentOptions
    profile: Disturbances
    versions: dict[str, str]
    created: str
    format: int = 1


OnStandings = Callable[[GameRecord, Standings], None]


def schedule(options: TournamentOptions) -> list[GameJob]:
    """Every game, in rounds: the circle method, then the same pairs with home and away exchanged; in each phase."""
    jobs = []
    for phase in range(1, options.phases + 1):
        first_half = _rounds(options.entries)
        for home, away in [*first_half, *((away, home) for home, away in first_half)]:
            key = f"{phase}/{home.name}-{away.name}"
            jobs.append(
                GameJob(
                    key,
                    home.name,
                    away.name,
                    home.agent_in(phase),
                    away.agent_in(phase),
                    game_seed(options.seed, key),
                    home.interpolation_order,
                    away.interpolation_order,
                )
            )
    return jobs


def begin_tournament(options: TournamentOptions, path: Path) -> GameFolder[TournamentManifest]:
    """Begin a tournament; nothing is written when anything about it is wrong.

    Raises:
        ConfigurationError: An option has no meaning, or the folder holds something or cannot be written.
    """
    check_tournament(options)
    manifest = TournamentManifest(
        options=options,
        profile=load_disturbances(options.game.disturbances),
        versions=envs.versions(),
        created=datetime.datetime.now().astimezone().isoformat(timespec="seconds"),
    )
    return GameFolder.create(path, TOURNAMENT, manifest)


def take_up_tournament(path: Path, added: Iterable[Entry] = ()) -> GameFolder[TournamentManifest]:
    """Take up a tournament that was interrupted, or extend it: only the missing games will be played.

    Raises:
        ConfigurationError: There is none, an entry is not valid, or the software has changed.
    """
    folder = GameFolder.open(path, TOURNAMENT, TournamentManifest)
    manifest = folder.manifest
    check_versions(manifest.versions, path)
    added = tuple(added)
    if added:
        options = msgspec.structs.replace(manifest.options, entries=(*manifest.options.entries, *added))
        check_tournament(options)
        folder.change(msgspec.structs.replace(manifest, options=options))
    return folder


def play_tournament(
    folder: GameFolder[TournamentManifest], engine: Engine | None = None, on_standings: OnStandings | None = None
) -> Standings:
    """Play the missing games; the standings are on the disk after every one."""
    manifest = folder.manifest
    jobs = schedule(manifest.options)
    names = [entry.name for entry in manifest.options.entries]

    def on_game(record: GameRecord) -> None:
        table = write_standings(folder.path, names, jobs, folder.records)
        if on_standings is not None:
            on_standings(record, table)

    play_games(folder, jobs, GamePlayer(manifest.options.game, manifest.profile), engine, on_game)
    return write_standings(folder.path, names, jobs, folder.records)


def read_standings(path: Path) -> tuple[TournamentManifest, Standings]:
    """The standings of a tournament from its folder, finished or not, without playing."""
    manifest = read_game_manifest(path, TOURNAMENT, TournamentManifest)
    names = [entry.name for entry in manifest.options.entries]
    return manifest, standings(names, schedule(manifest.options), read_games(path))


def check_tournament(options: TournamentOptions) -> None:
    """Find the mistakes in a tournament's options; raises `ConfigurationError`."""
    check_game_options(options.game)
    if options.phases not in (1, 2):
        raise ConfigurationError(f"a tournament has 1 or 2 phases, not {options.phases}")
    if len(options.entries) < 2:
        raise ConfigurationError(f"a tournament takes at least two entries; there is only {len(options.entries)}")
    seen: set[str] = set()
    for entry in options.entries:
        if not entry.name or not set(entry.name) <= _NAME_LETTERS:
            raise ConfigurationError(f"entry name {entry.name!r} may hold only letters, digits, '.' and '_'")
        if entry.name in seen:
            raise ConfigurationError(f"there are two entries named {entry.name!r}; give one another name: NAME=AGENT")
        seen.add(entry.name)
        if entry.second_agent is not None and options.phases == 1:
            raise ConfigurationError(f"entry {entry.name!r} has a replacement for phase 2, but there is one phase")
        for phase in range(1, options.phases + 1):
            check_agent(entry.agent_in(phase), ("tournament",))


def entry_of(text: str) -> Entry:
    """An entry as typed: "AGENT", or "NAME=AGENT"."""
    name, _, agent = text.rpartition("=")
    return Entry(name=name or _default_name(agent), agent=agent)


def with_replacements(entries: Iterable[Entry], replacements: Mapping[str, str]) -> tuple[Entry, ...]:
    """The entries, those named in `replacements` with another agent for phase 2."""
    entries = tuple(entries)
    for name in replacements:
        if name not in {entry.name for entry in entries}:
            raise ConfigurationError(
                f"cannot replace {name!r}: the entries are {', '.join(entry.name for entry in entries)}"
            )
    return tuple(
        msgspec.structs.replace(entry, second_agent=replacements.get(entry.name, entry.second_agent))
        for entry in entries
    )


def _default_name(agent: str) -> str:
    return "".join(letter if letter in _NAME_LETTERS else "_" for letter in Path(agent).stem)


def _rounds(entries: tuple[Entry, ...]) -> list[tuple[Entry, Entry]]:
    """Every pair once, in rounds in which nobody plays twice (circle method)."""
    circle: list[Entry | None] = list(entries) + ([None] if len(entries) % 2 else [])
    pairs = []
    for number in range(len(circle) - 1):
        for k in range(len(circle) // 2):
            first, second = circle[k], circle[-1 - k]
            if first is not None and second is not None:
                pairs.append((first, second) if (number + k) % 2 == 0 else (second, first))
        circle.insert(1, circle.pop())
    return pairs

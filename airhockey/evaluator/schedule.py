"""Who plays whom: a tournament's options and its schedule."""

from collections.abc import Mapping

import msgspec

from airhockey.errors import ConfigurationError
from airhockey.evaluator.checks import check_agent, check_game_options, check_seed, check_settings
from airhockey.evaluator.entries import NAME_LETTERS, Entry, with_replacements
from airhockey.evaluator.isolation.modes import check_python
from airhockey.evaluator.play.seeding import game_seed
from airhockey.evaluator.runs.game_records import GameJob, GameOptions


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
                    home.python,
                    away.python,
                    home.settings,
                    away.settings,
                )
            )
    return jobs


def check_tournament(options: TournamentOptions) -> None:
    """Find the mistakes in a tournament's options; raises `ConfigurationError`."""
    check_game_options(options.game)
    check_seed(options.seed)
    if options.phases not in (1, 2):
        raise ConfigurationError(f"a tournament has 1 or 2 phases, not {options.phases}")
    if len(options.entries) < 2:
        raise ConfigurationError(f"a tournament takes at least two entries; there is only {len(options.entries)}")
    seen: set[str] = set()
    for entry in options.entries:
        if not entry.name or not set(entry.name) <= NAME_LETTERS:
            raise ConfigurationError(f"entry name {entry.name!r} may hold only letters, digits, '.' and '_'")
        if entry.name in seen:
            raise ConfigurationError(f"there are two entries named {entry.name!r}; give one another name: NAME=AGENT")
        seen.add(entry.name)
        if entry.second_agent is not None and options.phases == 1:
            raise ConfigurationError(f"entry {entry.name!r} has a replacement for phase 2, but there is one phase")
        for phase in range(1, options.phases + 1):
            check_agent(entry.agent_in(phase), ("tournament",))
            check_python(entry.agent_in(phase), options.game.isolate, entry.python)
            check_settings(entry.agent_in(phase), entry.settings)


def extended(
    options: TournamentOptions, added: tuple[Entry, ...], phases: int | None, replacements: Mapping[str, str]
) -> TournamentOptions:
    """The options with more entries, a second phase, replacements; entries that there are already change nothing.

    Raises:
        ConfigurationError: An entry is another than the one of its name, or there would be fewer phases.
    """
    known = {entry.name: entry for entry in options.entries}
    if phases is not None and phases < options.phases:
        raise ConfigurationError(f"the tournament has {options.phases} phases; that cannot be made {phases}")
    for entry in added:
        before = known.get(entry.name, entry)
        if entry.agent != before.agent or entry.second_agent not in (None, before.second_agent):
            raise ConfigurationError(
                f"the tournament has an entry {entry.name!r} already, with agent {before.agent!r}; give the new one another "
                "name: NAME=AGENT; or, for another agent in phase 2, use --replace"
            )
        for field in ("python", "settings"):
            value, given = getattr(before, field), getattr(entry, field)
            if given and given != value:
                raise ConfigurationError(f"the tournament's entry {entry.name!r} has {field} {value!r}, not {given!r}")
    fresh = tuple(entry for entry in added if entry.name not in known)
    entries = with_replacements((*options.entries, *fresh), replacements)
    return msgspec.structs.replace(options, entries=entries, phases=phases or options.phases)


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

"""Who plays whom: properties of the schedule for any number of entries."""

from collections import Counter
from itertools import permutations

import pytest

from airhockey.errors import ConfigurationError
from airhockey.evaluator.entries import Entry, entry_of, with_replacements
from airhockey.evaluator.schedule import TournamentOptions, check_tournament, extended, schedule


def options(count: int, phases: int = 1, seed: int = 0) -> TournamentOptions:
    entries = tuple(Entry(name=f"e{k}", agent="hold") for k in range(count))
    return TournamentOptions(entries=entries, phases=phases, seed=seed)


@pytest.mark.parametrize("phases", [1, 2])
@pytest.mark.parametrize("count", [2, 3, 4, 5, 8, 16])
def test_every_ordered_pair_exactly_once_in_each_phase(count: int, phases: int) -> None:
    jobs = schedule(options(count, phases))
    pairs = Counter((job.key[0], job.home, job.away) for job in jobs)
    names = [f"e{k}" for k in range(count)]
    assert pairs == Counter((str(p), *pair) for p in range(1, phases + 1) for pair in permutations(names, 2))
    assert (
        len({job.key for job in jobs}) == len({job.seed for job in jobs}) == len(jobs) == phases * count * (count - 1)
    )


@pytest.mark.parametrize("count", [4, 5, 16])
def test_nobody_plays_twice_in_a_round(count: int) -> None:
    jobs, size = schedule(options(count)), count // 2
    for first in range(0, len(jobs), size):
        names = [name for job in jobs[first : first + size] for name in (job.home, job.away)]
        assert len(names) == len(set(names)) == 2 * size


def test_sixteen_teams_play_240_games() -> None:
    assert len(schedule(options(16))) == 240


def test_an_extension_leaves_the_other_games_as_they_were() -> None:
    before = {job.key: job for job in schedule(options(4, phases=2, seed=7))}
    after = {job.key: job for job in schedule(options(5, phases=2, seed=7))}
    assert {key: after[key] for key in before} == before
    assert all("e4" in (job.home, job.away) for key, job in after.items() if key not in before)


def test_a_second_phase_is_other_games_than_the_first() -> None:
    jobs = schedule(options(3, phases=2))
    first, second = jobs[:6], jobs[6:]
    assert [(job.home, job.away) for job in first] == [(job.home, job.away) for job in second]
    assert {job.seed for job in first}.isdisjoint(job.seed for job in second)


def test_a_replacement_plays_in_phase_2_only() -> None:
    given = options(2, phases=2)
    given = TournamentOptions(entries=with_replacements(given.entries, {"e1": "thesis"}), phases=2)
    agents = [(job.key, job.home_agent, job.away_agent) for job in schedule(given)]
    assert sorted(agents) == [
        ("1/e0-e1", "hold", "hold"),
        ("1/e1-e0", "hold", "hold"),
        ("2/e0-e1", "hold", "thesis"),
        ("2/e1-e0", "thesis", "hold"),
    ]


def test_extending() -> None:
    given = options(3)
    assert extended(given, given.entries, None, {}) == given
    more = extended(given, (Entry(name="new", agent="thesis"),), 2, {"e0": "thesis"})
    assert [entry.name for entry in more.entries] == ["e0", "e1", "e2", "new"]
    assert (more.phases, more.entries[0].second_agent) == (2, "thesis")
    with pytest.raises(ConfigurationError, match="'e0' already"):
        extended(given, (Entry(name="e0", agent="thesis"),), None, {})
    with pytest.raises(ConfigurationError, match="cannot be made 1"):
        extended(options(3, phases=2), (), 1, {})
    with pytest.raises(ConfigurationError, match=r"'nobody'.*e0, e1, e2"):
        extended(given, (), 2, {"nobody": "hold"})


@pytest.mark.parametrize(
    ("entries", "named"),
    [
        ([("a", "hold")], "at least two"),
        ([("a", "hold"), ("a", "hold")], "two entries named 'a'"),
        ([("a", "hold"), ("", "hold")], "''"),
        ([("a", "hold"), ("b/c", "hold")], "'b/c'"),
        ([("a", "hold"), ("b", "nobody")], "'nobody'"),
        ([("a", "hold"), ("b", "./nowhere")], "nowhere"),
    ],
)
def test_entries_that_cannot_play(entries: list[tuple[str, str]], named: str) -> None:
    given = TournamentOptions(entries=tuple(Entry(name=name, agent=agent) for name, agent in entries))
    with pytest.raises(ConfigurationError, match=named):
        check_tournament(given)


@pytest.mark.parametrize(
    ("text", "name", "agent"),
    [
        ("hold", "hold", "hold"),
        ("alpha=hold", "alpha", "hold"),
        ("submissions/my-agent", "my_agent", "submissions/my-agent"),
        ("b=some/where", "b", "some/where"),
        ("runs/lr=0.1/mine", "mine", "runs/lr=0.1/mine"),
        ("b=runs/lr=0.1", "b", "runs/lr=0.1"),
    ],
)
def test_an_entry_as_typed(text: str, name: str, agent: str) -> None:
    assert entry_of(text) == Entry(name=name, agent=agent)

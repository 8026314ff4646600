"""Pages as they are written: what they say, that nobody's name becomes code, and that they need nothing but themselves."""

import dataclasses
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from results import ENV, EPISODES, Results

from airhockey.evaluator.analysis.game import analyse_game
from airhockey.evaluator.evaluation import report as evaluators_report
from airhockey.evaluator.judging.tasks import wilson_interval
from airhockey.evaluator.runs.disk import write_record
from airhockey.evaluator.runs.game_records import Event, GameJob, GameRecord, PlayerResult
from airhockey.evaluator.runs.game_trajectories import write_film
from airhockey.evaluator.runs.journal import read_journal
from airhockey.evaluator.runs.manifest import RUN, read_manifest, sealed
from airhockey.evaluator.runs.reader import Run, open_source
from airhockey.evaluator.runs.records import Episode, EpisodeRecord, Options, StepTime
from airhockey.evaluator.runs.trajectories import read_episodes, write
from airhockey.evaluator.tournament import read_standings
from airhockey.reporting import report
from airhockey.reporting.results import Task
from airhockey.reporting.sections.comparison import compare, same_seeds, sentence


class Tree(HTMLParser):
    """Checks that elements are closed in order, and collects what could fetch or run something."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: set[str] = set()
        self.links: list[str] = []
        self.ids: list[str] = []
        self.unlabelled = 0
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.tags.add(tag)
        assert not [name for name in given if name.startswith("on")]
        self.links += [str(given[name]) for name in ("href", "src") if name in given]
        self.ids += [str(given["id"])] if "id" in given else []
        self.unlabelled += tag == "svg" and not given.get("aria-label")
        if tag not in ("meta", "br", "hr", "link"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def checked(page: str) -> Tree:
    """The page, if it is whole, runs nothing, fetches nothing, and its own links have targets."""
    tree = Tree(page)
    assert tree.open == []
    assert not tree.tags & {"script", "img", "iframe", "object", "embed", "link", "video", "audio", "form", "b-swings"}
    assert all(link.startswith("#") for link in tree.links)
    assert {link[1:] for link in tree.links} <= set(tree.ids)
    assert len(tree.ids) == len(set(tree.ids))
    assert tree.unlabelled == 0
    assert "http://" not in page and "https://" not in page and "url(" not in page and "@import" not in page
    return tree


def words_of(page: str) -> str:
    """What a page says, tags taken out."""
    return re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", page.split("</style>")[1]))


def task_of(folder: Path, env: str = ENV) -> Task:
    source = open_source(folder)
    assert isinstance(source, Run)
    return Task(source, source.path.name, env, source.of(env))


@pytest.mark.parametrize(
    "names", [("swings",), ("other",), ("match",), ("tournament",), ("swings", "holds", "other", "match", "tournament")]
)
def test_every_kind_of_page_is_whole_and_alone(results: Results, names: tuple[str, ...]) -> None:
    page, notes = report([getattr(results, name) for name in names])
    checked(page)
    assert notes == []
    assert len(page) < 600_000


def test_a_name_or_an_error_of_others_stays_text(results: Results) -> None:
    page, _ = report([results.swings])
    checked(page)
    assert "&lt;b&gt;swings&amp;" in page and "<b>swings" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page


def test_the_summary_says_what_the_evaluator_says(results: Results) -> None:
    expected: Any = evaluators_report(results.swings)
    task = task_of(results.swings)
    assert (task.verdict.success, task.verdict.penalty) == (expected.success, expected.penalty)
    assert task.violations.items() >= expected.violations.items()
    assert task.verdict.failures == expected.agent_errors == EPISODES // 4
    said = words_of(report([results.swings])[0])
    low, high = wilson_interval(task.verdict.successes, EPISODES)
    for text in (f"{expected.success:.1%}", f"{low:.1%} – {high:.1%}", f"{expected.penalty:g}", "numba", "seed 3"):
        assert text in said


def test_runs_with_the_same_seeds_are_compared_in_pairs(results: Results) -> None:
    comparison = compare(task_of(results.holds), task_of(results.swings))
    one, other = (
        {r.index: r.success for r in read_journal(folder, EpisodeRecord).records}
        for folder in (results.holds, results.swings)
    )
    pairs = [(one[k], other[k]) for k in one]
    expected = tuple(pairs.count(both) for both in ((True, True), (True, False), (False, True), (False, False)))
    assert comparison.pairs == expected
    assert "same seeds" in sentence(comparison, comparison.difference.p_value)
    assert "McNemar" in words_of(report([results.swings, results.holds])[0])


def test_runs_with_other_seeds_are_two_samples_and_the_page_says_what_else_differs(results: Results) -> None:
    comparison = compare(task_of(results.holds), task_of(results.other))
    assert comparison.pairs is None
    said = words_of(report([results.holds, results.other])[0])
    assert "Fisher" in said
    assert "disturbances and seed" in said


def test_a_sentence_has_the_better_one_ahead(results: Results) -> None:
    def made(label: str, wins: int, seed: int) -> Task:
        task = task_of(results.holds)
        assert task.run.manifest is not None
        options = msgspec.structs.replace(task.run.manifest.options, seed=seed)
        run = dataclasses.replace(task.run, manifest=msgspec.structs.replace(task.run.manifest, options=options))
        records = [EpisodeRecord(env=ENV, index=k, success=k < wins) for k in range(200)]
        return Task(run, label, ENV, records)

    worse, better = made("worse", 100, 1), made("better", 180, 1)
    assert same_seeds(worse, better)
    for pair in ((worse, better), (better, worse)):
        comparison = compare(*pair)
        said = sentence(comparison, comparison.difference.p_value)
        assert said.startswith("better succeeds more often than worse, by 40.0 percentage points (95 % interval +3")
        assert "only better succeeded in 80 and only worse in 0" in said
        assert "hardly chance" in said
    even = compare(made("a", 100, 1), made("b", 101, 2))
    assert "no evidence" in sentence(even, even.difference.p_value)
    same = compare(made("a", 100, 1), made("b", 100, 1))
    assert "succeed equally often" in sentence(same, 1.0)


def test_a_run_without_a_single_step_is_reported(results: Results, tmp_path: Path) -> None:
    """An agent that could not even be built fails every episode before its first step."""
    run = tmp_path / "run"
    run.mkdir()
    (run / "run.json").write_bytes((results.holds / "run.json").read_bytes())
    records = [EpisodeRecord(env=ENV, index=k, error="ImportError: no module named <i>x</i>") for k in range(EPISODES)]
    write(run / "trajectories.h5", [Episode(record, {}) for record in records])
    (run / "journal.jsonl").write_bytes(msgspec.json.Encoder().encode_lines(records))
    page, notes = report([run])
    checked(page)
    assert notes == []
    assert "no module named &lt;i&gt;x&lt;/i&gt;" in page


def test_a_thousand_episodes_fit(results: Results, tmp_path: Path) -> None:
    """The page grows with what happens, not with the episodes: 1000 of them, every one violating, stay far below 8 MB."""
    run = tmp_path / "run"
    run.mkdir()
    manifest = read_manifest(results.swings, RUN, Options)
    manifest = msgspec.structs.replace(manifest, options=msgspec.structs.replace(manifest.options, episodes=1000))
    write_record(run / RUN, sealed(manifest))
    played = list(read_episodes(results.swings / "trajectories.h5", ENV))
    random = np.random.default_rng(0)
    many = []
    for k in range(1000):
        record, trajectory = played[k % EPISODES].record, dict(played[k % EPISODES].trajectory)
        moved = trajectory["observations"] + random.normal(0.0, 0.05, (1, trajectory["observations"].shape[1]))
        trajectory["observations"] = moved
        many.append(Episode(msgspec.structs.replace(record, index=k), trajectory))
    write(run / "trajectories.h5", many)
    (run / "journal.jsonl").write_bytes(msgspec.json.Encoder().encode_lines([episode.record for episode in many]))
    page, notes = report([run])
    checked(page)
    assert notes == []
    assert len(page.encode()) < 500_000


def test_goals_of_the_film_are_those_of_the_referee(tmp_path: Path) -> None:
    """A puck that player 1 shoots straight into the goal, and a serve before it that nobody touches."""
    rows = np.zeros((90, 46), dtype=np.float32)
    rows[:, 20], rows[:, 43] = 0.86, -0.86  # home's row holds away's rod tip, and the other way round
    rows[:30, 0] = 0.5
    position, velocity = -0.6, 0.0
    for k in range(30, 90):
        mallet = -0.86 + 0.02 * (k - 30)
        if velocity == 0.0 and mallet > position - 0.0798:
            velocity = 3.0
        position += 0.02 * velocity
        rows[k, 0], rows[k, 3], rows[k, 43] = position, velocity, min(mallet, -0.6)
    events = (Event(step=0, what="serve", who="away"), Event(step=30, what="serve", who="home"))
    side = PlayerResult(
        goals=0,
        points_by_faults=0,
        faults=0,
        penalty=0.0,
        deployability="Deployable",
        violations={},
        held=0,
        computation_time=StepTime(),
    )
    over = int(np.argmax(rows[:, 0] > 0.974)) + 1
    goal = Event(step=over, what="goal", who="home", score=(1, 0))
    record = GameRecord(
        job=GameJob("0", "h", "a", "h", "a", seed=1),
        steps=over,
        home=side,
        away=side,
        winner="home",
        events=(*events, goal),
    )
    write_film(tmp_path / "film.h5", rows[:over], b"{}")
    data = analyse_game(tmp_path / "film.h5", record)
    assert [(shot.side, shot.outcome) for shot in data.shots] == [("home", "goal")]
    assert data.shots[0].speed == pytest.approx(3.0)
    assert data.touches == (1, 0)
    assert data.possession == pytest.approx(np.mean(rows[:over, 0] < 0))
    assert np.mean(data.at_home) == pytest.approx(data.possession, abs=0.02)


def test_a_tournament_page_has_standings_cross_table_and_ratings(results: Results) -> None:
    said = words_of(report([results.tournament])[0])
    for text in (
        "6 of 6 games are played",
        "Cross table",
        "Ratings with 95 % intervals",
        "1/alpha-beta: alpha 0 : 0 beta",
    ):
        assert text in said, text
    for row in read_standings(results.tournament)[1].rows:
        assert f"{row.name} {row.points} {row.played} {row.won} {row.drawn}" in said
        assert f"{row.rating:.1f} ± {row.uncertainty:.1f}" in said


def test_one_agent_under_two_conditions_is_not_called_two_agents(results: Results) -> None:
    said = words_of(report([results.holds, results.other])[0])
    assert "The agent has the same name in all of them; what differs: disturbances and seed." in said
    assert "hold, ideal" in said and "hold, server" in said

"""Who is ranked where, with which run; and the site as files."""

import dataclasses
import os
import re
import shutil
from pathlib import Path

import msgspec
import pytest
from results import ENV, Results

from airhockey.envs.disturbances import load_disturbances
from airhockey.errors import ConfigurationError
from airhockey.evaluator.runs.manifest import Manifest
from airhockey.evaluator.runs.reader import Run
from airhockey.evaluator.runs.records import EpisodeRecord, Options
from airhockey.reporting import write_site
from airhockey.reporting.entries import boards
from airhockey.reporting.results import Task
from airhockey.reporting.site import MARK, slug

HIT, DEFEND, PREPARE = "7dof-hit", "7dof-defend", "7dof-prepare"


def task(
    agent: str, env: str, wins: int, episodes: int = 10, day: int = 1, violating: int = 0, profile: str = "ideal"
) -> Task:
    """A run of one task; `violating` episodes cost 3 points each."""
    options = Options(environments=(env,), agent=agent, episodes=episodes, disturbances=profile)
    created = f"2026-01-{day:02d}T12:00:00+00:00"
    manifest = Manifest(options=options, profile=load_disturbances(profile), versions={}, created=created)
    records = [
        EpisodeRecord(env=env, index=k, success=k < wins, steps=1, violations={"ee_constr": int(k < violating)})
        for k in range(episodes)
    ]
    return Task(Run(Path(agent), manifest, records=records), agent, env, records)


def test_the_overall_score_is_the_challenges_weighted_sum_and_the_worst_class_decides() -> None:
    tasks = [task("a", HIT, 10), task("a", DEFEND, 5), task("a", PREPARE, 0)]
    tasks += [
        task("b", HIT, 2),
        task("b", DEFEND, 2),
        task("b", PREPARE, 10, violating=2),
    ]  # 0.2 * 3 * 1000 = 600 points
    tasks += [task("c", HIT, 10)]
    (board,) = boards(tasks)
    weights = {HIT: 0.4, DEFEND: 0.4, PREPARE: 0.2}
    ranked = board.overall(weights)
    assert [(one.name, one.deployability) for one in ranked] == [("a", "Deployable"), ("b", "Improvable")]
    assert [one.score for one in ranked] == pytest.approx([0.6, 0.36])
    assert board.incomplete(weights) == [("c", [DEFEND, PREPARE])]
    assert board.incomplete({"3dof-hit": 0.5, "3dof-defend": 0.5}) == []


def test_a_better_class_comes_first_then_success_then_fewer_points() -> None:
    tasks = [
        task("perfect but dangerous", HIT, 10, violating=10),
        task("b", HIT, 7),
        task("a", HIT, 8, violating=1),
        task("c", HIT, 8),
    ]
    (board,) = boards(tasks)
    assert [name for name, _ in board.ranked(HIT)] == ["c", "a", "b", "perfect but dangerous"]
    assert [t.verdict.official_class for _, t in board.ranked(HIT)] == ["Deployable"] * 3 + ["Non-deployable"]


def test_the_largest_run_up_to_1000_episodes_counts_and_of_those_the_latest() -> None:
    early, late, huge, small = (
        task("a", HIT, 1, 1000, day=1),
        task("a", HIT, 2, 1000, day=3),
        task("a", HIT, 3, 1500, day=2),
        task("a", HIT, 4, 20, day=9),
    )
    (board,) = boards([late, small, huge, early])
    assert board.ranked(HIT)[0][1] is late
    assert [t.run.created[8:10] for t in board.results["a"][HIT]] == ["01", "02", "03", "09"]


def test_different_disturbances_are_different_boards() -> None:
    found = boards([task("a", HIT, 1), task("b", HIT, 2), task("a", HIT, 3, profile="server")])
    assert [(board.condition.disturbances, sorted(board.results)) for board in found] == [
        ("ideal", ["a", "b"]),
        ("server", ["a"]),
    ]


def test_a_run_without_a_manifest_is_an_entry_of_its_own() -> None:
    known = task("a", HIT, 1)
    lost = dataclasses.replace(known, run=Run(Path("somewhere/x"), records=list(known.records)))
    found = boards([known, lost])
    assert sorted(name for board in found for name in board.results) == ["a", "unknown (x)"]


@pytest.fixture(scope="module")
def site(results: Results, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("leaderboard")
    shutil.copytree(results.root, folder / "runs")
    (folder / "runs" / "match" / "high lights.mp4").write_bytes(b"film")
    (folder / "runs" / "broken").mkdir()
    (folder / "runs" / "broken" / "run.json").write_text("{")
    (folder / "runs" / ".hidden").mkdir()
    shutil.copytree(results.holds, folder / "runs" / ".hidden" / "run")
    pages, notes = write_site(folder / "runs", folder / "site")
    assert pages == len(list((folder / "site").rglob("*.html")))
    assert [note for note in notes if "broken" in note]
    return folder / "site"


def links_of(page: Path) -> list[str]:
    return re.findall(r'href="([^"]*)"', page.read_text())


def test_every_link_of_the_site_leads_to_a_file_of_it_and_every_page_can_be_reached(site: Path) -> None:
    reached, waiting = set(), [site / "index.html"]
    while waiting:
        page = waiting.pop()
        if page in reached:
            continue
        reached.add(page)
        for link in links_of(page) if page.suffix == ".html" else ():
            assert "://" not in link and not link.startswith("/")
            target = page if link.startswith("#") else page.parent / link
            assert target.is_file(), (page.name, link)
            waiting.append(Path(os.path.normpath(target)))
    assert reached == {path for path in site.rglob("*") if path.is_file() and path.name != MARK}
    assert any(path.suffix == ".mp4" for path in reached)


def test_the_site_shows_entries_tasks_histories_and_games(site: Path) -> None:
    index = (site / "index.html").read_text()
    assert "&lt;b&gt;swings&amp;" in index and "<b>swings" not in index
    for text in (
        "Overall, 3-DoF robot, disturbances server",
        "has not played 3dof-hit",
        "Tournament tournament",
        "hold – hold",
        "broken",
    ):
        assert text in index, text
    assert "What is missing" in index
    assert f"task-{ENV}.html" in links_of(site / "index.html")
    entry = next(link for link in links_of(site / f"task-{ENV}.html") if "hold" in link)
    history = (site / entry).read_text()
    assert "Disturbances ideal" in history and "Disturbances server" in history
    assert "../index.html" in links_of(next((site / "reports").glob("holds*.html")))


def test_a_site_is_written_again_without_what_is_gone_and_nothing_else_is_touched(
    results: Results, tmp_path: Path
) -> None:
    runs, site = tmp_path / "runs", tmp_path / "runs" / "leaderboard"
    shutil.copytree(results.holds, runs / "a")
    shutil.copytree(results.holds, runs / "b")
    write_site(runs, site)
    (site / "mine.txt").touch()
    shutil.rmtree(runs / "b")
    write_site(runs, site)
    assert sorted(path.name for path in (site / "reports").iterdir()) == ["a.html"]
    assert (site / "mine.txt").exists()


def test_a_site_is_not_written_over_something_else(results: Results, tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").touch()
    for site, said in ((tmp_path, "no leaderboard"), (tmp_path / "thesis.tex", "is a file")):
        with pytest.raises(ConfigurationError, match=said):
            write_site(results.root, site)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["thesis.tex"]
    for folder, said in ((tmp_path, "no results"), (tmp_path / "nowhere", "no folder")):
        with pytest.raises(ConfigurationError, match=said):
            write_site(folder, tmp_path / "site")
    assert not (tmp_path / "site").exists()


def test_names_become_safe_and_stay_different() -> None:
    names = ["planner", "a/b", "a_b", "<b>", "..", "../x", "", "ä", "a" * 300, "a" * 301, "con space"]
    slugs = [slug(name) for name in names]
    assert len(set(slugs)) == len(names)
    assert slugs[0] == "planner"
    assert all(re.fullmatch(r"[A-Za-z0-9_.-]{1,100}", one) and not one.startswith(".") for one in slugs)


def test_profiles_of_the_same_name_share_a_board_only_if_they_are_the_same() -> None:
    mild, wild = task("a", HIT, 1), task("b", HIT, 2)
    assert wild.run.manifest is not None
    profile = msgspec.structs.replace(wild.run.manifest.profile, delay=3)
    wild.run.manifest = msgspec.structs.replace(wild.run.manifest, profile=profile)
    assert len(boards([mild, wild])) == 2


def test_a_site_shows_nobody_where_its_results_lay(site: Path) -> None:
    for page in site.rglob("*.html"):
        assert str(site.parent) not in page.read_text(), page.name
    assert "<code>broken</code>" in (site / "index.html").read_text()


def test_short_runs_are_marked(site: Path) -> None:
    assert ">12*<" in (site / f"task-{ENV}.html").read_text()
    assert "* fewer than 1000 episodes" in (site / f"task-{ENV}.html").read_text()

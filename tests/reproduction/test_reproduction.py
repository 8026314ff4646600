"""`hockey reproduce thesis`: which runs it makes, that it goes on after a kill to the same page, and what stands there."""

from pathlib import Path

import msgspec
import pytest

from airhockey.errors import ConfigurationError
from airhockey.evaluator.engines.engine import InProcess
from airhockey.reproduction.experiments import PARTS, ReproductionOptions, experiments, quick
from airhockey.reproduction.folder import ReproductionFolder
from airhockey.reproduction.page import thesis_page

TINY = ReproductionOptions(episodes=1, games=1, steps=30, iterations=2, candidates=2, rollouts=1, seeds=1)
TRAININGS = ("figure-5.1", "figure-5.5")


def played(path, parts: tuple[str, ...] = TRAININGS, stop_after: int | None = None) -> str:
    """Plays what is missing; is interrupted after so many pieces of progress. The page."""
    new = not (path / "reproduction.json").exists()
    with ReproductionFolder.begin(TINY, path) if new else ReproductionFolder.resume(path) as folder:
        seen = 0

        def on_progress(count: int) -> None:
            nonlocal seen
            seen += count
            if stop_after is not None and seen >= stop_after:
                raise KeyboardInterrupt

        for one in experiments(TINY, parts):
            if one.key not in folder.done:
                folder.play(one, InProcess(), on_progress)
        return thesis_page(path, {str(key) for key in folder.done})


def test_every_table_and_figure_has_its_runs() -> None:
    keys = [one.key for one in experiments(quick(0))]
    assert len(keys) == len(set(keys))
    for part in PARTS:
        assert [one for one in experiments(quick(0), (part,)) if part in one.parts]
    assert len(experiments(ReproductionOptions(seeds=5), ("figure-5.4",))) == 5


def test_a_table_that_there_is_not_is_refused() -> None:
    with pytest.raises(ConfigurationError, match=r"table-5\.9.*table-5\.1"):
        experiments(TINY, ("table-5.9",))


def test_the_players_of_the_game_tables_differ_by_what_the_thesis_added() -> None:
    players = {one.key: one.options for one in experiments(TINY) if one.key in PARTS[3:7]}
    settings = [set(players[f"table-5.{k}"].settings[0]) for k in (4, 5, 6, 7)]
    assert settings[0] > settings[1] > settings[2] == settings[3]
    assert [players[f"table-5.{k}"].home for k in (4, 5, 6, 7)] == ["thesis", "thesis", "thesis", "thesis-final"]


def test_after_two_kills_the_page_is_the_same(tmp_path) -> None:
    whole = played(tmp_path / "whole")
    for stop in (3, 6):
        with pytest.raises(KeyboardInterrupt):
            played(tmp_path / "killed", stop_after=stop)
    assert played(tmp_path / "killed") == whole
    for printed in ("Figure 5.1", "Figure 5.4", "log σ of hit.theta.3"):
        assert printed in whole
    assert "Figure 5.2" not in whole  # its trainings were not asked for


def test_a_table_stands_beside_what_is_printed(tmp_path) -> None:
    page = played(tmp_path / "run", ("table-5.1",))
    for printed in ("85.0%", "4402", "text alone", "tuned", "not run yet"):
        assert printed in page


def test_other_options_are_another_reproduction(tmp_path) -> None:
    ReproductionFolder.begin(TINY, tmp_path / "run").close()
    with pytest.raises(ConfigurationError, match="seed"):
        ReproductionFolder.resume(tmp_path / "run", {"seed": 3})
    with pytest.raises(ConfigurationError, match="episodes must be positive"):
        ReproductionFolder.begin(msgspec.structs.replace(TINY, episodes=0), tmp_path / "other")


@pytest.mark.long
def test_everything_quick_by_the_command(hockey) -> None:
    status, out, _ = hockey("reproduce thesis --quick --jobs 2 --out run")
    assert status == 0
    assert out.strip() == "run/thesis.html"
    page = Path("run/thesis.html").read_text(encoding="utf-8")
    for k in range(1, 6):
        assert f"Figure 5.{k}" in page

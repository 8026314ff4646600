"""Results as tables in notebooks."""

from html.parser import HTMLParser

from airhockey.evaluator.judging.standings import Row, Standings
from airhockey.evaluator.match import MatchResult
from airhockey.evaluator.runs.notebook import table
from airhockey.evaluator.runs.records import RunResult, RunTime, TaskResult

TASK = TaskResult(
    env="7dof-hit",
    agent="<script>alert(1)</script>",
    episodes=10,
    seed=3,
    disturbances="ideal",
    success=0.5,
    penalty=1.0,
    deployability="Deployable",
    violations={},
    computation_time=RunTime(mean=1e-4, p99=1e-4, max=1e-4),
    agent_errors=0,
)


class Tags(HTMLParser):
    def __init__(self, page: str) -> None:
        super().__init__()
        self.opened: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.opened.append(tag)


def test_a_table_is_what_it_is_given_and_no_more() -> None:
    page = table("a < b", ("x", "y"), [("<b>", 1), ("two", "&")])
    assert Tags(page).opened == ["table", "caption", "thead", "tr", "th", "th", "tbody", *("tr", "th", "td") * 2]
    assert "a &lt; b" in page and "&lt;b&gt;" in page


def test_results_have_a_row_for_every_task() -> None:
    assert Tags(TASK._repr_html_()).opened.count("tr") == 2
    assert "50.0%" in TASK._repr_html_() and "<script>" not in TASK._repr_html_()
    whole = RunResult(results=(TASK, TASK), deployability="Deployable", phase="phase-2", score=0.5)
    assert Tags(whole._repr_html_()).opened.count("tr") == 3
    assert "phase-2 score 0.500" in whole._repr_html_()


def test_matches_and_standings_do_too() -> None:
    match = MatchResult(home="a", away="b", disturbances="ideal", games=(), wins=0, draws=0, losses=0)
    assert "a – b: 0 won" in match._repr_html_()
    counted = set(Row.__struct_fields__) - {"rank", "name", "penalty", "rating", "uncertainty"}
    row = Row(rank=1, name="<i>", penalty=0.5, rating=25.0, uncertainty=8.0, **dict.fromkeys(counted, 2))
    page = Standings(rows=(row,), played=1, games=2)._repr_html_()
    assert "&lt;i&gt;" in page and "25.0 ± 8.0" in page

"""Sweeps: several agents, disturbances and seeds as one run that goes on, and which of them differ."""

import contextlib
import json
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest
from command_line import Hockey

from airhockey.errors import ConfigurationError
from airhockey.evaluator import Options, begin, evaluate
from airhockey.evaluator.judging.statistics import compare_pairs, holm
from airhockey.evaluator.runs.journal import read_journal
from airhockey.evaluator.runs.reader import open_source, parts_of
from airhockey.evaluator.runs.records import EpisodeRecord
from airhockey.evaluator.sweep import SweepFolder, SweepOptions, begin_sweep, resume_sweep, sweep, sweep_result
from submissions import make_submission

ENV = "3dof-defend"
BASE = Options(environments=(ENV,), agent="hold", episodes=3, seed=5)


@pytest.fixture(scope="module")
def waver(tmp_path_factory: pytest.TempPathFactory) -> str:
    """An agent that moves to and fro."""
    body = "action[0] += 0.6 * np.sin(0.1 * self.steps)"
    made = make_submission(tmp_path_factory.mktemp("agents"), body, config="interpolation_order: 3\n")
    return str(Path(made).rename(Path(made).with_name("waver")))


def options(agents: tuple[str, ...], seeds: int = 2) -> SweepOptions:
    profiles = ("ideal", "server")
    return SweepOptions(
        agents=agents,
        profiles=profiles,
        seeds=seeds,
        runs=tuple(
            msgspec.structs.replace(BASE, agent=agent, disturbances=profile, seed=5 + k)
            for agent in agents
            for profile in profiles
            for k in range(seeds)
        ),
    )


@contextlib.contextmanager
def silent(head: str, run: object) -> Iterator[None]:
    yield None


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory, waver: str) -> Path:
    path = tmp_path_factory.mktemp("sweeps") / "sweep"
    sweep(begin_sweep(options(("hold", waver)), path), silent)
    return path


def won(run: Path) -> list[bool]:
    records = read_journal(run, EpisodeRecord).records
    return [record.success for record in sorted(records, key=lambda record: record.index)]


def test_every_cell_is_what_its_runs_are_alone(finished: Path, tmp_path: Path, waver: str) -> None:
    result = sweep_result(finished)
    assert [(cell.agent, cell.disturbances, cell.episodes) for cell in result.cells] == [
        (agent, profile, 6) for agent in ("hold", waver) for profile in ("ideal", "server")
    ]
    evaluate(begin(msgspec.structs.replace(BASE, disturbances="server", seed=6), tmp_path / "alone"))
    assert won(tmp_path / "alone") == won(finished / "hold-server-s6")
    shares = [sum(won(finished / f"hold-server-s{seed}")) / 3 for seed in (5, 6)]
    assert result.cells[1].success == pytest.approx(sum(shares) / 2)
    assert result.cells[1].spread == pytest.approx(abs(shares[0] - shares[1]) / 2**0.5)


def test_agents_are_compared_episode_by_episode(finished: Path) -> None:
    result = sweep_result(finished)
    for one in result.comparisons:
        pairs = [
            pair
            for seed in (5, 6)
            for pair in zip(
                won(finished / f"hold-{one.disturbances}-s{seed}"),
                won(finished / f"waver-{one.disturbances}-s{seed}"),
                strict=True,
            )
        ]
        counts = [pairs.count(both) for both in ((True, True), (True, False), (False, True), (False, False))]
        expected = compare_pairs(*counts)
        assert (one.difference, one.low, one.high, one.p_value) == expected
        assert [one.only_first, one.only_second] == counts[1:3]
    assert [one.adjusted for one in result.comparisons] == holm([one.p_value for one in result.comparisons])


def test_what_was_interrupted_goes_on_with_the_same_result(finished: Path, tmp_path: Path, waver: str) -> None:
    class Stopped(Exception):
        pass

    @contextlib.contextmanager
    def stopping(head: str, run: object) -> Iterator[object]:
        def on_episode(record: EpisodeRecord) -> None:
            if head.startswith("hold-server-s5") and record.index == 1:
                raise Stopped

        yield on_episode

    path = tmp_path / "sweep"
    with pytest.raises(Stopped):
        sweep(begin_sweep(options(("hold", waver)), path), stopping)
    assert [part.name for part in parts_of(path)] == ["hold-ideal-s5", "hold-ideal-s6", "hold-server-s5"]
    folder = resume_sweep(path, {"agents": ("hold", waver), "episodes": 3})
    assert len(folder.records) == 2
    sweep(folder, silent)
    for part in parts_of(finished):
        assert won(path / part.name) == won(part)
    assert sweep_result(path).comparisons == sweep_result(finished).comparisons


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"agents": ("hold",)}, "has agents"),
        ({"seeds": 3}, "has seeds 2, not 3"),
        ({"episodes": 4}, "has episodes 3, not 4"),
    ],
)
def test_another_sweep_is_not_taken_up(finished: Path, asked: dict[str, object], said: str) -> None:
    with pytest.raises(ConfigurationError, match=said):
        resume_sweep(finished, asked)


def test_what_makes_no_sense_is_said_before_anything_is_written(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="'hold' is given twice"):
        begin_sweep(options(("hold", "hold")), tmp_path / "sweep")
    with pytest.raises(ConfigurationError, match="unknown agent"):
        begin_sweep(options(("hold", "nobody")), tmp_path / "sweep")
    assert not (tmp_path / "sweep").exists()


def test_names_of_runs_do_not_clash() -> None:
    both = options(("/one/agent", "/other/agent"), 1)
    assert both.names == ["agent-ideal-s5", "agent-server-s5", "agent-ideal-s5-2", "agent-server-s5-2"]


def test_the_command_plays_compares_and_goes_on(hockey: Hockey, waver: str) -> None:
    line = (
        f"evaluate --env {ENV} --agent hold --agent {waver} --isolate none --seeds 2 --episodes 2 --jobs 1 --out sweep"
    )
    status, out, err = hockey(line)
    assert status == 0
    assert "hold – waver" in out and "p (Holm)" in out and "hockey report sweep" in out
    assert "waver-ideal-s1 (4 of 4)" in err
    status, out, _ = hockey("evaluate --resume --out sweep --json --quiet")
    assert status == 0
    printed = json.loads(out)
    assert printed == json.loads(Path("sweep/result.json").read_text())
    assert [cell["episodes"] for cell in printed["cells"]] == [4, 4]
    assert hockey("report sweep --quiet")[0] == 0
    page = Path("report.html").read_text()
    assert "hold-ideal-s0" in page and "waver-ideal-s1" in page
    status, _, err = hockey("failures sweep")
    assert status == 2 and "name one of its runs (hold-ideal-s0" in err
    status, _, err = hockey(line.replace("--seeds 2", "--seeds 3") + " --resume")
    assert status == 2 and "has seeds 2, not 3" in err


def test_a_sweep_has_no_official_files(hockey: Hockey) -> None:
    status, _, err = hockey(f"evaluate --env {ENV} --agent hold --seeds 2 --official-dataset")
    assert status == 2 and "--official-dataset is of one run" in err


def test_it_shows_in_notebooks(finished: Path) -> None:
    page = sweep_result(finished)._repr_html_()
    assert page.count("<tr>") == 1 + 4 + 1 + 2
    assert "p (Holm)" in page


def test_an_edited_sweep_is_known(finished: Path, tmp_path: Path) -> None:
    begin_sweep(options(("hold",)), tmp_path / "sweep").close()
    file = tmp_path / "sweep" / SweepFolder.name
    file.write_text(file.read_text().replace('"episodes": 3', '"episodes": 4', 1))
    with pytest.raises(ConfigurationError, match="was edited"):
        resume_sweep(tmp_path / "sweep", {})
    assert "it is a sweep" in open_source(finished).notes[0]

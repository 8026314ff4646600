"""`--edition`, as a user meets it: in every command that plays, in what it stores, and in what reads that."""

import json
import re
from pathlib import Path
from typing import Any

import click
import pytest
from command_line import Hockey
from outcomes import outcome

from airhockey.commands.watch import watch
from airhockey.envs import editions
from airhockey.evaluator import Options, evaluation
from airhockey.evaluator.engines.processes import Processes
from airhockey.viewing.library import open_library
from airhockey.viewing.live import LiveTask
from airhockey.viewing.playback import RecordedPlayback
from submissions import make_submission

PLAYED = "--agent hold --episodes 2 --jobs 1 --quiet"
MADE_FOR_2025 = "assert env_info['env_name'] == 'hit', env_info['env_name']"


def manifest(name: str) -> Any:
    return json.loads(Path(name).read_text())["options"]


def test_the_choices_are_the_editions() -> None:
    option = next(parameter for parameter in watch.params if parameter.name == "edition")
    assert isinstance(option.type, click.Choice) and tuple(option.type.choices) == editions.available()


def test_all_tasks_of_an_edition(hockey: Hockey) -> None:
    status, out, err = hockey(f"evaluate --edition 2025 {PLAYED}")
    assert (status, err) == (0, "")
    assert "edition 2025, disturbances ideal" in out and "qualifying score 0" in out
    assert "stored in runs/7dof-all-hold-2025-s0" in out
    options = manifest("runs/7dof-all-hold-2025-s0/run.json")
    assert (options["environments"], options["edition"]) == (["hit", "defend", "prepare"], "2025")
    lines = Path("runs/7dof-all-hold-2025-s0/journal.jsonl").read_text().splitlines()
    assert {json.loads(line)["edition"] for line in lines} == {"2025"}


def text_of(page: Path) -> str:
    """What a page says, without its markup."""
    return " ".join(re.sub(r"<[^>]*>", " ", page.read_text()).split())


@pytest.mark.parametrize(
    ("typed", "env", "edition"),
    [
        ("--env hit_single", "hit_single", "2025"),
        ("--env prepare", "prepare", "2025"),
        ("--env 7dof-defend", "7dof-defend", "2023"),
        ("--env 7dof-defend --edition 2025", "defend", "2025"),
        ("--env defend --edition 2023", "7dof-defend", "2023"),
        ("--task defend --edition 2025", "defend", "2025"),
        ("--task defend --edition 2023", "7dof-defend", "2023"),
    ],
)
def test_official_names_and_ours_are_both_understood(hockey: Hockey, typed: str, env: str, edition: str) -> None:
    _, out, _ = hockey(f"evaluate {typed} {PLAYED} --json --out run")
    result = json.loads(out)
    assert (result["env"], result["edition"], result["episodes"]) == (env, edition, 2)


@pytest.mark.parametrize(
    ("typed", "named"),
    [
        ("--robot 3dof --edition 2025", "robot of edition 2025 '3dof'"),
        ("--env 3dof-hit --edition 2025", "environment of edition 2025 '3dof-hit'"),
        ("--env hit_single --edition 2023", "environment of edition 2023 'hit_single'"),
        ("--edition 2024", "2024"),
    ],
)
def test_what_an_edition_has_not_is_said(hockey: Hockey, typed: str, named: str) -> None:
    status, _, err = hockey(f"evaluate {typed} {PLAYED} --out run")
    assert status == 2 and named in err and not Path("run").exists()


def test_a_run_goes_on_under_its_own_edition(hockey: Hockey) -> None:
    hockey(f"evaluate --env hit {PLAYED} --out run")
    status, _, err = hockey("evaluate --resume --out run --edition 2023")
    assert status == 2 and "has edition '2025', not '2023'" in err
    assert hockey("evaluate --resume --out run --edition 2025 --quiet")[0] == 0
    assert hockey("evaluate --resume --out run --quiet")[0] == 0
    hockey("match hold hold --edition 2025 --steps 20 --jobs 1 --quiet --out games")
    status, _, err = hockey("match --resume --out games --edition 2023")
    assert status == 2 and "has edition '2025', not '2023'" in err


@pytest.mark.long
def test_workers_and_dask_play_it_as_this_process_does(hockey: Hockey, tmp_path: Path) -> None:
    options = Options(environments=("7dof-defend",), edition="2025", agent="thesis", episodes=6, seed=5)
    assert options.environments == ("defend",)
    here = tmp_path / "one"
    evaluation.evaluate(evaluation.begin(options, here))
    there = tmp_path / "two"
    evaluation.evaluate(evaluation.begin(options, there), Processes(2))
    assert outcome(here, "defend") == outcome(there, "defend")
    run = "evaluate --env defend --agent thesis --episodes 6 --seed 5 --json --quiet"
    result = json.loads(hockey(f"{run} --cluster local:1")[1])
    mine = json.loads((here / "result.json").read_text())
    of_the_clock = {"computation_time", "preparation_time", "penalty"}
    assert {key for key in result if result[key] != mine[key]} <= of_the_clock


@pytest.mark.long
def test_the_puck_comes_as_the_edition_says(tmp_path: Path) -> None:
    """Up to 5 m/s in 2025, up to 3 m/s in 2023."""
    fastest = {}
    for year in editions.available():
        options = Options(environments=("7dof-defend",), edition=year, agent="hold", episodes=12)
        episodes = [evaluation.play_episode(options, options.environments[0], k) for k in range(12)]
        fastest[year] = max(float(abs(episode.trajectory["observations"][0, 3])) for episode in episodes)
    assert fastest["2023"] < 3.0 < fastest["2025"] < 5.0


@pytest.mark.long
def test_games_of_an_edition(hockey: Hockey) -> None:
    status, out, _ = hockey("match hold hold --edition 2025 --steps 60 --jobs 1 --quiet --json --out match")
    assert status == 0 and json.loads(out)["edition"] == "2025"
    assert json.loads(Path("match/journal.jsonl").read_text())["edition"] == "2025"
    assert manifest("match/match.json")["game"]["edition"] == "2025"
    _, out, _ = hockey("match hold hold --edition 2025 --steps 60 --jobs 1 --quiet --out again")
    assert "60 steps, edition 2025, disturbances ideal" in out
    status, out, _ = hockey("tournament a=hold b=hold --edition 2025 --steps 60 --jobs 1 --quiet --out all")
    assert status == 0 and "standings after 2 of 2 games, edition 2025" in out
    assert json.loads(Path("all/standings.json").read_text())["edition"] == "2025"
    assert "edition 2025" in hockey("tournament --show --out all")[1]


def test_a_submission_brings_its_edition(hockey: Hockey, tmp_path: Path) -> None:
    old = make_submission(tmp_path, building="assert env_info['env_name'] in ('7dof-hit', 'tournament')")
    new = make_submission(tmp_path, building=MADE_FOR_2025, config="env: [hit, defend]\n")
    coded = make_submission(tmp_path, building="if env_info['env_name'] == 'hit': pass")
    short = "--episodes 1 --jobs 1 --quiet --isolate none --json"
    for agent, env in ((old, "7dof-hit"), (new, "hit"), (coded, "hit")):
        status, out, err = hockey(f"evaluate --task hit --agent {agent} {short}")
        assert status == 0 and json.loads(out)["env"] == env
        assert ("was made for the edition of 2025" in err) == (env == "hit")
    assert json.loads(hockey(f"evaluate --task hit --agent {coded} --edition 2023 {short}")[1])["env"] == "7dof-hit"
    status, _, err = hockey(f"match {old} {coded} --steps 20 --isolate none")
    assert status == 2 and "submissions of several editions" in err and "--edition" in err
    match = f"match {old} {coded} --steps 20 --isolate none --jobs 1 --quiet --json --edition 2025"
    assert json.loads(hockey(match)[1])["edition"] == "2025"


def test_validation_is_under_the_rules_that_a_submission_was_made_for(hockey: Hockey, tmp_path: Path) -> None:
    agent = make_submission(tmp_path, building=MADE_FOR_2025, config="env: [hit]\ninterpolation_order: 3\n")
    status, out, _ = hockey(f"validate {agent} --isolate process --steps 5")
    assert status == 0, out
    assert "plays hit: fit to be handed in" in out and "under the rules of 2025" in out
    status, out, _ = hockey(f"validate {agent} --isolate process --steps 5 --edition 2023 --json")
    assert status == 3 and json.loads(out)["edition"] == "2023" and "7dof-hit" in json.loads(out)["problems"][0]["what"]


def test_one_watches_it_too(hockey: Hockey, monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[LiveTask] = []
    monkeypatch.setattr("airhockey.commands._viewer.show_in_viewer", lambda live, given: shown.append(live))
    for line in ("hold --env hit_single", "hold --task prepare --edition 2025", "hold hold --edition 2025 --steps 9"):
        assert hockey(f"watch {line}")[0] == 0
    names = [getattr(live, "_name", "game") for live in shown]
    assert names == ["hit_single", "prepare", "game"]
    for live in shown:
        assert "target" in {live.scene_view.model.geom(k).name for k in range(live.scene_view.model.ngeom)}
        while live.advance():
            pass
        assert live.caption().seconds > 0.0
        live.close()


@pytest.mark.long
def test_what_reads_runs_keeps_editions_apart(hockey: Hockey) -> None:
    hockey(f"evaluate --task all {PLAYED} --out runs/old")
    hockey(f"evaluate --task all --edition 2025 {PLAYED} --out runs/new")
    assert hockey("report runs/old runs/new -o both.html --quiet")[0] == 0
    page = text_of(Path("both.html"))
    assert "qualifying score 0.000 (0.4 hit + 0.4 defend + 0.2 prepare)" in page and "phase-2 score 0." in page
    hockey("match hold hold --edition 2025 --steps 9 --jobs 1 --quiet --out runs/match")
    assert hockey("leaderboard runs -o site --quiet")[0] == 0
    assert "ideal, edition 2025" in text_of(Path("site/games.html"))
    index = text_of(Path("site/index.html"))
    assert "ideal, edition 2025" in index and "qualifying" in index
    assert Path("site/task-hit.html").exists() and Path("site/task-7dof-hit.html").exists()


@pytest.mark.long
def test_what_shows_runs_shows_the_scene_of_their_edition(hockey: Hockey) -> None:
    short = "--agent hold --episodes 1 --jobs 1 --quiet"
    hockey(f"evaluate --env hit_single {short} --official-dataset --out run")
    hockey("match hold hold --edition 2025 --steps 9 --jobs 1 --quiet --out games")
    hockey(f"evaluate --env 7dof-defend {short} --out old")
    for place, env, edition in (
        ("run", "hit_single", "2025"),
        ("run/official", "hit_single", "2025"),
        ("games", "tournament", "2025"),
        ("old", "7dof-defend", "2023"),
    ):
        playback = RecordedPlayback(open_library(Path(place)).entries)
        recording = open_library(Path(place)).entries[0].load()
        assert (recording.env, recording.edition) == (env, edition)
        model = playback.scene_view.model
        assert ("target" in {model.geom(k).name for k in range(model.ngeom)}) == (edition == "2025")
        playback.seek(playback.steps)
        assert playback.caption().seconds > 0.0

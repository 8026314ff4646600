"""The report, the replay and the highlights of a game that was recorded speak of the same saves."""

import re
from pathlib import Path

import numpy as np
from courses import Course
from games import JOB, side

from airhockey.envs.disturbances import load_disturbances
from airhockey.evaluator.match import MatchFolder, MatchOptions
from airhockey.evaluator.play.game import Game
from airhockey.evaluator.runs.game_records import GameOptions, GameRecord
from airhockey.evaluator.runs.manifest import Manifest
from airhockey.reporting import report
from airhockey.viewing.highlights import highlight_spans, worth_seeing
from airhockey.viewing.library import open_library


def recorded_game(path: Path) -> None:
    """Home shoots seven times: three shots away saves, one goes past the goal, two would have stopped short, one is a goal."""
    course = Course().slide(5)
    for speed, y_speed, parried_at in (
        (2, 0, 0.8),
        (2, 0, 0.7),
        (2, 0.5, 0.6),
        (0.6, 0, 0.3),
        (3, 0, 0.8),
        (0.6, 0, 0.2),
    ):
        course.hit("home", speed, y_speed).slide_to(parried_at).hit("away", -1.0, 0.3).slide_to(-0.4)
        course.y, course.velocity = 0.0, np.zeros(2)  # home stops it
        course.slide(200)
    course.hit("home", 3.0, 0.0).slide_to(0.974).slide(1).score("home")
    record = GameRecord(
        job=JOB, steps=len(course.rows), home=side(1), away=side(), winner="home", events=tuple(course.events)
    )
    options = MatchOptions(home="h", away="a", game=GameOptions(steps=record.steps))
    manifest = Manifest(options=options, profile=load_disturbances("ideal"), versions={}, created="")
    with MatchFolder.create(path, manifest) as folder:
        folder.add(Game(record, np.array(course.rows, dtype=np.float32)))


def test_report_replay_and_highlights_count_the_same_saves(tmp_path: Path) -> None:
    recorded_game(tmp_path / "match")
    page, notes = report([tmp_path / "match"])
    assert notes == []
    text = re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", page))
    home = re.search(r"puck on its side h (\d+) (\d+) (\d+) (\d+) (\d+) ", text)
    assert home is not None
    assert home.groups()[1:] == ("7", "4", "1", "3"), "shots, on target, goals, saved"
    recording = open_library(tmp_path / "match").entries[0].load()
    saves = [moment for moment in recording.moments if moment.what == "save"]
    assert [moment.who for moment in saves] == [1, 1, 1]
    seen = [moment for moment in worth_seeing(recording.moments) if moment.what == "save"]
    assert sorted(moment.step for moment in seen) == [moment.step for moment in saves]
    spans = highlight_spans(saves, recording.steps)
    assert len(spans) == 3 and all(begin < moment.step < end for moment, (begin, end) in zip(saves, spans, strict=True))

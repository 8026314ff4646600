"""Which parts of a recording are shown, and what was found worth seeing."""

import numpy as np
from games import JOB, side

from airhockey.evaluator.runs.game_records import Event, GameRecord
from airhockey.viewing.games import WIDTH, game_recording
from airhockey.viewing.highlights import frame_steps, highlight_spans
from airhockey.viewing.recording import Moment


def moments(*steps: int, what: str = "goal") -> list[Moment]:
    return [Moment(step, what) for step in steps]


def test_two_seconds_before_and_one_after() -> None:
    assert highlight_spans(moments(500), 1000) == [(400, 550)]


def test_spans_stay_inside_and_those_that_touch_become_one() -> None:
    assert highlight_spans(moments(30, 170, 500, 990), 1000, first=1) == [(1, 220), (400, 550), (890, 1000)]


def test_serves_and_held_commands_are_no_highlights() -> None:
    assert highlight_spans(moments(100, what="serve") + moments(200, what="held"), 1000) == []


def test_of_many_saves_the_hardest_are_shown() -> None:
    easy = [Moment(10_000 * k, "save", 0, speed=1.0) for k in range(1, 21)]
    hard = [Moment(10_000 * k + 5000, "save", 1, speed=2.0) for k in range(1, 13)]
    assert [end - 50 for _, end in highlight_spans(easy + hard, 10**6)] == [moment.step for moment in hard]


def test_every_frame_shows_its_own_time() -> None:
    steps = frame_steps([(0, 50), (200, 210)], fps=25, speed=1.0)
    assert steps == [*range(2, 51, 2), *range(202, 211, 2)]
    assert frame_steps([(0, 50)], fps=25, speed=5.0) == [10, 20, 30, 40, 50]


def test_captions_count_what_the_referee_noted() -> None:
    why = "ee_constr: 3 points for this episode, up to 0.01 beyond"
    events = (
        Event(step=0, what="serve", who="home", score=(0, 0)),
        Event(step=10, what="violation", who="away", why=why, points=3.0),
        Event(step=20, what="goal", who="home", score=(1, 0)),
        Event(step=20, what="serve", who="away", score=(1, 0)),
        Event(step=200, what="fault", who="home", score=(1, 0)),
    )
    record = GameRecord(job=JOB, steps=300, home=side(1), away=side(), winner="home", events=events)
    film = np.zeros((300, 2 * WIDTH))
    recording = game_recording("0", film, record)

    def told(step: int) -> tuple[object, ...]:
        caption = recording.narrator.caption(step)
        return caption.score, caption.faults, caption.penalty, caption.news, caption.alarm

    assert told(9)[:3] == ((0, 0), (0, 0), (0, 0))
    assert told(10) == ((0, 0), (0, 0), (0, 3.0), "the puck is with h", "a violates ee_constr")
    assert told(20) == ((1, 0), (0, 0), (0, 3.0), "goal for h", "a violates ee_constr")
    assert told(199) == ((1, 0), (0, 0), (0, 3.0), "", "")
    assert told(300) == ((1, 0), (1, 0), (0, 3.0), "fault of h", "")

"""The rules of a game (challenge, section 6) on the real simulation, from constructed states."""

import numpy as np
import pytest
from games import Clock, Stander, new_game, placed, run, seated, told

from airhockey.evaluator.isolation.handle import LocalAgent
from airhockey.evaluator.play.game import GamePlay


@pytest.fixture
def game() -> GamePlay:
    game = new_game()
    game.begin()
    return game


def score_and_faults(game: GamePlay) -> tuple[list[int], list[int]]:
    return game.env.score, game.env.faults


def next_server(game: GamePlay) -> str:
    return "home" if game.env.base_observation[0] < 0.0 else "away"


def serve(game: GamePlay, side: str) -> None:
    """Let the next serve be this side's, as the referee remembers it."""
    game.env.game.serve[0] = 1 if side == "home" else -1


@pytest.mark.parametrize(
    ("puck", "scorer", "score"),
    [
        ((0.93, 0.085, 0.0, 3.0, 0.0, 0.0), "home", [1, 0]),
        ((-0.93, 0.085, 0.0, -3.0, 0.0, 0.0), "away", [0, 1]),
    ],
    ids=["home scores", "away scores"],
)
def test_a_goal_is_a_point_and_the_side_that_conceded_serves(
    game: GamePlay, puck: tuple[float, ...], scorer: str, score: list[int]
) -> None:
    conceder = "away" if scorer == "home" else "home"
    serve(game, scorer)
    step = run(game, placed(game, *puck), 20)
    assert told(game)[1:] == [("goal", scorer), ("serve", conceder)]
    assert score_and_faults(game) == (score, [0, 0])
    assert next_server(game) == conceder
    assert [seat.agent.agent.serves for seat in game.seats] == [2, 2]  # both hear of it
    goal, serving = game.events[1:]
    assert goal.step == serving.step == step
    assert goal.score == tuple(score)
    assert "the puck was at" in (goal.why or "")


def test_an_own_goal_is_a_point_for_the_opponent(game: GamePlay) -> None:
    """Home's own mallet pushes a puck that lies behind it over the line."""
    serve(game, "away")
    run(game, placed(game, -0.93, 0.0, 0.0, 0.0, 0.0, 0.0), 40)
    assert told(game)[1:] == [("goal", "away"), ("serve", "home")]
    assert score_and_faults(game) == ([0, 1], [0, 0])


@pytest.mark.parametrize(("x", "guilty", "server"), [(-0.5, "home", "away"), (0.5, "away", "home")])
def test_a_puck_left_alone_faults_on_the_752nd_step_and_the_other_side_serves(
    game: GamePlay, x: float, guilty: str, server: str
) -> None:
    serve(game, guilty)
    assert run(game, placed(game, x, 0.2, 0.0, 0.0, 0.0, 0.0), 800) == 752
    assert told(game)[1:] == [("fault", guilty), ("serve", server)]
    assert score_and_faults(game)[0] == [0, 0]
    assert next_server(game) == server
    assert "15.02 s" in (game.events[1].why or "")


def hurry(game: GamePlay, x: float, first: int) -> int:
    """A fault of the side that holds a puck at x, its 15 s already gone; gives the step after."""
    observation = placed(game, x, 0.2, 0.0, 0.0, 0.0, 0.0)
    assert run(game, observation, 1, first) == first  # the serve forgot the side; now it is known
    game.env.game.timer[0] = 15.0
    return run(game, observation, 1, first + 1) + 1


def test_every_third_fault_is_a_point_for_the_opponent(game: GamePlay) -> None:
    step = 1
    for k in range(1, 7):
        step = hurry(game, -0.5, step)
        assert score_and_faults(game) == ([0, k // 3], [k, 0])
    assert told(game, "fault", "point") == 2 * ([("fault", "home")] * 3 + [("point", "away")])
    point = next(event for event in game.events if event.what == "point")
    assert point.why == "fault 3 of home, and every 3 give a point"
    assert point.score == (0, 1)


def test_faults_of_both_are_counted_apart(game: GamePlay) -> None:
    step = 1
    for x in (-0.5, 0.5, -0.5, 0.5):
        step = hurry(game, x, step)
    assert score_and_faults(game) == ([0, 0], [2, 2])
    assert told(game, "point") == []


def test_the_timer_restarts_when_the_puck_changes_sides(game: GamePlay) -> None:
    observation = placed(game, -0.02, 0.3, 0.0, 1.0, 0.0, 0.0)
    run(game, observation, 1)
    game.env.game.timer[0] = 14.99
    assert run(game, observation, 20, 2) == 21
    assert told(game)[1:] == []
    assert game.env.game.timer[0] < 0.5


@pytest.mark.parametrize("server", ["home", "away"])
def test_a_puck_stuck_in_the_middle_is_served_again_by_the_same_side(game: GamePlay, server: str) -> None:
    serve(game, server)
    assert run(game, placed(game, 0.1, 0.2, 0.0, 0.0, 0.3, 0.0), 5) == 1  # it moves, but not along x
    assert told(game)[1:] == [("stuck", None), ("serve", server)]
    assert score_and_faults(game) == ([0, 0], [0, 0])
    assert next_server(game) == server


def test_a_slow_puck_in_the_middle_is_no_fault_however_long_it_takes(game: GamePlay) -> None:
    observation = placed(game, -0.1, 0.2, 0.0, 0.1, 0.0, 0.0)
    run(game, observation, 1)
    game.env.game.timer[0] = 20.0
    assert run(game, observation, 10, 2) == 11
    assert told(game)[1:] == []


def test_a_puck_that_leaves_the_table_is_served_again_without_a_point(game: GamePlay) -> None:
    serve(game, "away")
    run(game, placed(game, 0.3, 0.53, 0.0, 0.0, 0.0, 0.0), 1)
    assert told(game)[1:] == [("out", None), ("serve", "away")]
    assert score_and_faults(game) == ([0, 0], [0, 0])


def sent(game: GamePlay) -> list[np.ndarray]:
    """Home's actions as the environment gets them, from now on."""
    actions: list[np.ndarray] = []
    step = game.env.step

    def spy(pair: tuple[np.ndarray, np.ndarray]) -> object:
        actions.append(np.array(pair[0]))
        return step(pair)

    game.env.step = spy
    return actions


@pytest.mark.parametrize("order", [1, 3, 5, None])
def test_an_agent_over_its_20_ms_has_its_previous_position_held_with_zero_velocity(
    monkeypatch: pytest.MonkeyPatch, order: int | None
) -> None:
    clock, durations = Clock(), iter([0.0199, 0.01999, 0.02001, 0.3, 0.001])
    game = new_game(monkeypatch, clock, (order, 3))
    shape = game.env.formats[0].shape

    class Mover(Stander):
        """Wants to be somewhere else at every step, and thinks for as long as it was told to."""

        def draw_action(self, observation: np.ndarray) -> np.ndarray:
            clock.time += next(durations)
            action = np.tile(np.array(game.env.simulation.robot.start), (*shape[:-1], 1)).reshape(shape)
            return action + 1e-4 * self._count()

        def _count(self) -> int:
            self.count = getattr(self, "count", 0) + 1
            return self.count

    game.seats[0].agent = LocalAgent(Mover(game.env, 0, order))
    actions = sent(game)
    game.begin()
    for _ in range(5):
        game.step()
    wanted = [np.tile(game.env.simulation.robot.start, (*shape[:-1], 1)).reshape(shape) + 1e-4 * k for k in range(1, 6)]
    held = np.zeros(shape)
    if order is None:
        held[:, 0] = wanted[1][-1, 0]
    elif order == 1:
        held[:] = wanted[1]
    else:
        held[0] = wanted[1][0]
    for action, expected in zip(actions, [wanted[0], wanted[1], held, held, wanted[4]], strict=True):
        assert action.tolist() == expected.tolist()
    assert [(event.step, event.who) for event in game.events if event.what == "held"] == [(3, "home"), (4, "home")]
    assert game.end().home.held == 2
    assert game.end().away.held == 0


def test_an_agent_that_is_late_at_once_stays_where_the_serve_found_it(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = Clock()
    game = new_game(monkeypatch, clock)

    def think() -> None:
        clock.time += 1.0

    game.seats[0].agent = LocalAgent(Stander(game.env, 0, think=think))
    actions = sent(game)
    game.begin()
    game.step()
    assert actions[0].tolist() == [list(game.env.simulation.robot.start), [0.0] * 7]


def test_preprocessors_are_applied_as_in_the_official_core(game: GamePlay) -> None:
    class Preprocessing(Stander):
        preprocessors = [lambda observation: observation * 0.0]  # noqa: RUF012

    env = game.env
    game = seated(game.options, env, Preprocessing(env, 0), Stander(env, 1))
    actions = sent(game)
    game.begin()
    game.step()
    assert not actions[0].any()

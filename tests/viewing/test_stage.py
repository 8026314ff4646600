"""The stage shows what the simulation had; live shows are the evaluator's episodes and games."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from arms import swinging

from airhockey import envs
from airhockey.evaluator import Options
from airhockey.evaluator.runs import trajectories
from airhockey.evaluator.runs.game_records import GameOptions
from airhockey.evaluator.runs.game_trajectories import read_film
from airhockey.viewing.caption import Caption
from airhockey.viewing.live import LiveGame, LiveTask, mallet_target
from airhockey.viewing.marks import Mark
from airhockey.viewing.playback import RecordedShow, predicted_path
from airhockey.viewing.playback_controls import PAUSE_AT_END, Transport
from airhockey.viewing.scene_view import Stage


@pytest.mark.parametrize("name", ["3dof-hit", "7dof-prepare", "tournament"])
def test_everything_stands_where_the_simulation_had_it(name: str) -> None:
    env, stage = envs.make(name), Stage(name)
    env.reset(seed=1)
    for action in swinging(env, 25):
        env.step(action)
    base = env.base_observation.reshape(env.n_agents, -1)
    n = stage.n_joints
    stage.show(base[0, :3], base[:, 6 : 6 + n])
    truth = env.simulation.data
    for geom in ["puck", *(f"{stage.robot.prefix}_{k}/ee" for k in range(1, env.n_agents + 1))]:
        # The simulated mallet lags behind the angle that levels it, by millimetres.
        assert stage.data.geom(geom).xpos == pytest.approx(truth.geom(geom).xpos, abs=0.004), geom


def test_mallets_lie_flat_whatever_the_arm_does() -> None:
    stage, random = Stage("tournament"), np.random.default_rng(0)
    start = np.array(stage.robot.start)
    for _ in range(20):
        stage.show(np.zeros(3), start + random.uniform(-0.3, 0.3, (2, 7)))
        for k in (1, 2):
            axis = stage.data.body(f"iiwa_{k}/striker_mallet").xmat.reshape(3, 3)[:, 2]
            assert axis == pytest.approx([0.0, 0.0, -1.0], abs=1e-9)


def test_an_arm_of_which_only_the_tip_is_known_has_it_there() -> None:
    stage = Stage("7dof-hit")
    t = np.linspace(0.0, 2 * np.pi, 40)
    tips = np.stack([0.86 + 0.05 * np.sin(t), 0.2 * np.sin(t), np.full(40, 0.0645)], axis=1)
    joints = stage.follow_tips(1, tips)
    reached = np.array([stage.tip_position(1, row) for row in joints])
    assert np.abs(reached - tips).max() < 1e-3


def test_a_live_task_is_the_runs_episode(run_folder: Path) -> None:
    show = LiveTask(Options(environments=("3dof-defend",), agent="hold", episodes=3, seed=4), episode=2)
    pucks = [show.stage.data.qpos[-3:].copy()]
    while show.advance():
        pucks.append(show.stage.data.qpos[-3:].copy())
    seen = trajectories.read_episode(run_folder / "trajectories.h5", "3dof-defend", 2)["observations"]
    assert np.array(pucks)[:, :2] == pytest.approx(seen[:, :2] - [1.51, 0.0], abs=1e-12)
    assert show.caption().news in ("puck stopped", "not achieved")
    show.begin(0)
    assert show.step == 0 and show.caption().news == ""


def test_an_agent_that_fails_ends_its_episode_not_the_show(submission: Callable[..., str]) -> None:
    agent = submission("raise ValueError('no idea')")
    show = LiveTask(Options(environments=("3dof-defend",), agent=agent))
    while show.advance():
        pass
    assert "no idea" in show.caption().news
    show.begin(1)
    assert show.caption().news == ""


def test_a_live_game_is_the_matchs_game() -> None:
    from games import play_one

    from airhockey.evaluator.play.seeding import game_seed

    film = play_one("hold", "hold", 20, game_seed(3, "0")).film
    show = LiveGame("hold", "hold", GameOptions(steps=20), seed=3)
    pucks = []
    while show.advance():
        pucks.append(show.stage.data.qpos[-3:].copy())
    assert np.array(pucks)[:, :2] == pytest.approx(film[:, :2], abs=1e-6)
    assert show.caption().score == (0, 0) and show.caption().players == ("hold", "hold")


def test_the_path_of_the_puck_begins_at_it_and_stays_on_the_table() -> None:
    marks = predicted_path(np.array([0.2, 0.1, 0.0]), np.array([1.5, 2.0, 0.0]))
    points = np.array([mark.end for mark in marks])
    assert marks[0].start[:2] == pytest.approx((0.2, 0.1))
    assert np.abs(points[:, 1]).max() < 0.519
    assert predicted_path(np.zeros(3), np.zeros(3)) == []
    into_the_goal = predicted_path(np.array([0.5, 0.0, 0.0]), np.array([3.0, 0.0, 0.0]))
    assert into_the_goal[-1].start[0] < 0.974, "nothing is drawn behind a goal"


@pytest.mark.parametrize("shape", [(7,), (2, 7), (3, 7), (20, 3, 7)])
def test_a_target_is_drawn_whatever_the_order_of_actions(shape: tuple[int, ...]) -> None:
    stage = Stage("tournament")
    marks = mallet_target(stage, 0, None, np.broadcast_to(np.array(stage.robot.start), shape))
    assert np.abs(marks[0].start[:2]).max() < 1.5

    class Planner:
        target = (-0.5, 0.25)

    marks = mallet_target(stage, 1, Planner.target, np.zeros(shape))
    assert marks[0].start[:2] == (0.5, -0.25), "player 2 looks from the other side"


class Counter:
    """A show of two episodes of 100 steps that only counts."""

    stage: Stage
    can_go_back, episodes = True, 2

    def __init__(self) -> None:
        self.step, self.steps, self.episode = 0, 100, 0

    def begin(self, episode: int) -> None:
        self.step, self.episode = 0, episode

    def advance(self) -> bool:
        self.step += self.step < self.steps
        return self.step < self.steps

    def seek(self, step: int) -> None:
        self.step = step

    def caption(self) -> Caption:
        raise NotImplementedError

    def marks(self) -> list[Mark]:
        return []


class Clock:
    def __init__(self) -> None:
        self.time = 100.0

    def __call__(self) -> float:
        return self.time


def test_buttons() -> None:
    show, clock = Counter(), Clock()
    transport = Transport(show, clock)

    def wait(seconds: float) -> int:
        before = show.step
        for _ in range(round(seconds / 0.01)):
            clock.time += 0.01
            transport.run()
        return show.step - before

    assert wait(0.4) == pytest.approx(20, abs=1)
    transport.do("faster")
    assert wait(0.4) == pytest.approx(40, abs=2)
    transport.do("pause")
    assert wait(0.4) == 0
    transport.do("step")
    transport.do("back")
    transport.do("back")
    assert transport.paused
    transport.seek(98)
    assert wait(0.1) == 0 and show.step == 98
    transport.do("pause")
    wait(PAUSE_AT_END + 0.3)
    assert show.episode == 1, "the next one begins by itself"
    transport.do("next")
    assert (show.episode, show.step) == (0, 0)
    transport.do("previous")
    assert show.episode == 1
    transport.do("what?")
    transport.do("quit")
    assert not transport.running


def test_a_recording_can_be_gone_through_in_both_directions(match_folder: Path) -> None:
    from airhockey.viewing.library import open_library

    show = RecordedShow(open_library(match_folder).entries)
    film = read_film(match_folder / "films/0.h5")
    for step in (60, 7, 1):
        show.seek(step)
        assert show.stage.data.qpos[-3:] == pytest.approx(film[step - 1, :3])
    show.seek(1000)
    assert show.step == 60 and not show.advance()

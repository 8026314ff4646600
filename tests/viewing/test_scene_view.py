"""The scene shows what the simulation had; live playback is the evaluator's episodes and games."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from arms import swinging

from airhockey import envs
from airhockey.envs.rendering.marks import Mark
from airhockey.envs.rendering.scene_view import SceneView
from airhockey.evaluator import Options
from airhockey.evaluator.runs import trajectories
from airhockey.evaluator.runs.game_records import GameOptions
from airhockey.evaluator.runs.game_trajectories import read_film
from airhockey.viewing.caption import Caption
from airhockey.viewing.live import LiveGame, LiveTask, mallet_target
from airhockey.viewing.playback import RecordedPlayback, predicted_path
from airhockey.viewing.playback_controls import PAUSE_AT_END, PlaybackControls


@pytest.mark.parametrize("name", ["3dof-hit", "7dof-prepare", "tournament"])
def test_everything_stands_where_the_simulation_had_it(name: str) -> None:
    env, scene_view = envs.make(name), SceneView(name)
    env.reset(seed=1)
    for action in swinging(env, 25):
        env.step(action)
    base = env.base_observation.reshape(env.n_agents, -1)
    n = scene_view.n_joints
    scene_view.show(base[0, :3], base[:, 6 : 6 + n])
    truth = env.simulation.data
    for geom in ["puck", *(f"{scene_view.robot.prefix}_{k}/ee" for k in range(1, env.n_agents + 1))]:
        # The simulated mallet lags behind the angle that levels it, by millimetres.
        assert scene_view.data.geom(geom).xpos == pytest.approx(truth.geom(geom).xpos, abs=0.004), geom


def test_mallets_lie_flat_whatever_the_arm_does() -> None:
    scene_view, random = SceneView("tournament"), np.random.default_rng(0)
    start = np.array(scene_view.robot.start)
    for _ in range(20):
        scene_view.show(np.zeros(3), start + random.uniform(-0.3, 0.3, (2, 7)))
        for k in (1, 2):
            axis = scene_view.data.body(f"iiwa_{k}/striker_mallet").xmat.reshape(3, 3)[:, 2]
            assert axis == pytest.approx([0.0, 0.0, -1.0], abs=1e-9)


def test_an_arm_of_which_only_the_tip_is_known_has_it_there() -> None:
    scene_view = SceneView("7dof-hit")
    t = np.linspace(0.0, 2 * np.pi, 40)
    tips = np.stack([0.86 + 0.05 * np.sin(t), 0.2 * np.sin(t), np.full(40, 0.0645)], axis=1)
    joints = scene_view.follow_tips(1, tips)
    reached = np.array([scene_view.tip_position(1, row) for row in joints])
    assert np.abs(reached - tips).max() < 1e-3


def test_a_live_task_is_the_runs_episode(run_folder: Path) -> None:
    playback = LiveTask(Options(environments=("3dof-defend",), agent="hold", episodes=3, seed=4), episode=2)
    pucks = [playback.scene_view.data.qpos[-3:].copy()]
    while playback.advance():
        pucks.append(playback.scene_view.data.qpos[-3:].copy())
    seen = trajectories.read_episode(run_folder / "trajectories.h5", "3dof-defend", 2)["observations"]
    assert np.array(pucks)[:, :2] == pytest.approx(seen[:, :2] - [1.51, 0.0], abs=1e-12)
    assert playback.caption().news in ("puck stopped", "not achieved")
    playback.begin(0)
    assert playback.step == 0 and playback.caption().news == ""


def test_an_agent_that_fails_ends_its_episode_not_the_show(submission: Callable[..., str]) -> None:
    agent = submission("raise ValueError('no idea')")
    playback = LiveTask(Options(environments=("3dof-defend",), agent=agent))
    while playback.advance():
        pass
    assert "no idea" in playback.caption().news
    playback.begin(1)
    assert playback.caption().news == ""


def test_a_live_game_is_the_matchs_game() -> None:
    from games import play_one

    from airhockey.evaluator.play.seeding import game_seed

    film = play_one("hold", "hold", 20, game_seed(3, "0")).film
    playback = LiveGame("hold", "hold", GameOptions(steps=20), seed=3)
    pucks = []
    while playback.advance():
        pucks.append(playback.scene_view.data.qpos[-3:].copy())
    assert np.array(pucks)[:, :2] == pytest.approx(film[:, :2], abs=1e-6)
    assert playback.caption().score == (0, 0) and playback.caption().players == ("hold", "hold")


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
    scene_view = SceneView("tournament")
    marks = mallet_target(scene_view, 0, None, np.broadcast_to(np.array(scene_view.robot.start), shape))
    assert np.abs(marks[0].start[:2]).max() < 1.5

    class Planner:
        target = (-0.5, 0.25)

    marks = mallet_target(scene_view, 1, Planner.target, np.zeros(shape))
    assert marks[0].start[:2] == (0.5, -0.25), "player 2 looks from the other side"


class Counter:
    """A playback of two episodes of 100 steps that only counts."""

    scene_view: SceneView
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
    playback, clock = Counter(), Clock()
    controls = PlaybackControls(playback, clock)

    def wait(seconds: float) -> int:
        before = playback.step
        for _ in range(round(seconds / 0.01)):
            clock.time += 0.01
            controls.run()
        return playback.step - before

    assert wait(0.4) == pytest.approx(20, abs=1)
    controls.do("faster")
    assert wait(0.4) == pytest.approx(40, abs=2)
    controls.do("pause")
    assert wait(0.4) == 0
    controls.do("step")
    controls.do("back")
    controls.do("back")
    assert controls.paused
    controls.seek(98)
    assert wait(0.1) == 0 and playback.step == 98
    controls.do("pause")
    wait(PAUSE_AT_END + 0.3)
    assert playback.episode == 1, "the next one begins by itself"
    controls.do("next")
    assert (playback.episode, playback.step) == (0, 0)
    controls.do("previous")
    assert playback.episode == 1
    controls.do("what?")
    controls.do("quit")
    assert not controls.running


def test_a_recording_can_be_gone_through_in_both_directions(match_folder: Path) -> None:
    from airhockey.viewing.library import open_library

    playback = RecordedPlayback(open_library(match_folder).entries)
    film = read_film(match_folder / "films/0.h5")
    for step in (60, 7, 1):
        playback.seek(step)
        assert playback.scene_view.data.qpos[-3:] == pytest.approx(film[step - 1, :3])
    playback.seek(1000)
    assert playback.step == 60 and not playback.advance()

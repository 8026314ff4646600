"""`render()` of every interface: pictures that show what happens, at the length of the episode, also of copies."""

import copy
import gc
import re
import subprocess
import sys
import time
import urllib.error
import urllib.request
import warnings
from pathlib import Path

import gymnasium
import numpy as np
import pettingzoo
import pytest
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import render_test
from pettingzoo.utils import parallel_to_aec
from tools import needs_rendering

import airhockey.envs.gymnasium
from airhockey.agents.hold import standing_still
from airhockey.envs.pettingzoo import IDS
from airhockey.envs.rendering.live_page import LivePage
from airhockey.errors import ConfigurationError, MissingDependencyError


@pytest.fixture(autouse=True)
def drawing() -> None:
    """Each draws."""
    needs_rendering()


def test_gymnasiums_checker_renders_in_every_mode() -> None:
    env = gymnasium.make("airhockey/3dof-hit-v0", render_mode="rgb_array")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        check_env(env.unwrapped)
    assert not [text for text in (str(item.message) for item in caught) if "render" in text.lower()]
    env.close()


def test_a_picture_shows_the_puck_where_it_is() -> None:
    env = gymnasium.make("airhockey/7dof-hit-v0", render_mode="rgb_array", width=320, height=180)
    env.reset(seed=1)
    first = env.render()
    assert first.shape == (180, 320, 3)
    assert first.dtype == np.uint8
    np.testing.assert_array_equal(env.render(), first)
    env.reset(seed=2)
    second = env.render()
    changed = (np.abs(first.astype(int) - second).max(axis=2) > 40).mean()
    assert 0.0005 < changed < 0.1  # the puck, twice, and not the room


@pytest.mark.parametrize("wrapper", ["RecordVideo", "VecVideoRecorder"])
def test_a_film_has_the_length_of_the_episode(wrapper: str, tmp_path: Path) -> None:
    pytest.importorskip("moviepy")
    import av

    made = {"render_mode": "rgb_array", "width": 160, "height": 96}
    if wrapper == "RecordVideo":
        env = gymnasium.wrappers.RecordVideo(gymnasium.make("airhockey/3dof-hit-v0", **made), str(tmp_path))
        seen, _ = env.reset(seed=0)
        action = standing_still(seen[6:9], 3)
    else:
        many = gymnasium.make_vec("airhockey/3dof-hit-v0", num_envs=2, vectorization_mode="sync", **made)
        env = gymnasium.wrappers.vector.RecordVideo(many, str(tmp_path), video_length=40)
        seen, _ = env.reset(seed=0)
        action = np.stack([standing_still(one[6:9], 3) for one in seen])
    for _ in range(40):
        env.step(action)
    env.close()
    (film,) = tmp_path.glob("*.mp4")
    with av.open(str(film)) as container:
        (stream,) = container.streams.video
        assert stream.average_rate == 50
        assert sum(1 for _ in container.decode(stream)) in (40, 41)


def test_a_copy_renders_apart_from_its_original() -> None:
    env = gymnasium.make("airhockey/3dof-defend-v0", render_mode="rgb_array", width=160, height=96).unwrapped
    env.reset(seed=4)
    before = env.render()
    other = copy.deepcopy(env)
    for _ in range(30):
        other.step(standing_still(np.array(env.environment.simulation.robot.start), 3))
    assert np.abs(other.render().astype(int) - before).max() > 40
    np.testing.assert_array_equal(env.render(), before)
    other.close()
    np.testing.assert_array_equal(env.render(), before)
    env.close()


def test_several_are_live_at_once_and_one_may_be_left_open(capfd: pytest.CaptureFixture[str]) -> None:
    def live() -> gymnasium.Env:
        env = airhockey.envs.gymnasium.AirHockeyEnv("3dof-hit", render_mode="human")
        env.reset(seed=0)
        return env

    first, second = live(), live()
    addresses = re.findall(r"watch at (\S+)", capfd.readouterr().err)
    assert len(set(addresses)) == 2
    first.close()
    with urllib.request.urlopen(addresses[1]) as page:
        assert page.status == 200
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(addresses[0])
    third = live()
    for env in (second, third):
        env.step(standing_still(np.array([-1.15570, 1.30024, 1.44280]), 3))
    third.close()
    del second, env  # and nobody closes it
    gc.collect()
    time.sleep(1.0)
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(addresses[1])


def test_a_script_may_end_while_one_is_live() -> None:
    script = """
from airhockey.envs.gymnasium import AirHockeyEnv
env = AirHockeyEnv("3dof-hit", render_mode="human")
env.reset(seed=0)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert "watch at" in done.stderr


def test_without_the_viewer_a_live_page_names_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco.studio", None)
    with pytest.raises(MissingDependencyError, match="pip install"):
        LivePage("3dof-hit", "2023")


def test_pettingzoos_check_renders() -> None:
    def game(render_mode: str) -> pettingzoo.AECEnv:
        return parallel_to_aec(pettingzoo.make("parallel", IDS["2023"], render_mode=render_mode, max_cycles=20))

    render_test(game)


def test_a_game_tells_its_state() -> None:
    game = pettingzoo.make("parallel", IDS["2023"], max_cycles=20)
    game.reset(seed=1)
    assert game.state_space.contains(game.state())


@pytest.mark.parametrize(
    ("made", "words"),
    [({"render_mode": "ascii"}, "ascii.*allowed: human, rgb_array"), ({"width": 0}, "0 x 360.*from 16")],
)
def test_what_cannot_be_shown_is_said(made: dict[str, object], words: str) -> None:
    with pytest.raises(ConfigurationError, match=words):
        airhockey.envs.gymnasium.AirHockeyEnv("3dof-hit", **made)

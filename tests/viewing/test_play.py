"""`hockey play`: the mallet that follows a hand, and the page between them."""

import collections
import json
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from tools import chromium
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from airhockey import envs
from airhockey.agents.person import HAND, Hand, PersonAgent, Seen
from airhockey.agents.table import HALF_LENGTH, HALF_WIDTH, HOME
from airhockey.viewing.play_page import PlayPage


@pytest.fixture
def page():
    with PlayPage(Hand(), "127.0.0.1", 0) as running:
        yield running


def seen(step: int) -> Seen:
    return Seen(step, np.array([0.1, 0.2]), HOME, np.array([0.86, 0.0]), HOME)


def socket_of(page: PlayPage, **more: object):
    return connect(page.address.replace("http://", "ws://").replace("/?", "/play?"), **more)


def test_a_hand_points_at_the_table_and_home_where_it_does_not() -> None:
    hand = Hand()
    assert np.array_equal(hand.target, HOME)
    hand.point(9.0, -9.0)
    assert np.array_equal(hand.target, [HALF_LENGTH, -HALF_WIDTH])
    hand.release()
    assert np.array_equal(hand.target, HOME)


@pytest.mark.parametrize(
    "message",
    [
        "[" * 200, "[1" + "0" * 400 + ", 0]", "[NaN, 0]", "[Infinity, -Infinity]", "[1e999, 0]", "[true, false]", "{}", "[0]",
        '["0", "0"]', "[[0], 0]", "\ud800", b"\xff\xfe", b"", "9" * 5000, "[-0.0, 1e6]",
    ],
)  # fmt: skip
def test_what_is_no_place_on_the_table_is_not_listened_to(page: PlayPage, message: str | bytes) -> None:
    page._take(message)
    assert np.array_equal(page._hand.target, HOME) and not page._somebody.is_set()


def test_the_mallet_follows_within_the_arms_limits() -> None:
    env = envs.make("tournament")
    agent = PersonAgent(env.env_info)
    half = env.reset(seed=3).size // 2
    observation = env.reset(seed=3)
    other = np.zeros(env.formats[1].shape)
    other[0] = observation[half:][env.env_info["joint_pos_ids"]]
    reached = []
    try:
        for x, y in ((-0.6, 0.3), (-0.4, -0.3), (0.9, 0.5), (-0.9, 0.0)):
            HAND.point(x, y)
            for _ in range(60):
                observation, *_ = env.step((agent.draw_action(observation[:half].copy()), other))
                assert env.constraint_values[0].max() <= 0.0
            _, last = HAND.wait(-1, 0.0)
            assert last is not None
            reached.append(last.mallet)
    finally:
        HAND.release()
    for place, wanted in zip(reached, ((-0.6, 0.3), (-0.4, -0.3)), strict=False):
        np.testing.assert_allclose(place, wanted, atol=0.01)
    assert reached[2][0] < 0.0  # beyond the middle it cannot go


def test_the_page_is_for_who_brings_the_token(page: PlayPage) -> None:
    with urllib.request.urlopen(page.address, timeout=20) as answer:
        assert "script-src 'nonce-" in answer.headers["Content-Security-Policy"]
        text = answer.read().decode()
    assert "{{" not in text.replace("{{}}", "")
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(page.address.partition("?")[0], timeout=20)
    with pytest.raises(InvalidStatus, match="403"):
        connect(page.address.partition("?")[0].replace("http://", "ws://") + "play")
    with pytest.raises(InvalidStatus, match="403"):
        socket_of(page, origin="http://elsewhere.example")


def test_what_there_is_to_see_goes_out_and_where_one_points_comes_back(page: PlayPage) -> None:
    with socket_of(page) as socket:
        for step in range(3):
            page._hand.show(seen(step))
        told = json.loads(socket.recv(timeout=10))
        while told.get("step") != 2:
            told = json.loads(socket.recv(timeout=10))
        assert told["puck"] == [0.1, 0.2] and told["opponent"] == [0.86, 0.0]
        for rubbish in ("[1]", "{}", "[true, 0]", "[NaN, 0]", "[1e999, 0]", '["a", 1]', "no json", "[" * 200):
            socket.send(rubbish)
        socket.send("[-0.5, 0.25]")
        page.wait_for_person()
        assert np.array_equal(page._hand.target, [-0.5, 0.25])
        socket.send("null")
        page.end("over")
        while told["over"] is None:
            told = json.loads(socket.recv(timeout=10))
    assert np.array_equal(page._hand.target, HOME)


def test_a_message_that_is_too_long_ends_the_talk_and_no_more(page: PlayPage) -> None:
    with socket_of(page) as socket:
        socket.send("1" * 5000)
        with pytest.raises(ConnectionClosed, match="1009"):
            collections.deque(socket, maxlen=0)  # everything until it is closed
        with pytest.raises(ConnectionClosed, match="1009"):
            socket.recv(timeout=10)
    with socket_of(page) as socket:
        assert json.loads(socket.recv(timeout=10))["over"] is None


def test_nobody_plays_against_themselves(hockey) -> None:
    status, _, err = hockey("play person")
    assert status == 2
    assert "name another opponent" in err


def until(there: Callable[[], bool]) -> None:
    """Wait for something; evaluating in the page keeps to its policy, which waiting in it would not."""
    end = time.monotonic() + 30.0
    while not there():
        assert time.monotonic() < end
        time.sleep(0.02)


def test_mouse_and_finger_lead_the_mallet_in_a_browser(page: PlayPage) -> None:
    from playwright.sync_api import sync_playwright

    errors: list[str] = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        for mobile in (False, True):
            size = {"width": 390, "height": 780} if mobile else {"width": 900, "height": 520}
            shown = browser.new_context(viewport=size, has_touch=mobile).new_page()
            shown.on("pageerror", lambda error: errors.append(str(error)))
            shown.goto(page.address)
            until(partial(shown.evaluate, "socket && socket.readyState === 1"))
            page._hand.release()
            page._hand.show(seen(0))
            box = shown.locator("canvas").bounding_box()
            assert box is not None and box["x"] + box["width"] <= size["width"]
            # A quarter of the way from our goal to the other, on the middle line.
            across, along = box["x"] + box["width"] * 0.3, box["y"] + box["height"] / 2
            if mobile:
                shown.touchscreen.tap(box["x"] + box["width"] / 2, box["y"] + box["height"] * 0.7)
            else:
                shown.mouse.move(across, along)
            until(lambda: -0.6 < page._hand.target[0] < -0.2)
            assert abs(page._hand.target[1]) < 0.01
            until(partial(shown.evaluate, "seen && seen.puck && seen.puck[1] === 0.2"))
        browser.close()
    assert errors == []

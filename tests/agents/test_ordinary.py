"""What ordinary opponents share: a hit is followed to its end, then they rest, then they are free again."""

import numpy as np
import pytest

from airhockey.agents.ordinary.player import Hit, PlainPlayer
from airhockey.envs import make


class Still(PlainPlayer):
    """Does nothing of its own."""

    def play(self) -> np.ndarray:
        action = self.hitting((0.0, 0.0), 8.0, 7)
        self.free = action is None
        return self.go(-0.86, 0.0, 0.5, 4.0) if action is None else action


@pytest.mark.parametrize("time", [0.2, 0.3])
def test_a_hit_is_followed_then_rested_from(time: float) -> None:
    env = make("tournament")
    player = Still(env.env_info)
    half = env.reset(seed=1).size // 2
    observation = env.reset(seed=1)[:half]
    player.draw_action(observation)
    assert player.free
    player.hit = Hit(-0.8, 0.0, 0.4, 0.0, time)
    busy = 0
    while True:
        player.draw_action(observation)
        if player.free:
            break
        busy += 1
    following = round(time / player.dt) + 3  # 0.04 s through the contact
    assert busy == pytest.approx(following + 7, abs=1)
    assert player.hit is None and player.pause == 0

"""Playback of episodes in a scene, step by step, live or from a recording."""

from collections.abc import Sequence
from functools import cache
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.rendering.marks import PREDICTED, Mark, path
from airhockey.envs.rendering.scene_view import SceneView
from airhockey.envs.specs import TABLE
from airhockey.viewing.caption import Caption
from airhockey.viewing.entries import Entry
from airhockey.viewing.recording import Recording
from airhockey.viewing.video import trail

Array = NDArray[np.float64]
PREDICTED_SECONDS = 0.8
"""How far ahead the puck's path is drawn."""
_STILL = 0.05  # [m/s]


class Playback(Protocol):
    """What a viewer needs of what it shows.

    Attributes:
        scene_view: Where it is shown; another one may come with another episode.
        step, steps: Control steps shown so far and of the whole episode, as far as that is known.
        episode: Position of the present episode.
        can_go_back: Whether `seek` works.
    """

    scene_view: SceneView
    step: int
    steps: int
    episode: int
    can_go_back: bool

    @property
    def episodes(self) -> int | None:
        """How many there are; None for as many as one likes."""

    def begin(self, episode: int) -> None:
        """Begin an episode, from its start."""

    def advance(self) -> bool:
        """One control step; False where the episode is over."""

    def seek(self, step: int) -> None:
        """Show another step, where `can_go_back`."""

    def caption(self) -> Caption:
        """How things stand."""

    def marks(self) -> list[Mark]:
        """What is to be drawn into the scene."""

    def close(self) -> None:
        """Let go of everything: it is over."""


class RecordedPlayback:
    """Recordings, one after the other.

    Args:
        entries: What there is.
        episode: Position of the one to begin with.
    """

    can_go_back = True

    def __init__(self, entries: Sequence[Entry], episode: int = 0) -> None:
        self._entries = list(entries)
        self._scene_views: dict[tuple[str, str], SceneView] = {}
        self.begin(episode)

    @property
    def episodes(self) -> int | None:
        """See `Playback`."""
        return len(self._entries)

    def begin(self, episode: int) -> None:
        """See `Playback`."""
        self.episode = episode % len(self._entries)
        self._recording: Recording = self._entries[self.episode].load()
        scene = self._recording.env, self._recording.edition
        if scene not in self._scene_views:
            self._scene_views[scene] = SceneView(*scene)
        self.scene_view, self.steps = self._scene_views[scene], self._recording.steps
        self.seek(0)

    def advance(self) -> bool:
        """See `Playback`."""
        if self.step >= self.steps:
            return False
        self.seek(self.step + 1)
        return True

    def seek(self, step: int) -> None:
        """See `Playback`."""
        self.step = min(max(step, 0), self.steps)
        row = self._recording.row(self.step)
        self.scene_view.show(self._recording.puck[row], self._recording.joints[row])

    def caption(self) -> Caption:
        """See `Playback`."""
        return self._recording.narrator.caption(self.step)

    def marks(self) -> list[Mark]:
        """See `Playback`."""
        row = self._recording.row(self.step)
        puck, velocity = self._recording.puck[row], self._recording.puck_velocity[row]
        return trail(self._recording, row) + predicted_path(puck, velocity)

    def close(self) -> None:
        """Nothing is held."""


def predicted_path(puck: Array, velocity: Array) -> list[Mark]:
    """Where the puck will slide and bounce if nobody touches it, by the agents' model of its motion.

    Args:
        puck: x, y, yaw in the world. Shape (3,).
        velocity: Its derivative. Shape (3,).
    """
    if np.hypot(velocity[0], velocity[1]) < _STILL:
        return []
    from airhockey.agents.estimation.kalman import PuckEstimate

    state = np.array([puck[0], puck[1], velocity[0], velocity[1], velocity[2]], dtype=np.float64)
    states = _predictor().path(PuckEstimate(state, np.eye(5) * 1e-9, 0), PREDICTED_SECONDS)
    points = np.asarray(states[::4, :2])
    gone = np.flatnonzero(np.abs(points[:, 0]) > TABLE.length / 2)  # into a goal, where it is over
    return path(points[: gone[0] + 1] if len(gone) else points, PREDICTED)


@cache
def _predictor() -> Any:
    """Made when it is first needed: it compiles."""
    from airhockey.agents.estimation.prediction import PuckPredictor

    return PuckPredictor()

"""Videos of recordings: frame by frame, so that memory does not grow with their length."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from airhockey.envs.specs import CONTROL_PERIOD
from airhockey.errors import ConfigurationError
from airhockey.viewing.entries import Entry
from airhockey.viewing.highlights import frame_steps, highlight_spans
from airhockey.viewing.recording import Recording
from airhockey.viewing.video_writer import MOST_GIF_FRAMES, VideoWriter, check_video, open_video

if TYPE_CHECKING:
    from airhockey.envs.rendering.marks import Mark

OnFrame = Callable[[int, int], None]
"""Called with the frames that are done, and with how many there will be as far as that is known."""
TRAIL_STEPS = 30
"""How long the trail behind the puck is, in control steps."""


@dataclass(frozen=True)
class VideoOptions:
    """How a video is to be.

    Attributes:
        width, height: In pixels.
        fps: Frames per second.
        speed: Times as fast as it was.
        highlights: Only what is worth seeing.
        seconds: Only so much of each episode, from its start, in [s]; None for all of it.
        at: Only this moment of each episode, in [s].
        inset: The view from above in a corner.
        quality: A key of `pictures.QUALITIES`.
    """

    width: int = 960
    height: int = 540
    fps: float = 25.0
    speed: float = 1.0
    highlights: bool = False
    inset: bool = True
    quality: str = "good"
    seconds: float | None = None
    at: float | None = None


def frames_of(recording: Recording, options: VideoOptions) -> list[int]:
    """The control step that each frame shows."""
    if options.at is not None:
        return [min(round(options.at / CONTROL_PERIOD), recording.steps)]
    first = recording.first_step if options.highlights else 0
    seconds = options.seconds if options.seconds is not None else recording.duration
    spans = [(0, min(recording.steps, round(seconds / CONTROL_PERIOD)))]
    if options.highlights:
        spans = highlight_spans(recording.moments, recording.steps, first)
    return frame_steps(spans, options.fps, options.speed)


def write_video(path: Path, entries: Sequence[Entry], options: VideoOptions, on_frame: OnFrame | None = None) -> int:
    """Render recordings one after the other into one video.

    Args:
        path: The video.
        entries: What to show; each is loaded when its turn comes.
        options: How.
        on_frame: Called after every frame.

    Returns:
        Number of frames.

    Raises:
        ConfigurationError: The video cannot be written, or there is nothing to show in it.
        MissingDependencyError: Rendering or writing videos needs something that is not installed.
    """
    from airhockey.envs.rendering.offscreen import choose_backend

    check_video(path, options.width, options.height, options.fps)
    choose_backend()
    done = 0
    with open_video(path, options.width, options.height, options.fps) as writer:
        for number, entry in enumerate(entries):
            recording = entry.load()
            steps = frames_of(recording, options)
            expected = (done + len(steps)) * len(entries) // (number + 1)

            def count(before: int = done, expected: int = expected) -> Callable[[int], None]:
                return lambda k: on_frame(before + k, expected) if on_frame is not None else None

            if path.suffix.lower() == ".gif" and done + len(steps) > MOST_GIF_FRAMES:
                raise ConfigurationError(
                    f"a GIF of more than {MOST_GIF_FRAMES} frames: choose --episodes, --seconds or a lower --fps, or make an .mp4"
                )
            if steps:
                _render(writer, recording, steps, options, count())
            done += len(steps)
        if done == 0:
            what = "highlights (goals, saves, faults, violations)" if options.highlights else "steps"
            raise ConfigurationError(f"there are no {what} in what was chosen: nothing was shown")
    return done


def _render(
    writer: VideoWriter, recording: Recording, steps: Sequence[int], options: VideoOptions, count: Callable[[int], None]
) -> None:
    from airhockey.envs.rendering.camera import Camera
    from airhockey.envs.rendering.scene_view import SceneView
    from airhockey.viewing.overlay import Overlay

    scene_view, overlay = SceneView(recording.env, recording.edition), Overlay(options.width, options.height)
    with Camera(scene_view, options.width, options.height, options.inset, options.quality) as camera:
        for k, step in enumerate(steps, start=1):
            row = recording.row(step)
            scene_view.show(recording.puck[row], recording.joints[row])
            picture = np.array(camera.picture(trail(recording, row)))
            overlay.write(picture, recording.narrator.caption(step))
            writer.add(picture)
            count(k)


def trail(recording: Recording, row: int) -> "list[Mark]":
    """Where the puck came from, fading, back to the last serve at most."""
    from airhockey.envs.rendering import marks

    points = recording.puck[max(0, row - TRAIL_STEPS) : row + 1, :2][::-1]
    jumps = np.flatnonzero(np.hypot(*np.diff(points, axis=0).T) > 0.2)
    if len(jumps):
        points = points[: jumps[0] + 1]
    return marks.path(points, marks.TRAIL) if len(points) > 1 else []

"""Pictures of a scene: the game from the stands, and small in a corner the same from above."""

from collections.abc import Sequence
from typing import Any, Self

import mujoco
import numpy as np
from numpy.typing import NDArray

from airhockey.envs.rendering.marks import Mark, add_to_scene
from airhockey.envs.rendering.offscreen import new_context
from airhockey.envs.rendering.scene_view import SceneView

Picture = NDArray[np.uint8]
QUALITIES = {"fast": (0, 0), "good": (1024, 0), "fine": (4096, 4)}
"""Side of the shadow map (0: no shadows) and samples per pixel: on a processor about 1 : 3 : 6 in time."""
INSET_SHARE = 0.30
"""Width of the view from above, as a share of the picture's."""
INSET_ASPECT = 2.30 / 1.26
"""Table with its rims, a little air around it."""
INSET_TOP = 0.095
"""Where it begins, as a share of the picture's height: below the scoreboard."""
_MARGIN, _FRAME = 0.012, 0.0025  # shares of the picture's width


class Camera:
    """Draws a scene, from two sides at once, with one context.

    Args:
        scene_view: What to draw.
        width, height: Of the pictures, in pixels.
        inset: Whether to draw the view from above.
        quality: A key of `QUALITIES`.
    """

    def __init__(
        self, scene_view: SceneView, width: int, height: int, inset: bool = True, quality: str = "good"
    ) -> None:
        self.scene_view, self.width, self.height = scene_view, width, height
        model = scene_view.model
        shadows, samples = QUALITIES[quality]
        model.vis.quality.shadowsize, model.vis.quality.offsamples = max(shadows, 1), samples
        self._shadows = shadows > 0
        model.vis.global_.offwidth, model.vis.global_.offheight = width, height
        self._option = mujoco.MjvOption()
        self._scene = mujoco.MjvScene(model, maxgeom=1000)
        self._views = [(look_from_stands(scene_view.robots, width / height), mujoco.MjrRect(0, 0, width, height))]
        if inset:
            w = round(INSET_SHARE * width)
            h, margin = round(w / INSET_ASPECT), round(_MARGIN * width)
            left = (width - w) // 2 if scene_view.robots == 2 else width - w - margin  # where no arm is
            top = round(INSET_TOP * height)
            self._views.append((look_from_above(), mujoco.MjrRect(left, height - top - h, w, h)))
        self._context = new_context(width, height)
        self._context.make_current()
        self._renderer = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._renderer)
        self._pixels = np.empty((height, width, 3), dtype=np.uint8)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._renderer.free()
        self._context.free()

    def picture(self, marks: Sequence[Mark] = ()) -> Picture:
        """What the scene shows now, and what is marked in it. Shape (height, width, 3); overwritten by the next picture."""
        for number, (camera, place) in enumerate(self._views):
            if number:
                frame = max(2, round(_FRAME * self.width))
                border = mujoco.MjrRect(
                    place.left - frame, place.bottom - frame, place.width + 2 * frame, place.height + 2 * frame
                )
                mujoco.mjr_rectangle(border, 0.09, 0.11, 0.15, 1.0)
            self._draw(camera, place, marks, shadows=self._shadows and number == 0)
        mujoco.mjr_readPixels(self._pixels, None, self._views[0][1], self._renderer)
        return self._pixels[::-1]

    def _draw(self, camera: Any, place: Any, marks: Sequence[Mark], shadows: bool) -> None:
        scene, scene_view = self._scene, self.scene_view
        everything = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(scene_view.model, scene_view.data, self._option, None, camera, everything, scene)
        scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = shadows
        scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = 0
        add_to_scene(scene, marks)
        mujoco.mjr_render(place, scene, self._renderer)


def look_from_stands(robots: int, aspect: float) -> Any:
    """From the side, a little above: both robots and the whole table."""
    camera = mujoco.MjvCamera()
    two = robots == 2
    camera.lookat[:] = (0.0, 0.05, 0.22) if two else (-0.26, 0.02, 0.24)
    camera.azimuth, camera.elevation = (90.0, -31.0) if two else (80.0, -32.0)
    camera.distance = (2.66 if two else 2.38) * max(1.0, (16 / 9) / aspect)
    return camera


def look_from_above(fill: float = 1.0) -> Any:
    """Straight down: the table fills the picture; from `fill` times that height."""
    camera = mujoco.MjvCamera()
    camera.lookat[:] = (0.0, 0.0, 0.0)
    camera.azimuth, camera.elevation, camera.distance = 90.0, -90.0, 1.53 * fill
    return camera

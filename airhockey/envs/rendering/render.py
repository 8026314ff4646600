"""`render()` of the Gymnasium, PettingZoo and MushroomRL interfaces: the present moment as a picture, or live for a person."""

import time
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from airhockey.envs.rendering.display import has_display
from airhockey.envs.specs import CONTROL_PERIOD
from airhockey.errors import ConfigurationError

if TYPE_CHECKING:
    from airhockey.envs.environment import Environment

MODES = ("human", "rgb_array")
"""Live, at the pace of a real robot; or an array, as fast as it can be drawn."""
FRAMES_PER_SECOND = round(1.0 / CONTROL_PERIOD)


class Rendered:
    """What the Gymnasium and PettingZoo environments have for being looked at.

    Attributes:
        environment: The challenge environment behind it.
        render_mode: One of `MODES`, or None where nothing is shown.
    """

    environment: "Environment"
    render_mode: str | None

    def _can_be_looked_at(self, name: str, edition: str, mode: str | None, width: int, height: int) -> None:
        """To be called once by `__init__`, with the arguments of `Renderer`."""
        self.render_mode = mode
        self._renderer = Renderer(name, edition, mode, width, height)

    def render(self) -> Any:
        """The present moment: an array of shape (height, width, 3) for "rgb_array"; "human" shows every step by itself."""
        return self._renderer.render(self.environment.simulation.data)

    def close(self) -> None:
        """Close what `render` opened."""
        self._renderer.close()

    def _show(self) -> None:
        """After every step and reset."""
        if self.render_mode == "human":
            self.render()


class Renderer:
    """Shows an environment. Nothing is opened before the first call.

    Args:
        name, edition: Of the environment.
        mode: One of `MODES`, or None where nothing is shown.
        width, height: Of the picture, in pixels.

    Raises:
        ConfigurationError: There is no such mode.
    """

    def __init__(self, name: str, edition: str, mode: str | None, width: int = 640, height: int = 360) -> None:
        if mode not in (None, *MODES):
            raise ConfigurationError(
                f"unknown render_mode {mode!r}; allowed: {', '.join(MODES)}, or None for no pictures"
            )
        if not all(type(side) is int and 16 <= side <= 8192 for side in (width, height)):
            raise ConfigurationError(f"a picture of {width} x {height}: width and height are integers from 16 to 8192")
        self.mode = mode
        self._made_with = (name, edition, mode, width, height)
        self._scene_view: Any = None
        self._camera: Any = None
        self._live: Any = None
        self._next = 0.0

    def __reduce__(self) -> tuple[type[Self], tuple[Any, ...]]:
        """A copy shows nothing until it is asked to: a window or a context cannot be shared."""
        return type(self), self._made_with

    def __deepcopy__(self, _: dict[int, Any]) -> Self:
        return type(self)(*self._made_with)

    def render(self, data: Any) -> NDArray[np.uint8] | None:
        """Show this moment.

        Args:
            data: The simulation's `MjData`.

        Returns:
            With the mode "rgb_array" the picture, of shape (height, width, 3); else None.

        Raises:
            MissingDependencyError: This machine cannot draw; the message names what to install.
        """
        if self.mode is None:
            return None
        name, edition, mode, width, height = self._made_with
        if mode == "human":
            self._show(data)
            return None
        if self._scene_view is None:
            from airhockey.envs.rendering.scene_view import SceneView

            self._scene_view = SceneView(name, edition)
        self._scene_view.copy_state(data)
        if self._camera is None:
            from airhockey.envs.rendering.camera import Camera

            self._camera = Camera(self._scene_view, width, height, quality="fast")
        return np.array(self._camera.picture())

    def close(self) -> None:
        """Close what was opened; the next `render` opens it again."""
        if self._camera is not None:
            self._camera.__exit__()
        if self._live is not None:
            self._live.close()
        self._scene_view = self._camera = self._live = None

    def _show(self, data: Any) -> None:
        """In a window, or where there is no display on a page of this machine; then wait for the pace of a real robot."""
        if self._live is None:
            self._live = self._open()
            self._next = time.monotonic()
        if not self._live.is_running():  # the person has closed it
            return
        self._live.show(data)
        self._next = max(self._next + CONTROL_PERIOD, time.monotonic() - CONTROL_PERIOD)
        time.sleep(max(0.0, self._next - time.monotonic()))

    def _open(self) -> Any:
        name, edition = self._made_with[:2]
        if has_display():
            from airhockey.envs.rendering.live_window import LiveWindow

            return LiveWindow(name, edition)
        from airhockey.envs.rendering.live_page import LivePage

        return LivePage(name, edition)

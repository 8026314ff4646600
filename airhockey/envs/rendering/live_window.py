"""A window that shows an environment live, by MuJoCo's viewer."""

from typing import Any

from airhockey.envs.rendering.display import needs_studio
from airhockey.envs.rendering.scene_view import SceneView


class LiveWindow:
    """Shows the present moment of a scene.

    Args:
        env, edition: Of the environment.

    Raises:
        MissingDependencyError: MuJoCo was installed without its viewer.
    """

    def __init__(self, env: str, edition: str) -> None:
        with needs_studio():
            from mujoco.studio import launch_native, viewer_protocol
        self._view = SceneView(env, edition)
        self._handle = launch_native.launch(viewer_protocol.ViewerConfig(title="airhockey"))
        self._handle.set_model(self._view.model, data=self._view.data)

    def is_running(self) -> bool:
        """Whether it is open."""
        return bool(self._handle.is_running())

    def show(self, data: Any) -> None:
        """Show what an `MjData` of the scene says."""
        self._view.copy_state(data)
        self._handle.sync()

    def close(self) -> None:
        """End it."""
        self._handle.close()

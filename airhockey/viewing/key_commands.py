"""What the panel says, kept until it is asked for. Lives on the show's side of MuJoCo's viewer."""

from mujoco.studio import messages, plugin

from airhockey.viewing.panel import Command


class Ears(plugin.SimPlugin):
    """Collects the panel's commands."""

    def __init__(self) -> None:
        self._heard: list[tuple[str, int]] = []

    @messages.handler
    def on_command(self, command: Command) -> None:
        """Keep it."""
        self._heard.append((command.command, command.step))

    def take(self) -> list[tuple[str, int]]:
        """What was said since the last time: commands, with the step where one is meant."""
        heard, self._heard = self._heard, []
        return heard

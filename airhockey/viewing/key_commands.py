"""Commands of the panel's buttons and keys, collected by the process that plays back until it takes them."""

from mujoco.studio import messages, plugin

from airhockey.viewing.panel import Command


class KeyCommands(plugin.SimPlugin):
    """Collects the panel's commands."""

    def __init__(self) -> None:
        self._collected: list[tuple[str, int]] = []

    @messages.handler
    def on_command(self, command: Command) -> None:
        """Keep it."""
        self._collected.append((command.command, command.step))

    def take(self) -> list[tuple[str, int]]:
        """The commands since the last time, each with its step where it has one."""
        collected, self._collected = self._collected, []
        return collected

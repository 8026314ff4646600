"""Playing, pausing, stepping: what a viewer's buttons do to a playback, and when its next step is due."""

from collections.abc import Callable
from dataclasses import dataclass

from airhockey.envs.specs import CONTROL_PERIOD
from airhockey.viewing.playback import Playback

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
"""Times as fast as it is, in the order of the keys + and -."""
PAUSE_AT_END = 2.0
"""Between an episode and the next one, in [s]."""
_MOST_AT_ONCE = 0.2  # [s]: what was slept through is not caught up with


@dataclass(frozen=True)
class Key:
    """What a key does.

    Attributes:
        key: As it is typed.
        command: A command of `PlaybackControls`.
        label: For people.
    """

    key: str
    command: str
    label: str


KEYS = (
    Key(" ", "pause", "pause / go on"),
    Key(".", "step", "one step"),
    Key(",", "back", "one step back"),
    Key("+", "faster", "faster"),
    Key("-", "slower", "slower"),
    Key("r", "restart", "from the start"),
    Key("n", "next", "next episode"),
    Key("p", "previous", "previous episode"),
    Key("q", "quit", "quit"),
)


class PlaybackControls:
    """Drives a playback.

    Args:
        playback: What is shown.
        now: A clock, in [s].

    Attributes:
        paused: Whether it stands still.
        speed: Times as fast as it is.
        running: False once the user has enough.
    """

    def __init__(self, playback: Playback, now: Callable[[], float]) -> None:
        self.playback, self._now = playback, now
        self.paused, self.speed, self.running = False, 1.0, True
        self._due = now()
        self._ended: float | None = None
        self._commands: dict[str, Callable[[], None]] = {
            "pause": self._toggle,
            "step": self._step,
            "back": lambda: self.seek(self.playback.step - 1),
            "faster": lambda: self._change_speed(1),
            "slower": lambda: self._change_speed(-1),
            "restart": lambda: self.begin(self.playback.episode),
            "next": lambda: self.begin(self.playback.episode + 1),
            "previous": lambda: self.begin(self.playback.episode - 1),
            "quit": self._quit,
        }

    def do(self, command: str) -> None:
        """Do what a key or button says; an unknown command is nothing."""
        action = self._commands.get(command)
        if action is not None:
            action()

    def begin(self, episode: int) -> None:
        """Begin an episode; before the first one comes the last, where there is one."""
        count = self.playback.episodes
        self.playback.begin(max(episode, 0) if count is None else episode % count)
        self._ended, self._due = None, self._now()

    def seek(self, step: int) -> None:
        """Go to a step and stay there, where the playback can."""
        if self.playback.can_go_back:
            self.paused, self._ended = True, None
            self.playback.seek(step)

    def run(self) -> None:
        """Take the steps that are due by now; some time after an episode's end the next one begins."""
        now = self._now()
        if self.paused:
            self._due = now
            return
        if self._ended is not None:
            if now - self._ended > PAUSE_AT_END:
                self.begin(self.playback.episode + 1)
            return
        self._due = max(self._due, now - _MOST_AT_ONCE)
        while self._due <= now:
            self._due += CONTROL_PERIOD / self.speed
            if not self.playback.advance():
                self._ended = now
                return

    def do_nothing(self) -> None:
        """Let time pass without a step."""
        self._due = self._now()

    def _toggle(self) -> None:
        self.paused = not self.paused
        self._due = self._now()

    def _step(self) -> None:
        self.paused = True
        self.playback.advance()

    def _change_speed(self, by: int) -> None:
        place = min(max(SPEEDS.index(self.speed) + by, 0), len(SPEEDS) - 1)
        self.speed = SPEEDS[place]

    def _quit(self) -> None:
        self.running = False

"""How things stand, in words and numbers: what overlays and panels show."""

from dataclasses import dataclass

Color = tuple[float, float, float]


@dataclass(frozen=True)
class Caption:
    """How things stand at one moment.

    Attributes:
        title: What is shown.
        players: Names; one, or home and away.
        seconds: Since the beginning.
        score, faults, penalty: Of home and away, or of the only player; None where nothing is counted.
        phases: What each player is doing, as far as it says so.
        news: What has just happened; "" for nothing.
        alarm: Constraints that are violated now; "" for none.
    """

    title: str
    players: tuple[str, ...]
    seconds: float
    score: tuple[int, int] | None = None
    faults: tuple[int, int] | None = None
    penalty: tuple[float, ...] | None = None
    phases: tuple[str, ...] = ()
    news: str = ""
    alarm: str = ""

    @property
    def clock(self) -> str:
        """Minutes, seconds and tenths."""
        minutes, seconds = divmod(self.seconds, 60.0)
        return f"{int(minutes)}:{seconds:04.1f}"

    @property
    def lines(self) -> list[str]:
        """Everything as lines of text, for panels and terminals."""
        lines = [f"{self.title}   {self.clock}"]
        if self.score is not None:
            lines.append(f"{self.players[0]} {self.score[0]} : {self.score[1]} {self.players[1]}")
        else:
            lines.append(" - ".join(self.players))
        if self.faults is not None:
            lines.append(f"faults {self.faults[0]} : {self.faults[1]}")
        if self.penalty is not None:
            lines.append("penalty " + " : ".join(f"{points:g}" for points in self.penalty))
        lines += [f"{name}: {phase}" for name, phase in zip(self.players, self.phases, strict=False) if phase]
        return [*lines, *(line for line in (self.news, self.alarm) if line)]

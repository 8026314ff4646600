"""Words over a picture: a scoreboard at the top, news and alarms at the bottom."""

from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from airhockey.errors import MissingDependencyError
from airhockey.viewing.caption import Caption

Picture = NDArray[np.uint8]
Color = tuple[int, int, int]
INK: Color = (236, 240, 245)
FAINT: Color = (165, 176, 190)
BAR: Color = (20, 26, 36)
NEWS: Color = (255, 214, 102)
ALARM: Color = (255, 122, 105)
PLAYERS: tuple[Color, Color] = (92, 160, 255), (84, 205, 130)
BAR_SHARE = 0.075
"""Height of the bars, as a share of the picture's."""
_OPAQUE = 0.86


class Overlay:
    """Writes captions over pictures; what did not change since the last picture is not drawn again.

    Args:
        width, height: Of the pictures, in pixels.

    Raises:
        MissingDependencyError: Pillow is not installed.
    """

    def __init__(self, width: int, height: int) -> None:
        try:
            import PIL  # noqa: F401
        except ImportError as error:
            raise MissingDependencyError("videos need Pillow: pip install 'airhockey[video]'") from error
        self.width, self.height = width, height
        self.bar = max(16, round(BAR_SHARE * height))
        self._drawn: tuple[Caption, Any, Any] | None = None

    def write(self, picture: Picture, caption: Caption) -> None:
        """Write over a picture, in place. Shape (height, width, 3)."""
        shown = replace(caption, seconds=int(caption.seconds * 10 + 0.5) / 10)
        if self._drawn is None or self._drawn[0] != shown:
            words = shown.alarm or shown.news
            self._drawn = shown, self._scoreboard(shown), self._ticker(shown) if words else None
        _, top, bottom = self._drawn
        _blend(picture[: self.bar], top)
        if bottom is not None:
            _blend(picture[self.height - self.bar :], bottom)

    @cached_property
    def _fonts(self) -> tuple[Any, Any]:
        from PIL import ImageFont

        return ImageFont.load_default(0.56 * self.bar), ImageFont.load_default(0.40 * self.bar)

    def _scoreboard(self, caption: Caption) -> Picture:
        board, pen = self._blank()
        large, small = self._fonts
        middle, edge = self.bar / 2, round(0.35 * self.bar)
        if caption.score is None:
            pen.text((edge, middle), caption.players[0], PLAYERS[0], large, "lm")
            pen.text((self.width / 2, middle), caption.title, INK, small, "mm")
        else:
            home, away = self._sides(caption)
            score = f"{caption.score[0]} : {caption.score[1]}"
            half = max(pen.textlength(score, large) / 2, 1.1 * self.bar) + edge
            pen.text((self.width / 2, middle), score, INK, large, "mm")
            pen.text((self.width / 2 - half, middle), caption.players[0], PLAYERS[0], large, "rm")
            pen.text((self.width / 2 + half, middle), caption.players[1], PLAYERS[1], large, "lm")
            pen.text((edge, middle), home, FAINT, small, "lm")
            pen.text((self.width - edge - pen.textlength("00:00.0  ", small), middle), away, FAINT, small, "rm")
        pen.text((self.width - edge, middle), caption.clock, INK, small, "rm")
        return np.asarray(board)

    def _sides(self, caption: Caption) -> tuple[str, str]:
        """Faults and penalty of home and away."""
        texts = []
        for k in range(2):
            parts = []
            if caption.faults is not None:
                parts.append(f"faults {caption.faults[k]}")
            if caption.penalty is not None:
                parts.append(f"penalty {caption.penalty[k]:g}")
            texts.append("  ".join(parts))
        return texts[0], texts[1]

    def _ticker(self, caption: Caption) -> Picture:
        strip, pen = self._blank()
        _, small = self._fonts
        middle, edge = self.bar / 2, round(0.35 * self.bar)
        if caption.alarm:
            pen.text((edge, middle), caption.alarm, ALARM, small, "lm")
        if caption.news:
            pen.text((self.width / 2 if not caption.alarm else self.width - edge, middle), caption.news, NEWS, small,
                     "mm" if not caption.alarm else "rm")  # fmt: skip
        return np.asarray(strip)

    def _blank(self) -> tuple[Any, Any]:
        from PIL import Image, ImageDraw

        image = Image.new("RGB", (self.width, self.bar), BAR)
        return image, ImageDraw.Draw(image)


def _blend(part: Picture, over: Picture) -> None:
    """Lay one picture over another, a little of which shows through."""
    part[:] = (_OPAQUE * over + (1.0 - _OPAQUE) * part).astype(np.uint8)

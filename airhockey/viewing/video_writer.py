"""Writing videos frame by frame: H.264 with PyAV, GIF and stills with Pillow. A video has its name once it is complete."""

import contextlib
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from airhockey.errors import AirHockeyError, ConfigurationError, MissingDependencyError

Picture = NDArray[np.uint8]
FORMATS = (".mp4", ".mkv", ".mov", ".gif", ".png")
INSTALL = "pip install 'airhockey[video]'"
_QUALITY = "20"  # constant rate factor: smaller is better and larger
MOST_GIF_FRAMES = 1500
"""They are held in memory until the last one, and no page wants to load more."""
_PALETTE = 128
_SWATCH = 0.02
"""Share of the picture's height that each small but telling colour gets when the palette is chosen."""


class VideoWriter(Protocol):
    """Something that takes pictures."""

    def add(self, picture: Picture) -> None:
        """Add a frame. Shape (height, width, 3)."""


def check_video(path: Path, width: int, height: int, fps: float) -> None:
    """Raise what would go wrong, before anything is rendered.

    Raises:
        ConfigurationError: The ending is none of `FORMATS`, its folder does not exist, or the size is not even.
        MissingDependencyError: What writes such videos is not installed.
    """
    if path.suffix.lower() not in FORMATS:
        raise ConfigurationError(f"a video cannot be a {path.suffix or 'file without ending'!r}: {', '.join(FORMATS)}")
    if not path.parent.is_dir():
        raise ConfigurationError(f"there is no folder {str(path.parent)!r} to put {path.name!r} in")
    if path.is_dir():
        raise ConfigurationError(f"{str(path)!r} is a folder: name a file")
    gif, still = path.suffix.lower() == ".gif", path.suffix.lower() == ".png"
    if not (gif or still) and (width % 2 or height % 2):
        raise ConfigurationError(f"H.264 wants even sizes, not {width}x{height}")
    if gif and fps > 50:
        raise ConfigurationError(f"a GIF has at most 50 frames per second, not {fps:g}")
    try:
        import PIL  # noqa: F401

        if not (gif or still):
            import av  # noqa: F401
    except ImportError as error:
        raise MissingDependencyError(
            f"videos need {'Pillow' if gif or still else 'PyAV and Pillow'}: {INSTALL}"
        ) from error


@contextlib.contextmanager
def open_video(path: Path, width: int, height: int, fps: float) -> Iterator[VideoWriter]:
    """Begin a video; it is there, whole, when the block ends, and not at all when the block fails.

    Args:
        path: Its ending says what it becomes.
        width, height: In pixels.
        fps: Frames per second.

    Raises:
        AirHockeyError: The disk is full or gone.
    """
    part = path.with_name(f".{path.name}.part{path.suffix.lower()}")  # the next one replaces what a kill leaves
    try:
        with _new_writer(part, width, height, fps) as writer:
            yield writer
        part.replace(path)
    except OSError as error:
        raise AirHockeyError(f"cannot write {str(path)!r}: {' '.join(str(error).split())}") from error
    finally:
        part.unlink(missing_ok=True)


def _new_writer(path: Path, width: int, height: int, fps: float) -> "_Video | _Gif | _Still":
    if path.suffix == ".png":
        return _Still(path)
    return _Gif(path, fps) if path.suffix == ".gif" else _Video(path, width, height, fps)


class _Still:
    """The last picture alone."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def __enter__(self) -> "_Still":
        return self

    def __exit__(self, *_: object) -> None:
        """Nothing is left to do."""

    def add(self, picture: Picture) -> None:
        from PIL import Image

        Image.fromarray(np.ascontiguousarray(picture)).save(self._path, format="PNG", optimize=True)


class _Video:
    """H.264 in 4:2:0, which every browser plays."""

    def __init__(self, path: Path, width: int, height: int, fps: float) -> None:
        import av

        options = {"movflags": "faststart"} if path.suffix in (".mp4", ".mov") else {}
        self._container: Any = av.open(str(path), "w", options=options)
        self._stream: Any = self._container.add_stream("libx264", rate=Fraction(fps).limit_denominator(1001))
        self._stream.width, self._stream.height, self._stream.pix_fmt = width, height, "yuv420p"
        self._stream.options = {"crf": _QUALITY, "preset": "veryfast"}
        self._frame = av.VideoFrame

    def __enter__(self) -> "_Video":
        return self

    def __exit__(self, *_: object) -> None:
        try:
            for packet in self._stream.encode(None):
                self._container.mux(packet)
        finally:
            self._container.close()

    def add(self, picture: Picture) -> None:
        frame = self._frame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")
        for packet in self._stream.encode(frame):
            self._container.mux(packet)


class _Gif:
    """Frames with one palette for all, so that what stands still compresses to nothing."""

    def __init__(self, path: Path, fps: float) -> None:
        self._path, self._duration = path, 1000.0 / fps
        self._frames: list[Any] = []
        self._palette: Any = None

    def __enter__(self) -> "_Gif":
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if kind is None and self._frames:
            first, *others = self._frames
            # A GIF counts in hundredths of a second: round the times, not the durations, or long videos drift.
            ends = [round(self._duration * (k + 1) / 10.0) * 10 for k in range(len(self._frames))]
            durations = [end - begin for begin, end in zip([0, *ends], ends, strict=False)]
            first.save(
                self._path, format="GIF", save_all=True, append_images=others, duration=durations, loop=0, disposal=1
            )

    def add(self, picture: Picture) -> None:
        from PIL import Image

        image = Image.fromarray(np.ascontiguousarray(picture))
        if self._palette is None:
            self._palette = _with_swatches(picture).quantize(_PALETTE, method=Image.Quantize.MEDIANCUT)
        self._frames.append(image.quantize(palette=self._palette, dither=Image.Dither.NONE))


def _with_swatches(picture: Picture) -> Any:
    """The picture with stripes below it in the colours of what is small in it, which the palette must not lose."""
    from PIL import Image

    from airhockey.envs import appearance
    from airhockey.viewing import overlay

    height, width, _ = picture.shape
    scene = (appearance.PUCK, appearance.JOINT_RING, appearance.LINE, *(appearance.player_color(k) for k in (1, 2)))
    colors = [tuple(round(255 * part) for part in color[:3]) for color in scene]
    colors += [overlay.NEWS, overlay.ALARM, *overlay.PLAYERS]
    stripes = [np.full((max(1, round(_SWATCH * height)), width, 3), color, dtype=np.uint8) for color in colors]
    return Image.fromarray(np.concatenate([picture, *stripes]))

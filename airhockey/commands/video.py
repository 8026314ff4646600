"""`hockey video`: films of recorded episodes and games."""

import re
from pathlib import Path
from typing import Any

import rich_click as click

from airhockey.commands import _options as common


def _size(ctx: Any, param: Any, value: str) -> tuple[int, int]:
    """Read WIDTHxHEIGHT, 16 to 4096 pixels each way."""
    match = re.fullmatch(r"(\d+)x(\d+)", value)
    if match is None or not all(16 <= int(side) <= 4096 for side in match.groups()):
        raise click.BadParameter(f"{value!r} is no size: give WIDTHxHEIGHT, each from 16 to 4096, like 960x540")
    return int(match[1]), int(match[2])


@click.command()
@click.argument("run", metavar="RUN", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--out",
    metavar="FILE",
    type=click.Path(path_type=Path),
    required=True,
    help="The film: .mp4, .mkv, .mov or .gif; or .png.",
)
@click.option("--episodes", metavar="K,…", help="Only these episodes or games, one after the other.  [default: all]")
@click.option("--failed", is_flag=True, help="Only episodes that went wrong.")
@click.option("--highlights", is_flag=True, help="Only goals, saves, faults and violations, with what led to them.")
@click.option("--seconds", type=click.FloatRange(min=0.02), help="Only so much of each, from its start.")
@click.option("--at", type=click.FloatRange(min=0), metavar="SECONDS", help="Only this moment, as a .png.")
@click.option("--fps", type=click.FloatRange(1, 100), default=25, show_default=True, help="Frames per second.")
@click.option("--speed", type=click.FloatRange(0.02, 50), default=1, show_default=True, help="Times as fast as it was.")
@click.option(
    "--size", metavar="WIDTHxHEIGHT", callback=_size, default="960x540", show_default=True, help="Of the picture."
)
@click.option("--no-inset", is_flag=True, help="Without the view from above.")
@click.option(
    "--quality",
    type=click.Choice(["fast", "good", "fine"]),
    default="good",
    show_default=True,
    help="fast: no shadows; fine: smooth edges.",
)
@common.options(common.quiet)
@click.pass_context
def video(ctx: click.RichContext, /, **given: Any) -> None:
    """Make a film of RUN: the folder of a run, match or tournament, or an official dataset.pkl.

    The scene is rendered off-screen: no display is needed, but Mesa or a graphics driver is. Score, time and violations
    are written over the picture. Needs the extra video: pip install 'airhockey[video]'.

    \b
    hockey video runs/7dof-hit-planner-s0 -o hit.mp4 --episodes 0,3,7
    hockey video runs/7dof-hit-planner-s0 -o failed.mp4 --failed
    hockey video runs/match-planner-thesis-s0 -o best.mp4 --highlights
    hockey video runs/match-planner-thesis-s0 -o still.png --at 12.5 --quality fine
    hockey video runs/7dof-prepare-planner-s0 -o prepare.gif --episodes 2 --size 480x270 --fps 20
    """
    still = given["out"].suffix.lower() == ".png"
    if still != (given["at"] is not None):
        raise click.UsageError("a picture is of one moment, and a moment is a picture: -o FILE.png with --at SECONDS")
    if still and given["episodes"] is None:  # the first of all
        given["episodes"] = "0"
    from airhockey.commands._progress import of_frames
    from airhockey.commands._session import INTERRUPTED, MOST_NOTES, say_notes
    from airhockey.viewing.library import open_library
    from airhockey.viewing.video import VideoOptions, write_video
    from airhockey.viewing.video_writer import check_video

    out, (width, height) = given["out"], given["size"]
    own = {name: given[name] for name in ("fps", "speed", "highlights", "quality", "seconds", "at")}
    options = VideoOptions(width=width, height=height, inset=not given["no_inset"], **own)
    check_video(out, width, height, options.fps)
    library = open_library(given["run"])
    entries = library.choose(given["episodes"], given["failed"])
    say_notes(library.notes, MOST_NOTES)
    try:
        with of_frames(given["quiet"]) as on_frame:
            frames = write_video(out, entries, options, on_frame)
    except KeyboardInterrupt:
        click.echo("hockey: interrupted; nothing was written", err=True)
        ctx.exit(INTERRUPTED)
    length = "1 frame" if options.at is not None else f"{frames} frames, {frames / options.fps:.1f} s"
    click.echo(f"{out}: {length}, {out.stat().st_size / 1e6:.2f} MB")

"""`hockey identify`: what disturbed recorded observations, as a profile."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import rich_click as click

from airhockey.commands import HELP_PAGE

if TYPE_CHECKING:
    from airhockey.evaluator.analysis.identification import Finding, Seen

UNITS = {
    "puck.position": "[m]", "puck.yaw": "[rad]", "puck.velocity": "[m/s]", "puck.yaw_rate": "[rad/s]", "joints.position": "[rad]",
    "joints.velocity": "[rad/s]", "joints.position_bias": "[rad] per episode", "opponent.position": "[m]", "delay": "[steps]",
    "track_loss.probability": "per step that a loss begins", "track_loss.length": "[steps]", "track_loss.shows": "",
}  # fmt: skip
UNSEEN = ("puck.position_bias", "torque", "mismatch")
"""What observations alone do not tell."""


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.argument("recording", metavar="RECORDING", type=click.Path(path_type=Path))
@click.option("--env", metavar="NAME", help="Of a run with several.  [default: all that the first one's robot plays]")
@click.option("--name", metavar="NAME", default="identified", show_default=True, help="Of the profile.")
@click.option(
    "--out", "-o", metavar="FILE", type=click.Path(path_type=Path), help="Write it there, and not on the screen."
)
def identify(recording: Path, env: str | None, name: str, out: Path | None) -> None:
    """Read noise, bias, lost tracks and delay off RECORDING, and write them as a disturbance profile.

    RECORDING is the folder of a run, or the `dataset.pkl` that an official evaluation left. Every number comes with its
    standard error and with what it was read off. Some tens of episodes say enough, and more where an agent moves the arm.

    For example:

    \b
    hockey identify downloads/7dof-hit/dataset.pkl -o cloud.yaml
    hockey evaluate --task hit --disturbances cloud.yaml
    hockey identify runs/7dof-hit-planner-s0 --name mine
    """
    from airhockey.envs.editions import ROBOTS, edition
    from airhockey.evaluator.analysis.identification import identify as identified
    from airhockey.evaluator.runs.disk import disk_errors, replace_file

    envs, year, episodes = _of_dataset(recording) if recording.is_file() else _of_run(recording, env)
    robot = ROBOTS[edition(year).environment(envs[0]).robot]
    text = _written(identified(episodes, robot.start), name, f"{len(episodes)} episodes of {', '.join(envs)}")
    if out is None:
        click.echo(text, nl=False)
        return
    with disk_errors(out):
        replace_file(out, text.encode())
    click.echo(f"written to {out}")


def _of_dataset(file: Path) -> "tuple[list[str], str, list[Seen]]":
    import numpy as np

    from airhockey.evaluator.analysis.identification import Seen
    from airhockey.viewing.library_official import GAME, open_dataset

    env, year, episodes = open_dataset(file)
    if env == GAME:  # both players' in a row
        episodes = [half for seen in episodes for half in np.split(seen, 2, axis=1)]
    return [env], year, [Seen(seen) for seen in episodes]


def _of_run(folder: Path, env: str | None) -> "tuple[list[str], str, list[Seen]]":
    from airhockey.commands._session import MOST_NOTES, say_notes
    from airhockey.errors import ConfigurationError, unknown
    from airhockey.evaluator.analysis.identification import Seen
    from airhockey.evaluator.runs.reader import Run, open_source
    from airhockey.exporting.demonstrations import of_run

    run = open_source(folder)
    if not isinstance(run, Run):
        raise ConfigurationError(
            f"there are no episodes in {str(folder)!r}: {'; '.join(run.notes) or 'it holds games'}"
        )
    say_notes(run.notes, MOST_NOTES)
    if env is not None and env not in run.environments:
        raise unknown("environment of this run", env, tuple(run.environments))
    envs = [one for one in run.environments if one == env or (env is None and one[0] == run.environments[0][0])]
    played = [of_run(run, one) for one in envs]
    found = [Seen(seen.observations, of.set_points(seen.actions)[:, 0]) for of in played for seen in of]
    return envs, run.edition, found


def _written(found: "dict[str, Finding]", name: str, source: str) -> str:
    """The profile as YAML, with a comment to each number."""
    lines = [
        f"# Read off {source}. Standard errors are those of ten parts of the data.",
        f"profile: {json.dumps(name)}",
        "version: 1",
    ]
    part = ""
    for key, finding in found.items():
        section, _, field = key.rpartition(".")
        if finding.value is None:
            lines.append(f"# {key}: not known ({finding.basis})")
            continue
        if section != part and section:
            lines.append(f"{section}:")
        part = section
        error = f" ± {finding.spread:.2g}" if finding.spread is not None else ""
        comment = " ".join(f"{UNITS[key]}{error}; {finding.basis}".split())
        lines.append(f"{'  ' if section else ''}{field}: {_yaml(finding.value)}  # {comment.removeprefix('; ')}")
    lines += [f"# {key}: observations alone do not tell it" for key in UNSEEN]
    return "\n".join(lines) + "\n"


def _yaml(value: Any) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(str, value))}]"
    return f"{value:.3g}" if isinstance(value, float) else str(value)

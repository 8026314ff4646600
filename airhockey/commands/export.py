"""`hockey export`: recorded runs and games in the formats of others."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import rich_click as click

from airhockey.commands import HELP_PAGE
from airhockey.commands import _options as common

if TYPE_CHECKING:
    from airhockey.evaluator.runs.reader import Games, Run
    from airhockey.exporting.demonstrations import Demonstrations

TABLES = ("csv", "parquet")
TRAJECTORIES = {"csv-joints": "csv", "ros2": "json"}


@click.command()
@click.rich_config(help_config=HELP_PAGE)
@click.argument("run", metavar="RUN", type=click.Path(path_type=Path))
@click.option(
    "--format",
    "form",
    type=click.Choice(["csv", "parquet", "minari", "lerobot", *TRAJECTORIES]),
    required=True,
    help="csv, parquet: a row per episode or game; minari, lerobot: a data set to learn from; csv-joints, ros2: joint "
    "trajectories for an arm.",
)
@click.option(
    "-o",
    "--out",
    metavar="PATH",
    type=click.Path(path_type=Path),
    help="The file, or the folder of several.  [default: named after RUN; of minari, where Minari has its data sets]",
)
@click.option("--env", metavar="NAME", help="Episodes of this environment, where RUN has several.")
@click.option("--side", type=click.Choice(["home", "away"]), default="home", show_default=True, help="Of games: whose.")
@click.option(
    "--episodes", metavar="K,…", help="Only these: 3,17 of a run; 0 or 0/home/2 (game, side, serve) of a match."
)
@click.option("--name", metavar="ID", help="Of a Minari data set.  [default: as in airhockey/7dof-hit/planner-v0]")
@common.options(common.quiet)
def export(run: Path, **given: Any) -> None:
    """Write RUN, the folder of a run, match or tournament, in a format that other programs read.

    Data sets hold what the agent saw and what it commanded at every control step; a game, of which positions are kept and no
    commands, holds where the joints were a step later. minari, lerobot and parquet need an extra: pip install
    'airhockey[export]'.

    For example:

    \b
    hockey export runs/7dof-hit-planner-s0 --format parquet -o hit.parquet
    hockey export runs/7dof-hit-planner-s0 --format minari
    hockey export runs/7dof-hit-planner-s0 --format lerobot -o hit-lerobot
    hockey export runs/match-planner-thesis-s0 --format csv-joints --side away --episodes 0
    hockey export runs/7dof-hit-planner-s0 --format ros2 --episodes 3 -o arm
    """
    from airhockey.commands._session import MOST_NOTES, say_notes
    from airhockey.errors import ConfigurationError
    from airhockey.evaluator.runs.reader import Unreadable, open_source

    source = open_source(run)
    if isinstance(source, Unreadable):
        raise ConfigurationError(f"there is nothing to export in {str(run)!r}: {'; '.join(source.notes)}")
    say_notes(source.notes, MOST_NOTES)
    _check_options(given)
    said = (
        _table(source, given) if given["form"] in TABLES else _episodes(_demonstrations(source, given), source, given)
    )
    if not given["quiet"]:
        click.echo(said)


def _check_options(given: dict[str, Any]) -> None:
    if given["name"] is not None and given["form"] != "minari":
        raise click.UsageError(
            f"--name is the id of a Minari data set; with --format {given['form']} name the place with -o"
        )
    if given["form"] in TABLES and given["episodes"] is not None:
        raise click.UsageError(f"--format {given['form']} has a row for every episode: leave out --episodes")


def _table(source: "Run | Games[Any]", given: dict[str, Any]) -> str:
    from airhockey.evaluator.runs.disk import disk_errors, replace_file
    from airhockey.exporting import tables

    rows = tables.rows_of(source)
    path = given["out"] or Path(f"{_name(source)}.{given['form']}")
    content = tables.as_csv(rows).encode() if given["form"] == "csv" else tables.as_parquet(rows)
    with disk_errors(path):
        replace_file(path, content)
    return f"wrote {path} ({len(rows)} rows)"


def _demonstrations(source: "Run | Games[Any]", given: dict[str, Any]) -> "Demonstrations":
    from airhockey.evaluator.runs.reader import Run
    from airhockey.exporting.demonstrations import of_games, of_run

    found = of_run(source, given["env"]) if isinstance(source, Run) else of_games(source, given["side"])
    return found.chosen(given["episodes"])


def _episodes(found: "Demonstrations", source: "Run | Games[Any]", given: dict[str, Any]) -> str:
    from airhockey.commands._progress import of_files
    from airhockey.evaluator.runs.disk import disk_errors

    form, out = given["form"], given["out"]
    folder = out or Path(f"{_name(source)}-{form}")
    with of_files("exporting", len(found), given["quiet"]) as on_episode, disk_errors(folder):
        if form == "minari":
            from airhockey.exporting.minari import FOLDER, dataset_id, write_minari

            name = given["name"] or dataset_id(found)
            path = write_minari(found, name, out, on_episode)
            there = "" if out is None else f"{FOLDER}={out.resolve()} "
            load = f'{there}python -c "import minari; print(minari.load_dataset({name!r}))"'
            return f"wrote {path} ({len(found)} episodes); load it with:\n  {load}"
        if form == "lerobot":
            from airhockey.exporting.lerobot import write_lerobot

            write_lerobot(found, folder, on_episode)
            return f"wrote {folder} ({len(found)} episodes); load it with: LeRobotDataset({folder.name!r}, root={str(folder)!r})"
        return _trajectories(found, folder, TRAJECTORIES[form], on_episode)


def _trajectories(found: "Demonstrations", folder: Path, suffix: str, on_episode: Any) -> str:
    from airhockey.evaluator.runs.disk import replace_file
    from airhockey.exporting.joint_trajectory import as_csv, as_ros2, trajectory_of

    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{name.replace('/', '-')}.{suffix}" for name in found.names]
    for path, demonstration in zip(paths, found, strict=True):
        trajectory = trajectory_of(found, demonstration)
        replace_file(path, (as_csv if suffix == "csv" else as_ros2)(trajectory).encode())
        on_episode()
    what = f"{len(paths)} trajectories of {found.meaning}"
    return f"wrote {folder} ({what}); check them with: hockey check-trajectory {paths[0]}"


def _name(source: "Run | Games[Any]") -> str:
    return source.path.resolve().name

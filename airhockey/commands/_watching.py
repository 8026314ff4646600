"""What `hockey watch` and `hockey replay` do once their options are read."""

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import click
import rich_click

from airhockey.errors import ConfigurationError

VIEWER_OPTIONS = (
    rich_click.option(
        "--host", default="127.0.0.1", show_default=True, help="Address to listen on; there is no password."
    ),
    rich_click.option(
        "--port",
        type=click.IntRange(0, 65535),
        default=0,
        help="Port to listen on.  [default: the first free one from 8080]",
    ),
    rich_click.option("--no-browser", is_flag=True, help="Only print the address."),
    rich_click.option("--window", is_flag=True, help="In a window of its own instead of the browser."),
)


def viewer_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options of the viewer to a command."""
    for option in reversed(VIEWER_OPTIONS):
        command = option(command)
    return command


def run_replay(given: Mapping[str, Any]) -> int:
    """Show recordings; gives the exit status."""
    from airhockey.commands._filming import say_what_is_missing
    from airhockey.viewing.library import open_library
    from airhockey.viewing.playback import RecordedShow

    library = open_library(given["run"])
    first = library.position(given["episode"]) if given["episode"] is not None else 0
    say_what_is_missing(library)
    return _watch(RecordedShow(library.entries, first), given)


def run_watch(given: Mapping[str, Any]) -> int:
    """Show a live task or game; gives the exit status."""
    from airhockey.evaluator.engines.workers import ONE_THREAD

    os.environ.update(ONE_THREAD)  # before NumPy is imported: the players are single-threaded
    from airhockey.viewing.playback import Show

    show: Show = _game(given) if given["away"] is not None else _task(given)
    return _watch(show, given)


def _watch(show: Any, given: Mapping[str, Any]) -> int:
    from airhockey.viewing.viewer import watch

    def say(line: str) -> None:
        click.echo(line)

    try:
        watch(show, given["host"], given["port"], given["window"], not given["no_browser"] and _has_display(), say)
    except KeyboardInterrupt:
        click.echo("", err=True)
    finally:
        show.close()
    return 0


def _has_display() -> bool:
    return (
        os.name != "posix"
        or os.uname().sysname == "Darwin"
        or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
    )


def _task(given: Mapping[str, Any]) -> Any:
    from airhockey.commands._isolation import isolation_of, say_what_is_not_protected
    from airhockey.evaluator.checks import check_options
    from airhockey.evaluator.runs.records import Options
    from airhockey.viewing.live import LiveTask

    agent = _agent(given["agent"])
    options = Options(
        environments=(given["env"] or f"{given['robot']}-{given['task']}",),
        agent=agent,
        episodes=max(given["episode"] + 1, 1),
        seed=given["seed"],
        disturbances=_disturbances(given["disturbances"]),
        isolate=isolation_of(agent, given["isolate"]),
        patience=given["patience"],
    )
    check_options(options)
    say_what_is_not_protected((agent,), given["isolate"])
    return LiveTask(options, given["episode"])


def _game(given: Mapping[str, Any]) -> Any:
    from airhockey.commands._isolation import say_what_is_not_protected
    from airhockey.evaluator.checks import check_agent, check_game_options
    from airhockey.evaluator.runs.game_records import GameOptions
    from airhockey.viewing.live import LiveGame

    if given["env"] is not None:
        raise ConfigurationError("two players play a game: leave out --env, or the second player")
    home, away = _agent(given["agent"]), _agent(given["away"])
    options = GameOptions(
        steps=given["steps"],
        disturbances=_disturbances(given["disturbances"]),
        isolate=given["isolate"] or "auto",
        patience=given["patience"],
    )
    check_game_options(options)
    for agent in (home, away):
        check_agent(agent, ("tournament",))
    say_what_is_not_protected((home, away), given["isolate"])
    return LiveGame(home, away, options, given["seed"], given["episode"])


def _agent(given: str) -> str:
    from airhockey.agents import AGENTS

    path = Path(given).expanduser()
    return given if given in AGENTS or not path.exists() else str(path.resolve())


def _disturbances(given: str) -> str:
    from airhockey.envs.disturbances import available

    path = Path(given).expanduser()
    return given if given in available() or not path.exists() else str(path.resolve())

"""`hockey evaluate` of several agents, disturbances or seeds: one run of runs, one table."""

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from airhockey.evaluator import Options
    from airhockey.evaluator.evaluation import OnEpisode
    from airhockey.evaluator.runs.episode_folder import EpisodeFolder
    from airhockey.evaluator.sweep import SweepFolder, SweepResult

Given = dict[str, Any]
CERTAIN = 0.05
"""Below it, a difference is marked."""


def asked_for(given: Given) -> bool:
    """Whether several of anything are to be played, or what is to go on is a sweep."""
    from airhockey.evaluator.runs.manifest import SWEEP

    several = len(given["agent"]) > 1 or len(given["disturbances"]) > 1 or given["seeds"] > 1
    return (Path(given["out"]) / SWEEP).exists() if given["resume"] else several


def alone(given: Given) -> Given:
    """The options of a single run."""
    return given | {"agent": next(iter(given["agent"]), None), "disturbances": given["disturbances"][0]}


def run(given: Given, typed: set[str], options_of: Callable[[Given], "Options"]) -> int:
    """Play a sweep; gives the exit status.

    Args:
        given: Every option's value by its name.
        typed: Names of those that the user typed.
        options_of: Makes a run's options.
    """
    from airhockey.commands._session import AGENT_FAILED, Session
    from airhockey.evaluator.sweep import begin_sweep, resume_sweep, sweep

    if given["official_dataset"]:
        raise click.UsageError("--official-dataset is of one run: name one agent, one --disturbances and one seed")
    named = {
        "agent": "agents",
        "disturbances": "profiles",
        "task": "environments",
        "robot": "environments",
        "env": "environments",
    }
    session = Session("evaluate", given, {named.get(name, name) for name in typed})
    options = _options(given, options_of)
    engine = session.engine()
    folder = session.open(options, _name(options), begin_sweep, resume_sweep, options.agents)
    whole = f"{len(folder.manifest.options.runs)} runs"

    def play(_: None) -> "SweepResult":
        return sweep(folder, lambda head, run: _progress(head, run, session.quiet), engine)

    def show(result: "SweepResult") -> int:
        session.print(folder, result, lambda: _print(result, folder))
        return AGENT_FAILED if any(cell.agent_errors for cell in result.cells) else 0

    return session.run(folder, whole, contextlib.nullcontext(), play, show)


def _options(given: Given, options_of: Callable[[Given], "Options"]) -> Any:
    import msgspec

    from airhockey.evaluator.sweep import SweepOptions

    agents = given["agent"] or (None,)
    bases = [
        options_of(given | {"agent": agent, "disturbances": profile})
        for agent in agents
        for profile in given["disturbances"]
    ]
    return SweepOptions(
        agents=tuple(base.agent for base in bases[:: len(given["disturbances"])]),
        profiles=tuple(base.disturbances for base in bases[: len(given["disturbances"])]),
        seeds=given["seeds"],
        runs=tuple(msgspec.structs.replace(base, seed=base.seed + k) for base in bases for k in range(given["seeds"])),
    )


def _name(options: Any) -> str:
    first = options.runs[0]
    what = first.environments[0] if len(first.environments) == 1 else f"{len(first.environments)}-tasks"
    return f"sweep-{what}-s{first.seed}"


@contextlib.contextmanager
def _progress(head: str, run: "EpisodeFolder", quiet: bool) -> "Iterator[OnEpisode | None]":
    from airhockey.commands import _progress as progress

    if not quiet:
        click.echo(head, err=True)
    with progress.of_episodes(run.manifest.options, run.records, quiet) as shown:
        yield shown


def _print(result: "SweepResult", folder: "SweepFolder") -> None:
    from rich.table import Table

    from airhockey.commands._tables import output
    from airhockey.evaluator.runs.reader import short_name
    from airhockey.inputs.names import markup

    console = output()
    cells = Table(
        "agent", "task", "disturbances", "seeds", "episodes", "success", "95 % interval", "± seeds", "penalty", "class"
    )
    for cell in result.cells:
        spread = "–" if cell.spread is None else f"{100 * cell.spread:.1f}"
        cells.add_row(
            markup(short_name(cell.agent)), cell.env, markup(Path(cell.disturbances).stem), str(cell.seeds), str(cell.episodes),
            f"{cell.success:.1%}", f"{cell.low:.1%} – {cell.high:.1%}", spread, f"{cell.penalty:g}", cell.deployability,
        )  # fmt: skip
    console.print(cells)
    if result.comparisons:
        pairs = Table(
            "",
            "task",
            "disturbances",
            "difference [points]",
            "95 % interval",
            "only first : only second",
            "p",
            "p (Holm)",
        )
        for one in result.comparisons:
            pairs.add_row(
                markup(f"{short_name(one.first)} – {short_name(one.second)}"), one.env, markup(Path(one.disturbances).stem),
                f"{100 * one.difference:+.1f}", f"{100 * one.low:+.1f} … {100 * one.high:+.1f}",
                f"{one.only_first} : {one.only_second}", f"{one.p_value:.2g}",
                f"{one.adjusted:.2g}{' *' if one.adjusted < CERTAIN else ''}",
            )  # fmt: skip
        console.print(pairs)
        console.print(
            f"on the same episodes; exact McNemar tests, adjusted for {len(result.comparisons)} by Holm; * below {CERTAIN}"
        )
    console.print(f"stored in {folder.path}; every run: hockey report {folder.path}", markup=False, soft_wrap=True)

"""The figures of README and documentation: measured by commands, kept as files, and written where they are shown.

    python scripts/figures.py measure                       # every figure (hours); or only some:
    python scripts/figures.py measure tasks-2023 --episodes 200
    python scripts/figures.py write                         # put what the files say between the marks in the pages
    python scripts/figures.py list

A figure NAME is the file docs/figures/NAME.json: the commands, what they printed, when, on what machine, with which versions.
A page shows it between `<!-- figure NAME -->` and `<!-- end -->`. A test compares pages and files.
"""

import argparse
import datetime
import json
import os
import platform
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from airhockey import envs
from airhockey.evaluator.judging.tasks import wilson_interval

ROOT = Path(__file__).resolve().parent.parent
FILES = ROOT / "docs" / "figures"
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
MARK = re.compile(r"(?P<begin><!-- figure (?P<name>[\w-]+) -->\n).*?(?P<end><!-- end -->)", re.DOTALL)
SEED = 20261
"""Of the evaluations: no player was tuned on it."""
TASKS = {
    "2023": ("3dof-hit", "3dof-defend", "7dof-hit", "7dof-defend", "7dof-prepare"),
    "2025": ("hit", "hit_single", "defend", "prepare"),
}
PLAYERS = ("planner", "thesis")
PROFILES = ("ideal", "server")
Printed = dict[str, Any]


def evaluations(edition: str, episodes: int) -> list[str]:
    """A command for every player, profile and task."""
    return [
        f"hockey evaluate --agent {player} --env {task} --disturbances {profile} --edition {edition} "
        f"--episodes {episodes} --seed {SEED} --json"
        for player in PLAYERS
        for profile in PROFILES
        for task in TASKS[edition]
    ]


def matches(episodes: int) -> list[str]:
    """Whole games of our players."""
    return [
        f"hockey match planner thesis --games 4 --seed {SEED} --disturbances {profile} --json" for profile in PROFILES
    ]


FIGURES: dict[str, Callable[[int], list[str]]] = {
    "tasks-2023": lambda episodes: evaluations("2023", episodes),
    "tasks-2025": lambda episodes: evaluations("2025", episodes),
    "games": matches,
    "step-rate": lambda _: ["python benchmarks/step_rate.py"],
    "match-rate": lambda _: ["python benchmarks/match_rate.py"],
    "isolation": lambda _: ["python benchmarks/isolation.py"],
    "copy-rate": lambda _: ["python benchmarks/copy_rate.py"],
    "learned": lambda episodes: [
        f"hockey evaluate --agent {player} --env 7dof-defend --disturbances {profile} --episodes {episodes} --seed {SEED} --json"
        for player in ("learned", "hold")
        for profile in PROFILES
    ],
    "ten-lines": lambda _: [f"python benchmarks/ten_lines.py --seed {seed}" for seed in (0, 1)],
    "behaviour-cloning": lambda _: ["python benchmarks/behaviour_cloning.py"],
    "trajectory-size": lambda _: ["python benchmarks/trajectory_size.py"],
    "vector-rate": lambda _: ["python benchmarks/vector_rate.py"],
}
"""Name -> its commands, from the number of episodes of each."""


def measure(names: list[str], episodes: int) -> None:
    """Run the commands of some figures and keep what they print, figure by figure."""
    for name in names:
        commands = FIGURES[name](episodes)
        runs = []
        for number, command in enumerate(commands, start=1):
            print(f"{name} {number}/{len(commands)}: {command}", file=sys.stderr, flush=True)
            runs.append({"command": command, "printed": run(command)})
        FILES.mkdir(exist_ok=True)
        kept = {"measured": str(datetime.date.today()), "machine": machine(), "versions": envs.versions(), "runs": runs}
        file = FILES / f"{name}.json"
        file.with_suffix(".new").write_text(json.dumps(kept, indent=1) + "\n")
        file.with_suffix(".new").replace(file)


def run(command: str) -> Any:
    """What a command prints; parsed where it is JSON. Runs of `hockey` are left in a folder that goes away."""
    program, *words = shlex.split(command)
    with tempfile.TemporaryDirectory() as place:
        where = ROOT if program == "python" else Path(place)
        start = [sys.executable] if program == "python" else [sys.executable, "-m", "airhockey.cli"]
        done = subprocess.run([*start, *words], cwd=where, stdout=subprocess.PIPE, text=True, check=True)
    return json.loads(done.stdout) if "--json" in words else done.stdout


def machine() -> str:
    """What it was measured on."""
    model = re.search(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    return f"{len(os.sched_getaffinity(0))} cores of {model[1] if model else platform.machine()}"


def shown(name: str, kept: Printed) -> str:
    """A figure as Markdown."""
    runs = kept["runs"]
    first = runs[0]["printed"]
    if isinstance(first, str):
        body = "\n".join(f"```\n$ {one['command']}\n{one['printed'].rstrip()}\n```" for one in runs)
    elif "games" in first:
        body = match_table(runs)
    else:
        body = task_table(runs)
    told = ", ".join(f"{package} {version}" for package, version in kept["versions"].items())
    return f"{body}\n\nMeasured {kept['measured']} on {kept['machine']}; {told} (docs/figures/{name}.json).\n"


def task_table(runs: list[Printed]) -> str:
    """Success, penalty and time of every evaluation."""
    rows = [
        "| agent | disturbances | task | episodes | success (95 % interval) | penalty points | class "
        "| `draw_action` mean / p99 / max |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for result in (one["printed"] for one in runs):
        low, high = wilson_interval(round(result["success"] * result["episodes"]), result["episodes"])
        times = " / ".join(f"{1e3 * result['computation_time'][key]:.2f}" for key in ("mean", "p99", "max"))
        rows.append(
            f"| `{result['agent']}` | {result['disturbances']} | {result['env']} | {result['episodes']} "
            f"| {result['success']:.1%} ({low:.1%} – {high:.1%}) | {result['penalty']:g} | {result['deployability']} "
            f"| {times} ms |"
        )
    return "\n".join(rows)


def match_table(runs: list[Printed]) -> str:
    """Every game."""
    rows = [
        "| disturbances | game | score | goals | faults | penalty points | longest `draw_action` |",
        "|---|---|---|---|---|---|---|",
    ]
    for result in (one["printed"] for one in runs):
        for number, game in enumerate(result["games"]):
            pair = {
                key: " : ".join(f"{value:g}" for value in game[key]) for key in ("score", "goals", "faults", "penalty")
            }
            most = " / ".join(f"{1e3 * seconds:.1f}" for seconds in game["computation_time_max"])
            rows.append(
                f"| {result['disturbances']} | {result['home']} – {result['away']}, {number} | {pair['score']} | {pair['goals']} "
                f"| {pair['faults']} | {pair['penalty']} | {most} ms |"
            )
    return "\n".join(rows)


def page_with_figures(text: str) -> str:
    """A page with what the files say between its marks; a figure without a file stays as it is."""

    def replaced(mark: re.Match[str]) -> str:
        file = FILES / f"{mark['name']}.json"
        if not file.exists():
            return mark[0]
        return f"{mark['begin']}{shown(mark['name'], json.loads(file.read_text()))}{mark['end']}"

    return MARK.sub(replaced, text)


def write() -> None:
    """Write the figures into the pages."""
    for page in PAGES:
        before = page.read_text("utf-8")
        after = page_with_figures(before)
        if after != before:
            page.write_text(after, "utf-8")
            print(f"written: {page.relative_to(ROOT)}")


def main() -> None:
    """Measure, write or list."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("measure", "write", "list"))
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"figures; by default all: {', '.join(FIGURES)}")
    parser.add_argument("--episodes", type=int, default=1000, help="of each evaluation (default: 1000)")
    options = parser.parse_args()
    unknown = sorted(set(options.names) - set(FIGURES))
    if unknown:
        parser.error(f"unknown figure {', '.join(unknown)}; there are {', '.join(FIGURES)}")
    if options.what == "list":
        for name in FIGURES:
            print(f"{name:12}{'' if (FILES / f'{name}.json').exists() else '  not measured'}")
        return
    if options.what == "measure":
        measure(options.names or list(FIGURES), options.episodes)
    write()


if __name__ == "__main__":
    main()

"""`hockey doctor`: what works on this machine, and what to install for the rest."""

import importlib.metadata
import json
import os
import re
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import rich_click as click

from airhockey.inputs.packages import is_installed

EXTRAS = {
    "rl": "Gymnasium and PettingZoo, training by SAC",
    "mushroom": "the challenge's MushroomRL wrapper, and entries that import MushroomRL",
    "video": "films",
    "export": "data sets and tables for other programs",
    "learn": "training by PGPE and CMA-ES, plots",
    "cluster": "runs on a Dask cluster",
    "control": "Pinocchio, OSQP and DAQP as choices of the players",
}
"""Extra -> what it is for."""
_REQUIREMENT = re.compile(r"^(?P<name>[A-Za-z0-9_.-]+).*extra == ['\"](?P<extra>\w+)['\"]")


@dataclass(frozen=True, kw_only=True)
class Finding:
    """What was found out.

    Attributes:
        about: What was looked at.
        works: Whether it can be used; None where there is nothing to be usable.
        told: What was found.
        remedy: What to do where it does not work.
    """

    about: str
    works: bool | None
    told: str
    remedy: str = ""


@click.command()
@click.option("--json", "as_json", is_flag=True, help="Print the findings as JSON.")
@click.pass_context
def doctor(ctx: click.RichContext, /, as_json: bool) -> None:
    """Say what works on this machine, and what to install for the rest.

    \b
    hockey doctor
    hockey doctor --json | jq '.[] | select(.works == false)'

    The exit status is 0 where agents can be evaluated, whatever else is missing; 1 where they cannot.
    """
    findings = []
    for finding in examine():
        findings.append(finding)
        if not as_json:
            _print(finding)
    if as_json:
        click.echo(json.dumps([asdict(finding) for finding in findings], indent=2))
    if any(finding.works is False for finding in findings if finding.about == "simulation"):
        ctx.exit(1)


def examine() -> Iterator[Finding]:
    """One finding after the other: some take a second or two."""
    yield Finding(about="machine", works=None, told=_machine())
    yield Finding(about="versions", works=None, told=_versions())
    yield (simulation := _simulation())
    if simulation.works:
        yield _compiled()
    yield _rendering()
    yield _sandbox()
    for extra, purpose in EXTRAS.items():
        yield _extra(extra, purpose)


def _machine() -> str:
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return f"{len(os.sched_getaffinity(0))} cores for this process, {memory:.1f} GiB of memory, {sys.platform}"


def _versions() -> str:
    from airhockey import envs

    return ", ".join(f"{name} {version}" for name, version in envs.versions().items())


def _simulation() -> Finding:
    from airhockey import envs
    from airhockey.errors import AirHockeyError

    try:
        env = envs.make("3dof-hit")
        env.reset(seed=0)
    except AirHockeyError as error:
        return Finding(about="simulation", works=False, told=str(error))  # which names its remedy
    except Exception as error:  # whatever it is: this is what is asked
        remedy = "install the versions that the package asks for: pip install --force-reinstall airhockey"
        return Finding(about="simulation", works=False, told=f"{type(error).__name__}: {error}", remedy=remedy)
    return Finding(about="simulation", works=True, told="an environment was made and reset")


def _compiled() -> Finding:
    from airhockey.agents.compiling import CACHE
    from airhockey.envs.compiled import is_kept

    if not is_kept():
        remedy = "name a folder that can be written in XDG_CACHE_HOME"
        told = "no folder for it can be written: players are compiled anew in every run, which takes a minute"
        return Finding(about="compiled code", works=False, told=told, remedy=remedy)
    files = sum(1 for _ in Path(CACHE).rglob("*.nbc"))
    told = f"{files} functions of players are kept in {CACHE}"
    if not files:
        told = f"no player is compiled yet: the first game takes a minute longer; it is then kept in {CACHE}"
    return Finding(about="compiled code", works=True, told=told)


def _rendering() -> Finding:
    from airhockey.envs.rendering.offscreen import REMEDY, choose_backend
    from airhockey.errors import AirHockeyError

    try:
        return Finding(about="pictures and films", works=True, told=f"drawn off-screen by {choose_backend()}")
    except AirHockeyError as error:
        return Finding(about="pictures and films", works=False, told=str(error).partition(" (")[0], remedy=REMEDY)


def _sandbox() -> Finding:
    from airhockey.evaluator.isolation.sandbox import why_no_sandbox

    why = why_no_sandbox()
    if why is None:
        return Finding(about="sandbox", works=True, told="submissions can be played in a sandbox")
    remedy = "apt-get install bubblewrap" if "not installed" in why else "see the page on security for what it needs"
    return Finding(about="sandbox", works=False, told=why, remedy=f"{remedy}; until then play only code that you trust")


def _extra(extra: str, purpose: str) -> Finding:
    missing = [name for name in _packages(extra) if not is_installed(name)]
    about = f"extra {extra}"
    if not missing:
        return Finding(about=about, works=True, told=purpose)
    return Finding(
        about=about,
        works=False,
        told=f"{purpose}; not installed: {', '.join(missing)}",
        remedy=f"pip install 'airhockey[{extra}]'",
    )


def _packages(extra: str) -> list[str]:
    """Names of the packages of an extra, from the metadata of the installed package."""
    asked = (_REQUIREMENT.match(line) for line in importlib.metadata.requires("airhockey") or [])
    return [found["name"] for found in asked if found is not None and found["extra"] == extra]


def _print(finding: Finding) -> None:
    sign: Any = {True: click.style("works  ", fg="green"), False: click.style("missing", fg="yellow"), None: "       "}
    click.echo(f"{sign[finding.works]}  {finding.about:20}{finding.told}")
    if finding.remedy:
        click.echo(f"{'':29}→ {finding.remedy}")

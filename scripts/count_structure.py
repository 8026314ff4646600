"""Count what should stand once: manifests, run folders, journal readers, callers of agents; and what should not be at all.

python scripts/count_structure.py            the package beside this script
python scripts/count_structure.py --names    with the places
"""

import argparse
import ast
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "airhockey"
MOST_PARAMETERS = 6
PLAYING = ("evaluator", "viewing", "learning", "reporting", "commands")
"""Layers that play other people's agents; a player of ours that calls its own parts is no such caller."""
KINDS_OF_AGENTS = {"AgentHandle", "Apart", "LocalAgent", "IsolatedAgent", "RemoteAgent"}


@dataclass(frozen=True)
class Place:
    """A node of the syntax tree, and where it stands."""

    file: Path
    node: ast.AST

    @property
    def layer(self) -> str:
        """The first folder or module below the package."""
        return self.file.relative_to(PACKAGE).parts[0]

    def __str__(self) -> str:
        name = getattr(self.node, "name", "")
        return f"{self.file.relative_to(PACKAGE.parent)}:{getattr(self.node, 'lineno', 0)} {name}"


def nodes(package: Path) -> Iterator[Place]:
    """Every node of every module."""
    for file in sorted(package.rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            yield Place(file, node)


def is_manifest(place: Place) -> bool:
    """A class with fields for versions and the time of creation."""
    if not isinstance(place.node, ast.ClassDef):
        return False
    fields = {
        line.target.id
        for line in place.node.body
        if isinstance(line, ast.AnnAssign) and isinstance(line.target, ast.Name)
    }
    return {"versions", "created"} <= fields


def is_run_folder(place: Place) -> bool:
    """A class that locks a folder."""
    return isinstance(place.node, ast.ClassDef) and any(called(node) == "lock_folder" for node in ast.walk(place.node))


def is_journal_reader(place: Place) -> bool:
    """A function that decodes lines of JSON from a file's bytes."""
    if not isinstance(place.node, ast.FunctionDef):
        return False
    calls = {called(node) for node in ast.walk(place.node)}
    return {"splitlines", "decode"} <= calls and bool({"read_bytes", "read"} & calls)


def is_version_check(place: Place) -> bool:
    """A function that refuses to go on with other software than a run began with."""
    if not isinstance(place.node, ast.FunctionDef) or place.layer not in ("evaluator", "learning", "commands"):
        return False
    compares = any(
        isinstance(node, ast.Compare) and any(called(part) == "get" for part in ast.walk(node))
        for node in ast.walk(place.node)
    )
    return (
        compares
        and any(called(node) in ("versions", "items") for node in ast.walk(place.node))
        and "version" in ast.dump(place.node)
    )


def is_caller_of_draw_action(place: Place) -> bool:
    """A function that takes an agent's `draw_action`, to call it."""
    if not isinstance(place.node, ast.FunctionDef) or place.layer not in PLAYING:
        return False
    return any(isinstance(node, ast.Attribute) and node.attr == "draw_action" for node in ast.walk(place.node))


def asks_for_the_kind_of_an_agent(place: Place) -> bool:
    """`isinstance(agent, …)`."""
    node = place.node
    if not isinstance(node, ast.Call) or called(node) != "isinstance" or len(node.args) != 2:
        return False
    return any(isinstance(part, ast.Name) and part.id in KINDS_OF_AGENTS for part in ast.walk(node.args[1]))


def has_many_parameters(place: Place) -> bool:
    """A function with more than six parameters, `self` not counted."""
    if not isinstance(place.node, ast.FunctionDef):
        return False
    arguments = place.node.args
    names = [one.arg for one in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)]
    return len([name for name in names if name not in ("self", "cls")]) > MOST_PARAMETERS


def called(node: ast.AST) -> str | None:
    """The name that a call calls, without what it is an attribute of."""
    if not isinstance(node, ast.Call):
        return None
    function = node.func
    return function.id if isinstance(function, ast.Name) else getattr(function, "attr", None)


COUNTS: dict[str, Callable[[Place], bool]] = {
    "manifests": is_manifest,
    "run folders": is_run_folder,
    "journal readers": is_journal_reader,
    "version checks": is_version_check,
    "callers of draw_action": is_caller_of_draw_action,
    "isinstance on kinds of agents": asks_for_the_kind_of_an_agent,
    f"functions with more than {MOST_PARAMETERS} parameters": has_many_parameters,
}


def import_circles() -> list[str]:
    """Modules that import each other in a circle, a line for each circle's members."""
    import grimp

    graph = grimp.build_graph(PACKAGE.name)
    reached = {module: graph.find_downstream_modules(module) for module in graph.modules}
    circles = {
        frozenset({module, *(other for other in others if module in reached.get(other, set()))})
        for module, others in reached.items()
        if any(module in reached.get(other, set()) for other in others)
    }
    return sorted(", ".join(sorted(circle)) for circle in circles)


def main() -> None:
    """Print the counts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--names", action="store_true", help="print the places, too")
    names = parser.parse_args().names
    places = list(nodes(PACKAGE))
    for what, belongs in COUNTS.items():
        report(what, [str(place) for place in places if belongs(place)], names)
    report("import circles", import_circles(), names)
    lines = sum(len(file.read_text(encoding="utf-8").splitlines()) for file in PACKAGE.rglob("*.py"))
    sys.stdout.write(f"{lines:6}  lines of Python in the package\n")


def report(what: str, found: list[str], names: bool) -> None:
    """A line for a count, and where asked for one for each place."""
    sys.stdout.write(f"{len(found):6}  {what}\n")
    for place in found if names else ():
        sys.stdout.write(f"          {place}\n")


if __name__ == "__main__":
    main()

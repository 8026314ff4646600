"""A submission's own copy of `air_hockey_challenge`, as every fork of the challenge's repository has one.

Ours is used as long as it will do: it runs with the libraries of today, and is checked. The own copy serves what ours has not,
module by module; where its authors have extended what agents use (a method of `AgentBase`, a function or a parameter of the
kinematics, a constraint), it is used instead, wholly. Its files are read, not run, to find that out.
"""

import ast
from dataclasses import dataclass
from functools import cache
from pathlib import Path

_OURS = Path(__file__).parent / "air_hockey_challenge"
USED_BY_AGENTS = (
    "framework/agent_base.py",
    "utils/kinematics.py",
    "utils/transformations.py",
    "constraints/constraints.py",
)
_MAX_SOURCE = 1 << 20

Interface = dict[str, int]
"""Name of a public function, class or method -> number of its parameters."""


@dataclass(frozen=True)
class OwnCopy:
    """What of a submission's own copy is used.

    Attributes:
        folder: Where it lies.
        extended: What in it goes beyond ours, in code that agents use.
        additional: Modules that ours has not, as paths.
    """

    folder: Path
    extended: tuple[str, ...] = ()
    additional: tuple[str, ...] = ()

    @property
    def wins(self) -> bool:
        """Whether it is used instead of ours."""
        return bool(self.extended)

    def told(self) -> str | None:
        """One line for the verdict; None where ours serves for all."""
        if self.wins:
            return (
                "plays with its own copy of air_hockey_challenge, which extends what agents use: "
                f"{_some(self.extended)} (ours is left aside)"
            )
        if self.additional:
            return f"takes from its own copy of air_hockey_challenge what ours has not: {_some(self.additional)}"
        return None


def look_at(folder: Path | None) -> OwnCopy | None:
    """Compare a copy with ours; None where there is none."""
    if folder is None:
        return None
    extended = [
        f"{file.removesuffix('.py').replace('/', '.')}.{name}"
        for file in USED_BY_AGENTS
        for name in _beyond(_interface(folder / file), _own_interface(file))
    ]
    if not all((folder / file).is_file() for file in (*USED_BY_AGENTS[:2], "__init__.py")):
        extended = []  # a part of the package cannot stand for the whole
    return OwnCopy(folder, tuple(extended), tuple(_additional(folder)))


def _additional(folder: Path) -> list[str]:
    files = (path.relative_to(folder) for path in sorted(folder.rglob("*.py")))
    return [str(path) for path in files if not (_OURS / path).is_file() and "data" not in path.parts]


def _beyond(theirs: Interface, ours: Interface) -> list[str]:
    return [name for name, parameters in theirs.items() if parameters > ours.get(name, -1)]


@cache
def _own_interface(file: str) -> Interface:
    source = _OURS / file
    if file == "constraints/constraints.py":  # it re-exports the environment's
        from airhockey.envs import constraints

        source = Path(str(constraints.__file__))
    return _interface(source)


def _interface(file: Path) -> Interface:
    """The public names of a module, with the numbers of their parameters."""
    try:
        if file.stat().st_size > _MAX_SOURCE:
            return {}
        tree = ast.parse(file.read_text(encoding="utf-8"))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return {}
    found: Interface = {}
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            found[node.name] = _parameters(node)
    for name, definition in classes.items():
        if name.startswith("_"):
            continue
        found[name] = 0
        for method, parameters in _methods(definition, classes).items():
            found[f"{name}.{method}"] = parameters
    return found


def _methods(definition: ast.ClassDef, classes: dict[str, ast.ClassDef]) -> Interface:
    """Public methods of a class, those of its bases in the same module included."""
    found: Interface = {}
    for base in definition.bases:
        if isinstance(base, ast.Name) and base.id in classes and base.id != definition.name:
            found |= _methods(classes[base.id], classes)
    for node in definition.body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            found[node.name] = _parameters(node)
    return found


def _parameters(function: ast.FunctionDef) -> int:
    given = function.args
    return len(given.posonlyargs) + len(given.args) + len(given.kwonlyargs)


def _some(names: tuple[str, ...], count: int = 4) -> str:
    more = f" and {len(names) - count} more" if len(names) > count else ""
    return ", ".join(names[:count]) + more

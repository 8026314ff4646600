"""A submission's own copy of `air_hockey_challenge`, as every fork of the challenge's repository has one.

Its authors may have changed what a function does without changing how it is called, and nothing in the checkout says what it
was before. So what agents compute with (kinematics, transformations, constraints) is taken from the own copy whenever it is
there and can be imported here. The rest is ours as long as that will do: it runs with the libraries of today, and is checked.
The own copy serves what ours has not, module by module; where its authors have extended what agents derive from or call (a
method of `AgentBase`, a function or a parameter of the kinematics, a constraint), it is used instead, wholly. Its files are
read, not run, to find that out.
"""

import ast
import importlib.util
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path

NAME = "air_hockey_challenge"
_OURS = Path(__file__).parent / NAME
USED_BY_AGENTS = (
    "framework/agent_base.py",
    "utils/kinematics.py",
    "utils/transformations.py",
    "constraints/constraints.py",
)
COMPUTED_WITH: dict[str, tuple[str, ...]] = {
    "utils/kinematics.py": ("forward_kinematics", "inverse_kinematics", "jacobian"),
    "utils/transformations.py": ("robot_to_world", "world_to_robot"),
    "constraints/__init__.py": (),
    "constraints/constraints.py": ("Constraint", "ConstraintList"),
}
"""Modules that an own copy replaces one by one, and the names without which it cannot."""
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
        modules: Those that replace ours, as paths.
    """

    folder: Path
    extended: tuple[str, ...] = ()
    additional: tuple[str, ...] = ()
    modules: tuple[str, ...] = ()

    @property
    def init(self) -> Path | None:
        """Its `__init__.py`, where that does nothing: then what is asked where the package lies is told of the own copy."""
        tree = _parsed(self.folder / "__init__.py")
        harmless = tree is not None and all(isinstance(node, (ast.Expr, ast.Assign)) for node in tree.body)
        return self.folder / "__init__.py" if harmless else None

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
        told = []
        if self.modules:
            names = tuple(file for file in self.modules if not file.endswith("__init__.py"))
            told.append(f"computes with its own copy's {_some(names)}, whatever was changed in it")
        if self.additional:
            told.append(f"takes from its own copy of air_hockey_challenge what ours has not: {_some(self.additional)}")
        return "; ".join(told) or None


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
    return OwnCopy(folder, tuple(extended), tuple(_additional(folder)), tuple(_replacing(folder)))


def _replacing(folder: Path) -> list[str]:
    """The modules that replace ours; the constraints' two only together."""
    found = [file for file, names in COMPUTED_WITH.items() if _can_replace(folder, file, names)]
    constraints = [file for file in found if file.startswith("constraints/")]
    return found if len(constraints) != 1 else [file for file in found if file not in constraints]


def _can_replace(folder: Path, file: str, names: tuple[str, ...]) -> bool:
    """Whether a module has what others import from it, and imports only what is there."""
    tree = _parsed(folder / file)
    if tree is None or not set(names) <= _interface(folder / file).keys():
        return False
    for node in tree.body:
        imported = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        if isinstance(node, ast.ImportFrom):
            package = file.split("/")[0] if node.level == 1 else ""
            parts = (NAME, package, node.module or "") if node.level else (node.module or "",)
            imported = [".".join(part for part in parts if part)]
        if not all(_is_there(name, folder) for name in imported):
            return False
    return True


def _is_there(name: str, folder: Path) -> bool:
    """Whether a module can be found, without importing it."""
    top, *parts = name.split(".")
    if top == NAME:
        places = (root.joinpath(*parts) for root in (folder, _OURS))
        return any(place.with_suffix(".py").is_file() or place.is_dir() for place in places)
    return top in sys.modules or importlib.util.find_spec(top) is not None


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
    tree = _parsed(file)
    if tree is None:
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


def _parsed(file: Path) -> ast.Module | None:
    """A module's syntax; None where it is not there, too large, or no Python of today."""
    try:
        if file.stat().st_size > _MAX_SOURCE:
            return None
        return ast.parse(file.read_text(encoding="utf-8"))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return None


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

"""The edition that a submission was written for: its configuration names it, or its code does by what environments are called.

Names of environments that only one edition has decide: `7dof-hit` is of 2023, `hit` of 2025. Words such as "hit" stand in agents
of every year, so in code they count only where they are compared with the environment's name, or are the keys of a table from
which it chooses. Files are read, not run.
"""

import ast
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from airhockey.agents.packaging.checkout import Checkout, find_checkout
from airhockey.agents.packaging.metadata import read_metadata
from airhockey.agents.submission import submission_config
from airhockey.envs.editions import available, edition, edition_of_names
from airhockey.errors import ConfigurationError

_MAX_SOURCE = 1 << 20
_OWN_WRAPPER = "framework/air_hockey_challenge_wrapper.py"


def edition_of_entry(path: Path) -> str | None:
    """The edition that a submission was written for; None where nothing in it says so.

    Args:
        path: Folder or archive.
    """
    try:
        checkout = find_checkout(path.expanduser())
        return _named_in_files(checkout) or _named_in_code(checkout)
    except ConfigurationError:
        return None  # whoever builds it will say what is wrong


def _named_in_files(checkout: Checkout) -> str | None:
    """By `submission.yaml` or `agent_config.yml`."""
    metadata = read_metadata(checkout.package)
    if metadata is not None:
        return metadata.edition or edition_of_names(metadata.tasks)
    named = submission_config(checkout.package).get("env", ())
    return edition_of_names(map(str, named if isinstance(named, list) else [named]))


def _named_in_code(checkout: Checkout) -> str | None:
    """By its own copy of the challenge's wrapper, which has a table of all environments, or else by the agent's code."""
    own = checkout.own_challenge
    files = [] if own is None else [own / _OWN_WRAPPER]
    files += sorted(checkout.package.rglob("*.py"))
    for file in files:
        year = edition_of_names(_environments_in(file))
        if year is not None:
            return year
    return None


def _environments_in(file: Path) -> set[str]:
    """The names of environments in a file, as far as it is certain that they are meant as such."""
    try:
        if file.stat().st_size > _MAX_SOURCE:
            return set()
        tree = ast.parse(file.read_text(encoding="utf-8"))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return set()
    found = {name for name in _texts(ast.walk(tree)) if name in _unmistakable()}
    return found or set(_compared_with_the_name(tree))


@cache
def _unmistakable() -> frozenset[str]:
    """Names that mean an environment wherever they stand."""
    return frozenset(name for year in available() for name in edition(year).environments if "-" in name or "_" in name)


def _compared_with_the_name(tree: ast.AST) -> Iterator[str]:
    """Texts that are compared with, or looked up by, what is called `env_name` or the like."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare) and isinstance(node.ops[0], (ast.Eq, ast.NotEq, ast.In, ast.NotIn)):
            sides = [node.left, *node.comparators]
            if isinstance(node.ops[0], (ast.In, ast.NotIn)) and not _is_the_name(node.left):
                continue  # "hit" in env_name: true in every edition
            if any(map(_is_the_name, sides)):
                yield from _texts(part for side in sides for part in ast.walk(side) if not _is_the_name(side))
        elif isinstance(node, ast.Subscript) and isinstance(node.value, ast.Dict) and _is_the_name(node.slice):
            yield from _texts(key for key in node.value.keys if key is not None)
        elif isinstance(node, ast.Match) and _is_the_name(node.subject):
            yield from _texts(part for case in node.cases for part in ast.walk(case.pattern))


def _is_the_name(node: ast.AST) -> bool:
    """Whether an expression is the whole name of the environment: env_name, env_info["env_name"], self.env_info["env_name"]."""
    if isinstance(node, ast.Subscript):
        return isinstance(node.slice, ast.Constant) and node.slice.value == "env_name"
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "get":
        return bool(node.args) and isinstance(node.args[0], ast.Constant) and node.args[0].value == "env_name"
    name = node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""
    return name == "env_name"


def _texts(nodes: Iterable[ast.AST]) -> Iterator[str]:
    return (node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str))

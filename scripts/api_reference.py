"""Write the reference of the Python interface, a page of Markdown per topic, from the docstrings.

python scripts/api_reference.py docs/api

Nothing is imported: griffe reads the sources. What a page holds is chosen below; of a module, everything public that it defines.
"""

import argparse
import logging
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import griffe

ROOT = Path(__file__).resolve().parent.parent
PAGES: dict[str, tuple[str, str, tuple[str, ...]]] = {
    "environments": (
        "Environments",
        "airhockey.envs",
        ("", "environment", "disturbances", "editions", "actions", "info", "constraints", "gymnasium", "pettingzoo", "mushroom",
         "vector.environment", "vector.gymnasium", "vector.stable_baselines3"),
    ),
    "tasks": (
        "Tasks",
        "airhockey.envs.tasks",
        ("task", "start", "hit", "defend", "prepare", "game", "reward", "verdicts"),
    ),
    "agents": (
        "Agents",
        "airhockey.agents",
        ("", "base", "build", "hold", "control.kinematics", "control.inverse_kinematics", "control.aqp", "control.cartesian",
         "control.joint_controller", "control.joint_trajectory", "control.qp", "estimation.kalman", "estimation.prediction"),
    ),
    "evaluator": (
        "Evaluations, matches, tournaments",
        "airhockey.evaluator",
        ("", "evaluation", "sweep", "match", "tournament", "schedule", "official", "engines.engine", "judging.tasks",
         "judging.games", "judging.standings", "judging.statistics"),
    ),
    "results": (
        "Results",
        "airhockey.evaluator",
        ("runs.reader", "runs.records", "runs.game_records", "runs.manifest", "runs.trajectories", "runs.keeping",
         "runs.game_trajectories", "analysis.failures", "analysis.game", "analysis.shots"),
    ),
    "exporting": (
        "Exports",
        "airhockey.exporting",
        ("demonstrations", "tables", "minari", "lerobot", "joint_trajectory", "limit_checks"),
    ),
    "learning": (
        "Learners' environments",
        "airhockey.learning.envs",
        ("", "gymnasium", "game", "batch", "rewards"),
    ),
    "errors": ("Errors", "airhockey", ("errors",)),
}  # fmt: skip
"""File name -> title, package, and its modules; "" is the package itself."""
DEFINED = ("class", "function", "attribute")
HTML = re.compile(r"<(?=[a-zA-Z/])")


def main() -> None:
    """Write them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="folder to write into")
    folder: Path = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in pages().items():
        (folder / name).write_text(text, encoding="utf-8")


def pages() -> dict[str, str]:
    """File name -> page."""
    logging.getLogger("griffe").setLevel(logging.ERROR)  # our docstrings describe several arguments in one line
    package = griffe.load("airhockey", search_paths=[str(ROOT)], docstring_parser="google", resolve_aliases=False)
    return {f"{name}.md": "\n".join(page(package, *of)) for name, of in PAGES.items()}


def page(root: Any, title: str, package: str, modules: tuple[str, ...]) -> Iterator[str]:
    """The lines of a page."""
    yield f"# {title}\n"
    yield "Written from the docstrings by `scripts/api_reference.py`.\n"
    for name in modules:
        path = f"{package}.{name}".rstrip(".")
        module = root[path.removeprefix("airhockey.")] if path != "airhockey" else root
        yield f"\n## {path}\n"
        yield from described(module)
        for member in module.members.values():
            if is_shown(member):
                yield from entry(member)


def is_shown(member: Any) -> bool:
    """Whether it is public, defined here, and described."""
    if member.is_alias or member.name.startswith("_") or member.kind.value not in DEFINED:
        return False
    return member.docstring is not None


def entry(member: Any, level: int = 3) -> Iterator[str]:
    """A class, a function or a constant."""
    yield f"\n{'#' * level} {member.name}\n"
    yield fenced(declaration(member))
    yield from described(member)
    if member.kind.value == "class":
        for inner in member.members.values():
            if is_shown(inner) and inner.kind.value == "function":
                yield from entry(inner, level + 1)
            elif is_shown(inner):
                yield f"\n{'#' * (level + 1)} {inner.name}\n"
                yield from described(inner)


def declaration(member: Any) -> str:
    """As in the source, a parameter a line where one line is too short."""
    kind = member.kind.value
    if kind == "function":
        return signature(f"def {member.name}", member.parameters, member.returns)
    if kind == "class":
        bases = ", ".join(str(base) for base in member.bases)
        head = f"class {member.name}" + (f"({bases})" if bases else "")
        init = member.members.get("__init__")
        if init is None or init.is_alias:
            return head
        return f"{head}\n\n{signature(member.name, init.parameters, None)}"
    value = str(member.value) if member.value is not None else "…"
    annotation = f": {member.annotation}" if member.annotation is not None else ""
    return f"{member.name}{annotation} = {value if len(value) < 90 and chr(10) not in value else '…'}"


def signature(head: str, parameters: Any, returns: Any) -> str:
    """A call, in one line where that is short enough."""
    given: list[str] = []
    star = False
    for one in parameters:
        if one.name in ("self", "cls"):
            continue
        kind = one.kind.value if one.kind is not None else ""
        if kind == "keyword-only" and not star:
            given.append("*")
        star = star or kind in ("keyword-only", "variadic positional")
        prefix = {"variadic positional": "*", "variadic keyword": "**"}.get(kind, "")
        annotation = f": {one.annotation}" if one.annotation is not None else ""
        default = f" = {one.default}" if one.default is not None and not prefix else ""
        given.append(f"{prefix}{one.name}{annotation}{default}")
    tail = f" -> {returns}" if returns is not None else ""
    line = f"{head}({', '.join(given)}){tail}"
    if len(line) <= 90 or not given:
        return line
    return f"{head}(\n" + "".join(f"    {one},\n" for one in given) + f"){tail}"


def described(member: Any) -> Iterator[str]:
    """The docstring: prose, and a list for each of its sections."""
    if member.docstring is None:
        return
    for section in member.docstring.parsed:
        kind = section.kind.value
        if kind == "text":
            yield f"{prose(section.value)}\n"
        elif kind in ("parameters", "other parameters", "attributes", "raises", "returns", "yields"):
            yield f"**{kind.capitalize()}**\n"
            yield from items(section)
        else:
            yield f"{prose(str(section.value))}\n"


def items(section: Any) -> Iterator[str]:
    """What a section lists."""
    for one in section.value:
        text = " ".join(prose(one.description).split())
        name = getattr(one, "name", "") or (str(one.annotation) if section.kind.value == "raises" else "")
        name = f"{name} {one.annotation}" if name.endswith(",") else name  # "env, edition": two that share a line
        yield f"- `{name}`: {text}" if name else f"- {text}"
    yield ""


def prose(text: str) -> str:
    """Markdown of a docstring; what looks like HTML outside code is none."""
    parts = re.split(r"(`[^`\n]*`|^ {4}.*$)", text, flags=re.MULTILINE)
    parts[::2] = [HTML.sub("&lt;", part).replace("[", r"\[") for part in parts[::2]]
    return "".join(parts)


def fenced(text: str) -> str:
    """A code block."""
    return f"```python\n{text}\n```\n"


if __name__ == "__main__":
    main()

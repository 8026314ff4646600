"""Write the reference of the command line, a page of Markdown, from the commands themselves.

python scripts/command_reference.py docs/commands.md
"""

import argparse
import inspect
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from airhockey.cli import hockey

EXAMPLES = "\b\n"
"""Begins a paragraph that click does not wrap: in our help texts, a list of examples."""


BAR = r"\|"
"""What stands for | in a table's cell."""


def main() -> None:
    """Write it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page", type=Path, help="file to write")
    page: Path = parser.parse_args().page
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text("\n".join(reference()), encoding="utf-8")


def reference() -> Iterator[str]:
    """The lines of the whole page."""
    context = click.Context(hockey, info_name="hockey", help_option_names=["-h", "--help"])
    yield "# Command line\n"
    yield "Written from the commands' own help; `hockey COMMAND --help` says the same.\n"
    yield from help_text(hockey)
    commands = list(commands_of(hockey, context))
    yield from (f"- [`{child.command_path}`](#{child.command_path.replace(' ', '-')})" for child in commands)
    for child in commands:
        yield f"\n## {child.command_path}\n"
        yield from help_text(child.command)
        yield fenced(f"{child.command_path} {' '.join(child.command.collect_usage_pieces(child))}", "text")
        yield from options_table(child.command, child)


def commands_of(group: click.Group, context: click.Context) -> Iterator[click.Context]:
    """Every command, those of groups after their group."""
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        child = click.Context(command, info_name=name, parent=context)
        yield child
        if isinstance(command, click.Group):
            yield from commands_of(command, child)


def help_text(command: click.Command) -> Iterator[str]:
    """A command's help: paragraphs, with the examples in a code block."""
    for paragraph in re.split(r"\n{2,}", inspect.cleandoc(command.help or "")):
        if paragraph.startswith(EXAMPLES):
            yield fenced(paragraph.removeprefix(EXAMPLES), "text")
        else:
            yield f"{in_code(' '.join(paragraph.split()))}\n"


def options_table(command: click.Command, context: click.Context) -> Iterator[str]:
    """What may be typed: a row per option."""
    options = [parameter for parameter in command.get_params(context) if isinstance(parameter, click.Option)]
    yield "| option | value | default | what it does |"
    yield "|---|---|---|---|"
    for option in options:
        names = ", ".join(f"`{name}`" for name in (*option.opts, *option.secondary_opts))
        text, default = default_of(option, context)
        prose = in_code(text).replace("|", BAR)
        yield f"| {names} | {cell(value_of(option, context))} | {default} | {prose} |"
    yield ""


def value_of(option: click.Option, context: click.Context) -> str:
    """What follows the option, as its help page has it; nothing after a flag."""
    if option.is_flag:
        return ""
    name = option.make_metavar(context).strip("[]<>").removesuffix(" RANGE")
    if not isinstance(option.type, (click.IntRange, click.FloatRange)):
        return name
    lowest, highest = option.type.min, option.type.max
    least = f"{'above' if option.type.min_open else 'at least'} {lowest:g}"
    return f"{name}, {least}" if highest is None else f"{name}, {lowest:g} to {highest:g}"


def default_of(option: click.Option, context: click.Context) -> tuple[str, str]:
    """The help without its default, and the default: the one that the help says in brackets, or click's own, as code."""
    text = option.help or ""
    said = re.search(r"\s*\[default: (.*)\]$", text)
    if said:
        return text[: said.start()], in_code(said[1])
    default: Any = option.get_default(context)
    shown = option.show_default and not option.is_flag and default is not None
    return text, cell(str(default)) if shown else ""


def in_code(text: str) -> str:
    """Options in prose, as code; what has backquotes already stays."""
    parts = text.split("`")
    parts[::2] = [re.sub(r"(?<![\w-])(--?[a-z][a-z-]*)", r"`\1`", part).replace("*.", r"\*.") for part in parts[::2]]
    return "`".join(parts)


def cell(text: str) -> str:
    """Text as code in a table's cell, one piece for each of its alternatives: Markdown has no | in code in a table."""
    return ", ".join(f"`{part}`" for part in text.split("|")) if text else ""


def fenced(text: str, language: str) -> str:
    """A code block."""
    return f"```{language}\n{text}\n```\n"


if __name__ == "__main__":
    main()

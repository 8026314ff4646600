"""Strangers' texts, as they are shown."""

import sys
import unicodedata

import pytest
from rich.console import Console

from airhockey.inputs.names import markup, shown


@pytest.mark.parametrize(
    ("text", "seen"),
    [
        ("Ada Lovelace", "Ada Lovelace"),
        ("日本 ñ é 🏒", "日本 ñ é 🏒"),
        ("\x1b[2Jgone", r"\x1b[2Jgone"),
        ("a\nb\r\tc", r"a\x0ab\x0d\x09c"),
        ("\u202egpj.exe", r"\u202egpj.exe"),
        ("a\u2066b\u2069\u200b\ufeff", r"a\u2066b\u2069\u200b\ufeff"),
        ("\ud800", r"\ud800"),
        ("\u2028", r"\u2028"),
        ("\x9b31m", r"\x9b31m"),
        (b"x", "b'x'"),
        ("x" * 300, "x" * 199 + "…"),
    ],
)
def test_what_commands_or_hides_shows_as_its_number(text: object, seen: str) -> None:
    assert shown(text) == seen


def test_no_letter_of_unicode_passes_that_is_not_one() -> None:
    everything = "".join(map(chr, range(sys.maxunicode + 1)))
    passed = set(shown(everything, 12 * len(everything)))
    assert not {unicodedata.category(letter) for letter in passed} & {"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"}


def test_kept_letters_are_kept() -> None:
    assert shown("a\nb\x07", keep="\n") == "a\nb\\x07"


def test_no_markup_is_found_in_a_name() -> None:
    console = Console(width=80, color_system="truecolor", force_terminal=True)
    with console.capture() as capture:
        console.print(markup("[red]x[/red] [link=http://a]y[/] \\[b]"), highlight=False, end="")
    assert capture.get() == "[red]x[/red] [link=http://a]y[/] \\[b]"

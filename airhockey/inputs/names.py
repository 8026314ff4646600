"""How a text that a stranger chose is shown: what could command a terminal, turn lines around or hide is shown as its number."""

import unicodedata

MAX_SHOWN = 200
"""Longest text that is shown in full, in characters."""
_HIDDEN = (
    "Cc",
    "Cf",
    "Cs",
    "Co",
    "Cn",
    "Zl",
    "Zp",
)  # control, format (bidi, zero width), surrogates, unassigned, line ends


def shown(text: object, most: int = MAX_SHOWN, keep: str = "") -> str:
    """A text fit for a terminal, a log or a page: one line, no control sequences, nothing that reorders or hides letters.

    Args:
        text: The stranger's.
        most: Longest result, in characters.
        keep: Letters that are left as they are although they control something, as in "\\n\\t".
    """
    whole = str(text)
    letters = "".join(
        letter if letter in keep or is_visible(letter) else _number(letter) for letter in whole[: most + 1]
    )
    return letters if len(letters) <= most else letters[: most - 1] + "…"


def markup(text: object, most: int = MAX_SHOWN) -> str:
    """As `shown`, for a place where rich looks for markup: none is found in it."""
    from rich.markup import escape

    return escape(shown(text, most))


def is_text(text: str) -> bool:
    """Whether a file in UTF-8 can hold it: it has no half letters, such as the bytes of a file name that is no UTF-8."""
    return not any("\ud800" <= letter <= "\udfff" for letter in text)


def is_visible(letter: str) -> bool:
    """Whether a letter shows as itself and does nothing to its neighbours."""
    return letter == " " or unicodedata.category(letter) not in _HIDDEN


def _number(letter: str) -> str:
    code = ord(letter)
    return f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}" if code < 65536 else f"\\U{code:08x}"


def one_line(message: str, most: int = 4000) -> str:
    """A message as one line, with nothing that a terminal would obey."""
    return shown(" ".join(message.split()), most)

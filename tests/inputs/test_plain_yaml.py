"""The reader of YAML: what people write is what they get, and what attackers write is one line."""

import math
from pathlib import Path
from typing import Any

import pytest

from airhockey.errors import ConfigurationError
from airhockey.inputs.plain_yaml import MAX_BYTES, load_yaml, read_yaml


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-3", 0.001), ("1E5", 1e5), ("-2.5e+3", -2500.0), (".5", 0.5), ("5.", 5.0), ("+7", 7), ("-0", 0), ("1_000", 1000),
        ("0x1F", 31), ("0o17", 15), ("010", 10), (".inf", math.inf), ("-.inf", -math.inf),
        ("12:30", "12:30"), ("2024-02-30", "2024-02-30"), ("1e", "1e"), ("e3", "e3"), ("1.2.3", "1.2.3"), ("'1'", "1"),
        ("true", True), ("no", False), ("~", None), ("", None), ("[1, 2.0, a]", [1, 2.0, "a"]),
        ("{a: {b: 1e2}}", {"a": {"b": 100.0}}),
        ("{1: a}", {1: "a"}), ("<<: 3", {"<<": 3}),
    ],
)  # fmt: skip
def test_plain_values_are_what_they_look_like(text: str, value: Any) -> None:
    loaded = load_yaml(text, "file.yaml")
    assert loaded == value and type(loaded) is type(value)


def test_not_a_number_is_one() -> None:
    assert math.isnan(load_yaml(".nan", "file.yaml"))


NINE = "a: &a [x]\n" + "".join(f"{chr(98 + k)}: &{chr(98 + k)} [*{chr(97 + k)}, *{chr(97 + k)}]\n" for k in range(9))


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("[" * 200_000, "nested more than"), (NINE, r"line 2, column .*: the alias \*a is not allowed"),
        ("a: 1\nb: 2\na: 3", "line 3, column 1: the key 'a' stands twice"),
        ("{1: a, 1.0: b}", "stands twice"),
        ("!!python/object/apply:os.system [ls]", "tag"),
        ("!!binary aGVsbG8=", "'binary' is not allowed"),
        ("!!set {a, b}", "'set' is not allowed"),
        ("!mine 3", "'!mine' is not allowed"),
        ('"\\ud800"', "half a letter"), ('{"\\udfff": 1}', "half a letter"),
        ("!!int abc", "not valid YAML"),
        ("!!float [1]", "not valid YAML"),
        ("9" * 5000, "a number of 5000 characters"),
        ("1e999", "too large"),
        ("[" * 100, "nested more than"),
        ("{a: " * 10_000, "nested more than"),
        ("- " * 10_000, "nested more than"),
        ("[" + "1," * 11_000 + "]", "more than 10000 values"),
        ("? [a, b]\n: 1", "a key must be a name"),
        ("a: [1", "not valid YAML"),
        ("a: 1\n---\nb: 2", "not valid YAML"),
        ("a: \x00", "not valid YAML"),
        (b"a: \xff", "not UTF-8 text"),
        ("a" * (MAX_BYTES + 1), "larger than"),
        ("!!bool maybe", "not valid YAML"),
    ],
)  # fmt: skip
def test_everything_else_is_refused_in_one_line(text: str | bytes, why: str) -> None:
    with pytest.raises(ConfigurationError, match=why) as refused:
        load_yaml(text, "file.yaml")
    assert "'file.yaml'" in str(refused.value) and "\n" not in str(refused.value)


def test_a_file_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="Is a directory"):
        read_yaml(tmp_path)
    with pytest.raises(ConfigurationError, match="No such file"):
        read_yaml(tmp_path / "missing.yaml")
    with pytest.raises(ConfigurationError, match="null"):
        read_yaml("a\0b")
    (tmp_path / "bom.yaml").write_bytes("\ufeffa: ä".encode())
    assert read_yaml(tmp_path / "bom.yaml") == {"a": "ä"}

"""Compiled code does its own arithmetic.

numba hands `@` and linear algebra to SciPy's BLAS, which need not be there, and rounds as the machine's library does.
"""

import ast
from pathlib import Path

import airhockey

SOURCES = sorted(Path(airhockey.__file__).parent.rglob("*.py"))
COMPILED = {"compiled", "in_place"}
LENT = {"dot", "linalg", "matmul", "vdot"}


def compiled_functions() -> list[tuple[Path, ast.FunctionDef]]:
    return [
        (path, node)
        for path in SOURCES
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.FunctionDef)
        and COMPILED & {name.id for name in node.decorator_list if isinstance(name, ast.Name)}
    ]


def test_no_compiled_function_asks_blas() -> None:
    functions = compiled_functions()
    assert len(functions) > 100
    asking = [
        f"{path.name}:{node.lineno} {function.name}"
        for path, function in functions
        for node in ast.walk(function)
        if (isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult))
        or (isinstance(node, ast.Attribute) and node.attr in LENT)
    ]
    assert asking == []

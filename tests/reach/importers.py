"""Which files of tests use a helper, by their imports."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

from reach.recording import ROOT

TESTS = ROOT / "tests"


@cache
def imported(file: Path) -> frozenset[str]:
    """Modules below `tests` that a file imports, with dots, wherever the import stands."""
    names = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return frozenset(names)


def importing_files(file: str) -> set[str]:
    """Files of tests in which a file below `tests` has a part: itself, or those that import it, also by way of others."""
    found, waiting = set(), [file]
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        found.add(name)
        module = name.removeprefix("tests/").removesuffix(".py").removesuffix("/__init__").replace("/", ".")
        waiting += [
            path.relative_to(ROOT).as_posix()
            for path in TESTS.rglob("*.py")
            if module in imported(path) and path.relative_to(ROOT).as_posix() not in found
        ]
    return {name for name in found if Path(name).name.startswith("test_") and (ROOT / name).exists()}

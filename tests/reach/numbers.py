"""Which tests another kernel of BLAS need not try: those that call no function which multiplies or factors matrices.

Everything is tried but what stands in ``without_numbers.txt``, which ``make reach`` writes: whole files, and test functions that
take a twentieth of a second or more (the others are not worth a line).
"""

from __future__ import annotations

import ast
from collections import defaultdict

import numpy as np

from reach.reach_map import ReachMap, functions
from reach.recording import ROOT, WITHOUT_NUMBERS

WORTH_A_LINE = 0.05
PACKAGES = ("numpy.linalg", "scipy")
"""What is imported from these may call BLAS or LAPACK."""
ATTRIBUTES = {
    "linalg", "dot", "vdot", "inner", "outer", "matmul", "tensordot", "einsum", "convolve", "correlate", "roots", "polyfit",
    "cov", "corrcoef",
}  # fmt: skip
"""Attributes of numpy and of arrays that do."""


def calls_blas(node: ast.AST, imported: set[str]) -> bool:
    """Whether a piece of syntax is a product of matrices, or names a function that may call BLAS."""
    match node:
        case ast.BinOp(op=ast.MatMult()) | ast.AugAssign(op=ast.MatMult()):
            return True
        case ast.Attribute(value=ast.Name(id="scipy")):
            return True
        case ast.Attribute(attr=name):
            return name in ATTRIBUTES
        case ast.Name(id=name):
            return name in imported
    return False


def numerical_places(file: str, text: str) -> set[str]:
    """Functions of a module that call BLAS themselves, as the map names them."""
    tree, names = ast.parse(text), functions(text)
    imported = {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(PACKAGES)
        for alias in node.names
    }
    return {f"{file}:{names.get(node.lineno, '')}" for node in ast.walk(tree) if calls_blas(node, imported)}  # type: ignore[attr-defined]


def without_numbers(reach: ReachMap, numerical: set[str]) -> list[str]:
    """Files, and functions of other files, none of whose tests reaches one of these places."""
    calculating = np.isin(reach.places, sorted(numerical))
    by_function: dict[str, list[tuple[bool, float]]] = defaultdict(list)
    for i, test in enumerate(reach.tests):
        calculates = bool(calculating[reach.reached[reach.bounds[i] : reach.bounds[i + 1]]].any())
        by_function[test.partition("[")[0]].append((calculates, float(reach.seconds[i])))
    idle = {name for name, cases in by_function.items() if not any(calculates for calculates, _ in cases)}
    busy_files = {name.partition("::")[0] for name in by_function if name not in idle}
    files = {name.partition("::")[0] for name in idle} - busy_files
    single = {
        name
        for name in idle
        if name.partition("::")[0] in busy_files and sum(seconds for _, seconds in by_function[name]) >= WORTH_A_LINE
    }
    return sorted(files | single)


def write_without_numbers(reach: ReachMap) -> None:
    """Write the list from the map and the package as it is."""
    modules = [(path.relative_to(ROOT).as_posix(), path) for path in (ROOT / "torsionnet").rglob("*.py")]
    numerical = {place for file, path in modules for place in numerical_places(file, path.read_text(encoding="utf-8"))}
    names = [name for name in without_numbers(reach, numerical) if (ROOT / name.partition("::")[0]).exists()]
    WITHOUT_NUMBERS.write_text("".join(f"{name}\n" for name in names), encoding="utf-8")

"""The small faults that can be put into a module: one expression each, replaced in the text."""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterator
from dataclasses import dataclass

from reach.reach_map import functions

SWAPPED: dict[type[ast.AST], ast.AST] = {
    ast.Add: ast.Sub(),
    ast.Sub: ast.Add(),
    ast.Mult: ast.Div(),
    ast.Div: ast.Mult(),
    ast.Pow: ast.Mult(),
    ast.And: ast.Or(),
    ast.Or: ast.And(),
    ast.Eq: ast.NotEq(),
    ast.NotEq: ast.Eq(),
    ast.Is: ast.IsNot(),
    ast.IsNot: ast.Is(),
    ast.In: ast.NotIn(),
    ast.NotIn: ast.In(),
}
BOUNDARY = {ast.Lt: ast.LtE(), ast.LtE: ast.Lt(), ast.Gt: ast.GtE(), ast.GtE: ast.Gt()}
REVERSED = {ast.Lt: ast.GtE(), ast.LtE: ast.Gt(), ast.Gt: ast.LtE(), ast.GtE: ast.Lt()}
PAIRS = (("min", "max"), ("minimum", "maximum"), ("argmin", "argmax"), ("any", "all"), ("real", "imag"), ("sin", "cos"))
OTHER = {**dict(PAIRS), **{second: first for first, second in PAIRS}}
DROPPED = {"abs", "absolute", "conj", "conjugate", "sqrt", "sorted", "T"}
"""Functions, methods and attributes of which only the argument is left."""
TINY = 1e-4
"""Smaller constants are tolerances: those have to be off by more than a factor of two to matter."""
NUMBERS = ("float", "int", "complex", "FloatArray", "ComplexArray")

NO_MATTER = {
    "strict", "stacklevel", "repr", "compare", "check_finite", "overwrite_a", "overwrite_b", "copy", "maxsize",
    "linewidth", "linewidths", "elinewidth", "markersize", "markeredgewidth", "capsize", "wide",
}  # fmt: skip
"""Keywords that change no result, or only how thick a line is, how large a mark, how wide a column at least."""
ONLY_SHOWN = {"__repr__", "__str__", "_repr_html_"}
DISPLAYS = (ast.List, ast.Tuple, ast.ListComp, ast.JoinedStr)


@dataclass(frozen=True)
class Mutant:
    """One replaced piece of a module's text; ``function`` is the outermost one around it, or empty."""

    module: str
    line: int
    function: str
    start: int
    end: int
    old: str
    new: str

    def applied(self, text: str) -> str:
        return text[: self.start] + self.new + text[self.end :]

    def __str__(self) -> str:
        return f"{self.module}:{self.line}: {' '.join(self.old.split())} -> {self.new}"


def mutants(module: str, text: str) -> list[Mutant]:
    """All faults of a module, in the order of its lines."""
    begins = [0]
    for line in text.splitlines(keepends=True):
        begins.append(begins[-1] + len(line.encode()))
    raw, found, tree = text.encode(), {}, ast.parse(text)
    names = functions(text)
    for node, new in _in_block(tree):
        start, end = begins[node.lineno - 1] + node.col_offset, begins[node.end_lineno - 1] + node.end_col_offset
        ends = len(raw[:start].decode()), len(raw[:end].decode())
        written = ast.unparse(new)
        if isinstance(new, ast.expr) and not isinstance(new, (ast.Constant, ast.Name, ast.Call, ast.Attribute)):
            written = f"({written})"
        found[*ends, written] = Mutant(
            module, node.lineno, names.get(node.lineno, ""), *ends, text[slice(*ends)], written
        )
    return sorted(found.values(), key=lambda mutant: (mutant.start, mutant.end, mutant.new))


def _in_block(node: ast.AST) -> Iterator[tuple[ast.AST, ast.AST]]:
    """Nodes and what to put in their place."""
    if _of_no_matter(node):
        return
    yield from _operators(node)
    yield from _names(node)
    yield from _statements(node)
    for name, value in ast.iter_fields(node):
        if name not in {"annotation", "returns", "decorator_list"} and not isinstance(node, ast.Raise):
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    yield from _in_block(child)


def _of_no_matter(node: ast.AST) -> bool:
    """Whether no result depends on it: types, messages and what is only shown."""
    match node:
        case (
            ast.JoinedStr()
            | ast.Import()
            | ast.ImportFrom()
            | ast.Call(func=ast.Name("cast" | "isinstance" | "Column"))
        ):
            return True
        case ast.If(test=ast.Name("TYPE_CHECKING")) | ast.AnnAssign(annotation=ast.Name("TypeAlias")):
            return True
        case ast.Assign(targets=[ast.Name("msg")]):
            return True
        case ast.FunctionDef(name=name):
            return name in ONLY_SHOWN
        case ast.keyword(arg=name):
            return name in NO_MATTER
    return False


def _operators(node: ast.AST) -> Iterator[tuple[ast.AST, ast.AST]]:
    match node:
        case ast.BinOp(op=op) | ast.AugAssign(op=op) if type(op) in SWAPPED and not _joins(node):
            yield node, _with(node, op=SWAPPED[type(op)])
        case ast.BoolOp(op=op):
            yield node, _with(node, op=SWAPPED[type(op)])
        case ast.Compare(ops=ops):
            flips = {**SWAPPED, **(BOUNDARY if _counts(node) else REVERSED)}
            for place, op in enumerate(ops):
                yield node, _with(node, ops=[*ops[:place], flips[type(op)], *ops[place + 1 :]])
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            yield node, node.operand


def _names(node: ast.AST) -> Iterator[tuple[ast.AST, ast.AST]]:
    match node:
        case ast.Constant(value=bool() | int() | float() as value):
            yield node, ast.Constant(_changed(value))
        case ast.Call(func=ast.Name(name) | ast.Attribute(attr=name), args=[argument, *_]) if name in DROPPED:
            yield node, argument
        case ast.Call(func=ast.Attribute(value=value, attr=name), args=[]) if name in DROPPED:
            yield node, value
        case ast.Call(func=ast.Name(name)) if name in OTHER:
            yield node, _with(node, func=ast.Name(OTHER[name]))
        case ast.Attribute(attr=name) if name in OTHER:
            yield node, _with(node, attr=OTHER[name])
        case ast.Attribute(value=value, attr="T"):
            yield node, value


def _statements(node: ast.AST) -> Iterator[tuple[ast.AST, ast.AST]]:
    match node:
        case ast.Raise() | ast.Expr(value=ast.Call() | ast.Yield()):
            yield node, ast.Pass()
        case ast.If(test=test) | ast.IfExp(test=test) if not isinstance(test, (ast.Compare, ast.UnaryOp)):
            yield test, ast.UnaryOp(ast.Not(), test)
        case ast.FunctionDef():
            yield from _results(node)


def _results(function: ast.FunctionDef) -> Iterator[tuple[ast.AST, ast.AST]]:
    """What a function returns, with its sign turned; a truth value is negated."""
    kind = ast.unparse(function.returns) if function.returns else ""
    if kind != "bool" and kind not in NUMBERS:
        return
    op = ast.Not() if kind == "bool" else ast.USub()
    for node in ast.walk(function):
        if isinstance(node, ast.Return) and node.value and not isinstance(node.value, (ast.Constant, ast.Compare)):
            yield node.value, ast.UnaryOp(op, node.value)


def _joins(node: ast.BinOp | ast.AugAssign) -> bool:
    """Whether + puts texts or lists together: there every fault is an error at once."""
    sides = (node.left, node.right) if isinstance(node, ast.BinOp) else (node.value,)
    return any(isinstance(side, DISPLAYS) or isinstance(getattr(side, "value", None), str) for side in sides)


def _counts(node: ast.Compare) -> bool:
    """Whether whole numbers are compared: between measured ones, < and <= are the same."""
    sides = (node.left, *node.comparators)
    return any(
        isinstance(getattr(side, "value", None), int)
        or (isinstance(side, ast.Call) and ast.unparse(side.func) == "len")
        for side in sides
    )


def _changed(value: complex) -> complex:
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    return 1.0 if value == 0 else value * (1000 if abs(value) < TINY else 2)


def _with(node: ast.AST, **changes: object) -> ast.AST:
    changed = copy.copy(node)
    for name, value in changes.items():
        setattr(changed, name, value)
    return changed

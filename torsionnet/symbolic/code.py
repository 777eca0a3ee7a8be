"""Python source text of symbolic transfer functions as numpy functions, which is written but never executed."""

from __future__ import annotations

import keyword
import re
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy

from torsionnet.base.errors import UsageError
from torsionnet.symbolic.algebra.algebras import S
from torsionnet.symbolic.algebra.delay import delays_of
from torsionnet.symbolic.formula_text import WhereTable, continued_table, where_table

if TYPE_CHECKING:
    from torsionnet.symbolic.symbolic_request import SymbolicFraction

IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}")
"""Pattern of names allowed in generated Python code (letters, digits, underscores), so that no name can be code."""
MOST_MULTIPLIED_COORDINATES = 25
"""Number of coordinates (roughly) above which generated code uses the continued fraction, as longer products may
overflow floats."""


def python_code(function: SymbolicFraction, name: str) -> str:
    """Python source text of a numpy function that evaluates a transfer function at frequencies in Hz.

    Own names of the function begin with an underscore, parameters never do.

    Raises
    ------
    UsageError
        ``name`` or a parameter is no plain identifier.
    """
    table = _table(function)
    arguments = _plain({symbol: str(symbol) for symbol in (_symbols(table) | _delaying(function)) - {S}})
    kappas = _plain({kappa: kappa.func.__name__ for kappa in _tables(table)})
    delays = {kappa: function.used_tables[kappa].time for kappa in delays_of(function.used_tables)}
    tables = {kappa: f"_{kappas[kappa]}" for kappa in sorted(kappas, key=str) if kappa not in delays}
    factors = {kappa: f"_np.exp(-_s * {_written(time, arguments)})" for kappa, time in delays.items()}
    return "\n".join(
        [
            "import numpy as _np",
            "",
            "",
            f"def {checked_identifier(name)}({_signature(function, arguments, tables)}):",
            *_docstring(function, bool(tables)),
            "    _s = 2j * _np.pi * _np.asarray(_f, dtype=float)",
            *_body(table, {**arguments, **tables, **factors, S: "_s"}),
            "",
        ]
    )


def _table(function: SymbolicFraction) -> WhereTable:
    if (
        len(function.values) > 3 * MOST_MULTIPLIED_COORDINATES
        or len(function.steps.steps) > 20 * MOST_MULTIPLIED_COORDINATES
    ):
        return continued_table(function) or where_table(function)
    return where_table(function)


def checked_identifier(name: str) -> str:
    """Name unchanged if it is a plain Python identifier, safe in source text, else an error is raised.

    >>> checked_identifier("k_1")
    'k_1'
    """
    if not IDENTIFIER.fullmatch(name) or keyword.iskeyword(name):
        raise UsageError(
            f'"{name}" cannot be a name in Python code; use letters, digits and underscores', kind="invalid-name"
        )
    return name


def _plain(names: dict[Any, str]) -> dict[Any, str]:
    """Python name of each symbol, without the dots of names in parts, none of them twice."""
    python_names: dict[Any, str] = {}
    for owner, name in sorted(names.items(), key=lambda pair: ("." in pair[1], pair[1])):
        wish = name.replace(".", "_")
        while wish in python_names.values():
            wish += "_"
        python_names[owner] = checked_identifier(wish)
    return python_names


def _leaves(table: WhereTable) -> list[Any]:
    steps = table.program.steps
    return [steps[i][1] for i in table.program.needed([table.result]) if steps[i][0] == "leaf"]


def _symbols(table: WhereTable) -> set[Any]:
    symbols: set[Any] = set()
    for leaf in _leaves(table):
        symbols |= getattr(leaf, "free_symbols", set())
    return symbols - {sympy.Symbol("omega")}


def _delaying(function: SymbolicFraction) -> set[Any]:
    """Parameters that appear in the delays of a transfer function, as sympy symbols."""
    times = (delay.time for delay in delays_of(function.used_tables).values())
    return {symbol for time in times for symbol in time.free_symbols}


def _tables(table: WhereTable) -> set[Any]:
    return {leaf for leaf in _leaves(table) if isinstance(leaf, sympy.core.function.AppliedUndef)}


def _signature(function: SymbolicFraction, arguments: dict[Any, str], tables: dict[Any, str]) -> str:
    ordered = sorted(arguments, key=str)
    named = [arguments[symbol] + _default(function.values.get(symbol)) for symbol in ordered]
    named = [*tables.values(), *named]
    return ", ".join(["_f", "/", *(["*", *named] if named else [])])


def _default(value: Any) -> str:
    return "" if value is None else f"={float(value)!r}"


def _docstring(function: SymbolicFraction, has_tables: bool) -> list[str]:
    above, below = function.channels
    names = re.sub(r"[^\w ()+,.*/^-]", "", f"{above.name} / {below.name}", flags=re.ASCII)
    extra = " Each _kappa is the tabulated complex stiffness at these frequencies." if has_tables else ""
    return [f'    """{names}; _f: frequencies > 0 in Hz, parameters in SI units.{extra}"""']


def _body(table: WhereTable, names: dict[Any, str]) -> list[str]:
    written: dict[int, str] = {}
    lines: list[str] = []
    for index in table.program.needed([table.result]):
        operation, *operands = table.program.steps[index]
        if operation == "leaf":
            written[index] = _leaf(operands[0], names)
        else:
            left, right = (written[operand] for operand in operands)
            written[index] = f"_{len(lines) + 1}"
            lines.append(f"    {written[index]} = {left} {operation} {right}")
    return [*lines, f"    return {written[table.result.index]} + 0 * _s"]


def _leaf(payload: Any, names: dict[Any, str]) -> str:
    if isinstance(payload, Fraction):
        return repr(float(payload)) if payload >= 0 else f"({float(payload)!r})"
    if payload in names:
        return names[payload]
    if payload == sympy.I:
        return "1j"
    if isinstance(payload, sympy.Pow):
        return f"_np.power({_written(payload.base, names)}, {float(payload.exp)!r})"
    return repr(float(payload))


def _written(expression: Any, names: dict[Any, str]) -> str:
    """Python text of a small sympy expression, such as one under a root or the time of a delay."""
    if isinstance(expression, sympy.Add | sympy.Mul):
        sign = " + " if isinstance(expression, sympy.Add) else " * "
        return f"({sign.join(_written(part, names) for part in expression.args)})"
    if isinstance(expression, sympy.Pow):
        return f"_np.power({_written(expression.base, names)}, {float(expression.exp)!r})"
    return names[expression] if expression in names else f"({float(expression)!r})"

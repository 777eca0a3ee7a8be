"""LaTeX of the equations of motion, as one matrix equation or as one equation per coordinate."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.symbolic.formula_text import latex
from torsionnet.symbolic.symbol_names import angle_latex, symbol_latex

if TYPE_CHECKING:
    from torsionnet.linear.assembly.symbolic import SymbolicMatrices

PARTS = ("M", "C", "K", "H", "q", "B", "u")
"""Names of the parts of the equations of motion that can be requested as LaTeX (matrices, coordinates, inputs)."""
DOTS = {"M": r"\ddot", "C": r"\dot", "K": ""}
"""LaTeX accent of the time derivative of the angles that each matrix of the equations of motion multiplies."""


def to_latex(system: SymbolicMatrices, part: str = "") -> str:
    """LaTeX of the equations of motion of a drivetrain, or of one part of them (such as ``M``).

    See :meth:`torsionnet.symbolic.symbolic_system.SymbolicSystem.to_latex`.

    Raises
    ------
    UsageError
        No such part.
    """
    if part in ("M", "C", "K", "H", "B"):
        return matrix_latex(getattr(system, part).tolist())
    if part == "q":
        return column_latex([angle_latex(name) for name in system.coordinates])
    if part == "u":
        return column_latex([symbol_latex(name) for name in system.inputs])
    if part:
        raise UsageError(
            f'unknown part "{part}" of the equations{did_you_mean(part, PARTS)}; choose {", ".join(PARTS)}',
            kind="unknown-word",
        )
    terms = [f"{to_latex(system, key)} {angle_derivatives(system.coordinates, dots)}" for key, dots in DOTS.items()]
    rest = complex_stiffness(system)
    terms += [f"{matrix_latex(rest.tolist())} {to_latex(system, 'q')}"] if any(rest) else []
    loads = [f"{to_latex(system, 'B')} {to_latex(system, 'u')}"] if system.inputs else []
    loads += [
        f"{column_latex([latex(value) for value in action.row])} {symbol_latex(f'T_{action.owner}')}"
        for action in system.actions
    ]
    return f"{' + '.join(terms)} = {' + '.join(loads) or '0'}"


def complex_stiffness(system: SymbolicMatrices) -> Any:
    """Symbolic matrix (n_q, n_q) in N m/rad of the stiffness besides K, hysteretic damping times j plus tables."""
    import sympy

    return sympy.I * system.H + system.tables


def matrix_latex(rows: list[list[Any]]) -> str:
    """LaTeX of a matrix in square brackets from rows of sympy expressions."""
    return bracketed_matrix([[latex(cell) for cell in row] for row in rows])


def column_latex(entries: list[str]) -> str:
    """LaTeX of a column vector in square brackets from entries that are LaTeX already."""
    return bracketed_matrix([[entry] for entry in entries])


def bracketed_matrix(rows: list[list[str]]) -> str:
    r"""LaTeX of a matrix in square brackets from cells that are LaTeX already.

    >>> print(bracketed_matrix([["a", "b"], ["c", "d"]]))
    \begin{bmatrix} a & b \\ c & d \end{bmatrix}
    """
    lines = r" \\ ".join(" & ".join(row) for row in rows)
    return rf"\begin{{bmatrix}} {lines} \end{{bmatrix}}"


def angle_derivatives(coordinates: tuple[str, ...], dots: str) -> str:
    """LaTeX column of the coordinates' angles, each under the accent of a time derivative, such as ``\\ddot``."""
    return column_latex([angle_derivative(name, dots) for name in coordinates])


def angle_derivative(node: str, dots: str) -> str:
    """LaTeX of a node's angle under the accent of a time derivative, such as ``\\ddot``."""
    base, index = angle_latex(node).split("_", 1)
    return f"{dots}{{{base}}}_{index}" if dots else f"{base}_{index}"


def equation_terms(system: SymbolicMatrices, row: int) -> list[str]:
    r"""LaTeX terms of one equation of motion, split before every sign so that lines may break there.

    >>> import torsionnet as tn
    >>> equation_terms(tn.load("dmf_rig").symbolic(), 0)[-1]
    '= T_{M}'
    """
    terms = list(_terms(system, row))
    loads = [_signed(system.B[row, i], symbol_latex(name)) for i, name in enumerate(system.inputs)]
    loads += [_signed(action.row[row], symbol_latex(f"T_{action.owner}")) for action in system.actions]
    given = [text for text in loads if text]
    return [*_first(terms), *(f"= {text}" if not number else text for number, text in enumerate(_first(given)))]


def _first(terms: list[str]) -> list[str]:
    return [terms[0].removeprefix("+ "), *terms[1:]] if terms else ["0"]


def _terms(system: SymbolicMatrices, row: int) -> Iterator[str]:
    stiffness = system.K + complex_stiffness(system)
    for matrix, dots in ((system.M, r"\ddot"), (system.C, r"\dot"), (stiffness, "")):
        for place, name in enumerate(system.coordinates):
            text = _signed(matrix[row, place], angle_derivative(name, dots))
            if text:
                yield text


def _signed(coefficient: Any, factor: str) -> str:
    if coefficient == 0:
        return ""
    negative = bool(coefficient.could_extract_minus_sign())
    size = -coefficient if negative else coefficient
    text = latex(size)
    shown = "" if size == 1 else rf"\left({text}\right) " if size.is_Add else f"{text} "
    return f"{'-' if negative else '+'} {shown}{factor}"


def sum_terms(expression: Any) -> list[str]:
    """LaTeX terms of an expression, split before every sign of its outermost sum so that lines may break there."""
    if not expression.is_Add:
        return [latex(expression)]
    parts = []
    for term in expression.as_ordered_terms():
        negative = bool(term.could_extract_minus_sign())
        parts.append(f"{'-' if negative else '+'} {latex(-term if negative else term)}")
    return _first(parts)

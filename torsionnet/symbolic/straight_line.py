"""Straight-line programs of single operations, shown as a table with a name for every repeated result."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy

from torsionnet.symbolic.algebra.algebras import S, evaluate_expression
from torsionnet.symbolic.algebra.network import Stiffness
from torsionnet.symbolic.algebra.program import ARITHMETIC, Program, ProgramNode
from torsionnet.symbolic.formula_text import latex, where_text, with_where

if TYPE_CHECKING:
    from torsionnet.symbolic.symbolic_fraction import SymbolicFraction


@dataclass(frozen=True)
class Lowered:
    """Algebra that writes a program as single operations (+, *, /) on s, parameters and numbers."""

    program: Program

    def leaf(self, payload: Any) -> ProgramNode:
        if isinstance(payload, Fraction):
            return self.program.leaf(payload)
        if isinstance(payload, Stiffness):
            return self._stiffness(*payload.parts)
        return self._number(payload)

    def _number(self, expression: Any) -> ProgramNode:
        found: ProgramNode = evaluate_expression(expression, self.program.leaf)
        return found

    def _stiffness(self, stiffness: Any, damping: Any, inertia: Any) -> ProgramNode:
        s = self.program.leaf(S)
        k, c, j = (self._number(part) for part in (stiffness, damping, inertia))
        return k + j * (s * s) if c.is_zero else k + s * (c + s * j)


@dataclass(frozen=True, eq=False, repr=False)
class WhereTable:
    """Straight-line program of a transfer function in single operations, with names for repeated results.

    Attributes
    ----------
    program : Program
        Single operations; the leaves are numbers, parameters and s.
    result : ProgramNode
    """

    program: Program
    result: ProgramNode

    @property
    def operations(self) -> int:
        """Number of additions, multiplications and divisions that the transfer function takes."""
        steps = self.program.steps
        return sum(steps[index][0] in ARITHMETIC for index in self.program.needed([self.result]))

    def lines(self) -> Iterator[tuple[int, str, tuple[int, ...]]]:
        """Yield index, operation and operand indices of each arithmetic step of the program, in order."""
        for index in self.program.needed([self.result]):
            operation, *operands = self.program.steps[index]
            if operation in ARITHMETIC:
                yield index, operation, tuple(operands)

    def where(self) -> tuple[dict[Any, Any], Any]:
        """Table of names z_i for results used more than once, and the transfer function expressed in them.

        Examples
        --------
        >>> import torsionnet as tn
        >>> H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_M")
        >>> table, result = H.program.where()
        >>> result
        z_3/(s*z_3*(I_1*s + c_M) + z_1*z_2)
        """
        names = _Names(self.program, self.result)
        algebra_results: dict[int, Any] = {}
        for index in self.program.needed([self.result]):
            algebra_results[index] = names.named(index, _expression(self.program.steps[index], algebra_results))
        return names.table, algebra_results[self.result.index]

    def __str__(self) -> str:
        table, result = self.where()
        return where_text(result, table)

    def __repr__(self) -> str:
        return f"<WhereTable: {self.operations} operations>"

    def _repr_latex_(self) -> str:
        table, result = self.where()
        return f"$\\displaystyle {with_where(latex(result), table)}$"


class _Names:
    """Table of names z_i for results of a program that are used more than once."""

    def __init__(self, program: Program, result: ProgramNode) -> None:
        self.program, self.result = program, result
        self.table: dict[Any, Any] = {}
        self.uses: Counter[int] = Counter()
        for index in program.needed([result]):
            if program.steps[index][0] in ARITHMETIC:
                self.uses.update(program.steps[index][1:])

    def named(self, index: int, expression: Any) -> Any:
        if self.uses[index] < 2 or expression.is_Atom or index == self.result.index:
            return expression
        name = sympy.Symbol(f"z_{len(self.table) + 1}")
        self.table[name] = expression
        return name


def _expression(step: tuple[Any, ...], known: dict[int, Any]) -> Any:
    operation, *operands = step
    if operation == "leaf":
        number = operands[0]
        return sympy.Rational(number.numerator, number.denominator) if isinstance(number, Fraction) else number
    left, right = (known[index] for index in operands)
    return left + right if operation == "+" else left * right if operation == "*" else left / right


def where_table(function: SymbolicFraction) -> WhereTable:
    """Straight-line program of a transfer function in single operations, numerator over denominator."""
    program = Program()
    above, below = function.steps.run(Lowered(program), [function.numerator, function.denominator])
    return WhereTable(program, above / below)


def continued_table(function: SymbolicFraction) -> WhereTable | None:
    """Straight-line program of a transfer function's continued fraction, or None if there is no such fraction."""
    from torsionnet.symbolic.continued_fraction import continued_fraction

    program = Program()
    lowered = Lowered(program)
    result = None if function.request is None else continued_fraction(function.request, lowered.leaf)
    return None if result is None else WhereTable(program, program.node(result))

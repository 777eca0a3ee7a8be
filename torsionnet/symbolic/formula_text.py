"""Text and LaTeX of expressions for display, with powers of s in order and long numbers rounded.

Here as well: straight-line programs of single operations, shown as a table with a name for every repeated result.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy

from torsionnet.base.program import ARITHMETIC, Program, ProgramAlgebra, ProgramNode
from torsionnet.symbolic.algebra.algebras import S, evaluate_expression
from torsionnet.symbolic.algebra.network import Stiffness

if TYPE_CHECKING:
    from torsionnet.symbolic.symbolic_request import SymbolicFraction


LONG_RATIONAL_DIGITS = 12
"""Number of digits of a rational number above which it is displayed as a decimal, being hard to read."""
DISPLAY_DIGITS = 8
"""Number of significant digits of a displayed decimal, more than parameters are known to."""


def for_display(expression: Any) -> Any:
    """Sympy expression for display, long rationals as decimals, even powers of sums without a leading minus."""
    long = {
        number: sympy.Float(number, DISPLAY_DIGITS)
        for number in expression.atoms(sympy.Rational)
        if len(str(number.p)) + len(str(number.q)) > LONG_RATIONAL_DIGITS
    }
    sign_changed = {
        power: (-power.base) ** power.exp for power in expression.atoms(sympy.Pow) if _begins_with_minus(power)
    }
    return expression.xreplace({**long, **sign_changed}) if long or sign_changed else expression


def _begins_with_minus(power: Any) -> bool:
    even = power.exp.is_Integer and power.exp % 2 == 0
    return bool(even and power.base.is_Add and power.base.could_extract_minus_sign())


def polynomial_text(names: Iterable[Any]) -> str:
    """Text ``b_0 + b_1*s + ...`` of a polynomial in ascending powers of s from the names of its coefficients."""
    terms = [_term(name, power) for power, name in enumerate(names) if name != 0]
    return " + ".join(terms) or "0"


def _term(name: Any, power: int) -> str:
    return str(name) if not power else f"{name}*s" if power == 1 else f"{name}*s**{power}"


def polynomial_latex(names: Iterable[Any]) -> str:
    """LaTeX of a polynomial in ascending powers of s from the names of its coefficients."""
    terms = [
        sympy.latex(name) + ("" if not power else " s" if power == 1 else f" s^{{{power}}}")
        for power, name in enumerate(names)
        if name != 0
    ]
    return " + ".join(terms) or "0"


def where_text(result: Any, table: Mapping[Any, Any]) -> str:
    """Text of a result, followed by the definition of each name in it on a line of its own."""
    return "\n".join([str(result), *(f"  {name} = {for_display(value)}" for name, value in table.items())])


def latex(expression: Any) -> str:
    """LaTeX of a sympy expression, with indices of several letters upright."""
    from torsionnet.symbolic.symbol_names import symbol_names

    names = symbol_names(expression.free_symbols)
    return str(sympy.latex(for_display(expression), symbol_names=names, imaginary_unit="rj"))


def with_where(result: str, table: Mapping[Any, Any]) -> str:
    """LaTeX of a result, followed by the definition of each name in it, as an aligned block."""
    lines = [f"& {result}", *(f"& {latex(name)} = {latex(value)}" for name, value in table.items())]
    return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"


@dataclass(frozen=True)
class Lowered(ProgramAlgebra):
    """Algebra that writes a program as single operations (+, *, /) on s, parameters and numbers."""

    program: Program

    def leaf(self, payload: Any) -> ProgramNode:
        if isinstance(payload, Fraction):
            return self.program.leaf(payload)
        if isinstance(payload, Stiffness):
            return self._stiffness(*payload.parts)
        return self._number(payload)

    def _number(self, expression: Any) -> ProgramNode:
        node: ProgramNode = evaluate_expression(expression, self.program.leaf)
        return node

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
    above, below = function.steps.values_in(Lowered(program), function.outputs)
    return WhereTable(program, above / below)


def continued_table(function: SymbolicFraction) -> WhereTable | None:
    """Straight-line program of a transfer function's continued fraction, or None if there is no such fraction."""
    from torsionnet.symbolic.symbolic_request import continued_fraction

    program = Program()
    lowered = Lowered(program)
    result = None if function.request is None else continued_fraction(function.request, lowered.leaf)
    return None if result is None else WhereTable(program, program.node(result))

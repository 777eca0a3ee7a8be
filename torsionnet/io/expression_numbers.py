"""Numbers that carry the expression of the model's parameters they come from, so that an export can write it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import pi
from typing import Any

from torsionnet.base.expressions import Algebra, Compound, Expression, Name, Number, exact_sqrt, float_if_long
from torsionnet.model.elements import Values


@dataclass(frozen=True, eq=False)
class ExpressionNumber:
    """Number with its expression in the model's parameters, compared by its present value.

    Elements run on such numbers as they do on fractions.

    >>> import torsionnet as tn
    >>> (law,) = tn.Spring("s", nodes=("a", "b"), stiffness="2*k").parts(expression_values({"k": Fraction(5)}))
    >>> law.stiffness.value, str(law.stiffness.expression)
    (Fraction(10, 1), '2*k')
    """

    value: Fraction | float
    expression: Expression

    def __add__(self, right: Any) -> ExpressionNumber:
        other = expression_number(right)
        if other.is_constantly(0):
            return self
        return other if self.is_constantly(0) else self._with("+", other, self.value + other.value)

    def __sub__(self, right: Any) -> ExpressionNumber:
        other = expression_number(right)
        if self.is_constantly(0):
            return -other
        return self if other.is_constantly(0) else self._with("-", other, self.value - other.value)

    def __mul__(self, right: Any) -> ExpressionNumber:
        other = expression_number(right)
        for factor, rest in ((self, other), (other, self)):
            if factor.is_constantly(0) or rest.is_constantly(1):
                return factor
        return self._with("*", other, self.value * other.value)

    def __truediv__(self, right: Any) -> ExpressionNumber:
        other = expression_number(right)
        return self if other.is_constantly(1) else self._with("/", other, self.value / other.value)

    def __pow__(self, power: int) -> ExpressionNumber:
        return self if power == 1 else self._with("**", expression_number(power), self.value**power)

    def __neg__(self) -> ExpressionNumber:
        match self.expression:
            case Compound("negative", (inner,)):
                return _made(-self.value, inner)
        return _made(-self.value, Compound("negative", (self.expression,)))

    def __radd__(self, left: Any) -> ExpressionNumber:
        return expression_number(left) + self

    def __rsub__(self, left: Any) -> ExpressionNumber:
        return expression_number(left) - self

    def __rmul__(self, left: Any) -> ExpressionNumber:
        return expression_number(left) * self

    def __rtruediv__(self, left: Any) -> ExpressionNumber:
        return expression_number(left) / self

    def __eq__(self, right: object) -> bool:
        return self.value == expression_number(right).value

    def __lt__(self, right: Any) -> bool:
        return bool(self.value < expression_number(right).value)

    def __gt__(self, right: Any) -> bool:
        return bool(self.value > expression_number(right).value)

    def __hash__(self) -> int:
        return hash(self.value)

    def __float__(self) -> float:
        return float(self.value)

    def is_constantly(self, number: int) -> bool:
        """Whether the number equals ``number`` for all values of the model's parameters."""
        return isinstance(self.expression, Number) and self.value == number

    def _with(self, sign: str, right: ExpressionNumber, value: Fraction | float) -> ExpressionNumber:
        return _made(value, Compound(sign, (self.expression, right.expression)))


def expression_number(value: Any) -> ExpressionNumber:
    """Plain number as an :class:`ExpressionNumber` without parameters."""
    return value if isinstance(value, ExpressionNumber) else ExpressionNumber(value, Number(value))


def expression_values(parameters: Mapping[str, Any]) -> Values:
    """Evaluator of an element's entries that gives numbers with their expressions in these parameters."""
    named = {name: ExpressionNumber(value, Name(name)) for name, value in parameters.items()}
    return Values(named, Algebra(expression_number, _square_root, ExpressionNumber(pi, Compound("pi"))))


def _square_root(number: ExpressionNumber) -> ExpressionNumber:
    return _made(exact_sqrt(number.value), Compound("sqrt", (number.expression,)))


def _made(value: Fraction | float, expression: Expression) -> ExpressionNumber:
    """Result of an operation as a number with its expression, or a plain one where it is exact and has no parameter."""
    value = float_if_long(value)
    is_plain = isinstance(value, Fraction | int) and not expression.names
    return ExpressionNumber(value, Number(value) if is_plain else expression)

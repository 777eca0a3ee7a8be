"""Expressions of parameters, such as ``2*k_1`` or ``G*pi*d**4/(32*l)``, as immutable trees.

A tree is made of numbers, names and what :data:`RULES` lists, and works in any algebra: exact fractions, floats, or
sympy through an :class:`Algebra` of its own.

>>> half = Compound("/", (Name("k_1"), Number(2)))
>>> str(half), sorted(half.names), half.evaluate({"k_1": Fraction(1)})
('k_1/2', ['k_1'], Fraction(1, 2))
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any, ClassVar, Literal

import torsionnet.core.units as units
from torsionnet.core.errors import TorsionnetError, did_you_mean
from torsionnet.core.number_range import exact_sqrt, float_if_long
from torsionnet.core.units import DIMENSIONS, Dimension

_SUM, _PRODUCT, _UNARY, _ATOM = 1, 2, 3, 4
_Kind = Dimension | Literal["bare", "unknown"]


class ExpressionError(TorsionnetError, ValueError):
    """Error of an expression that cannot be read or evaluated; ``offset`` is the column from 0, or None."""

    def __init__(self, message: str, offset: int | None = None) -> None:
        super().__init__(message)
        self.offset = offset


@dataclass(frozen=True)
class Algebra:
    """Number system in which expressions are evaluated: how numbers enter it, its square root and its pi."""

    number: Callable[[Fraction], Any]
    sqrt: Callable[[Any], Any]
    pi: Any


RATIONAL = Algebra(number=lambda number: number, sqrt=exact_sqrt, pi=math.pi)
"""Algebra that evaluates expressions as exact fractions, with floats where a root or pi needs them."""
FLOAT = Algebra(number=float, sqrt=exact_sqrt, pi=math.pi)
"""Algebra that evaluates expressions as floats."""


@dataclass(frozen=True)
class Expression:
    """Expression of parameters as a tree of numbers, names and arithmetic.

    ``str`` gives a text that parses back to an equal tree.
    """

    @cached_property
    def names(self) -> frozenset[str]:
        """Names of all parameters in the expression."""
        raise NotImplementedError

    def evaluate(self, values: Mapping[str, Any], algebra: Algebra = RATIONAL) -> Any:
        """Value of the expression in SI units, as a number of an algebra, for given values of its parameters.

        Raises :class:`ExpressionError`, also for results beyond a float.
        """
        try:
            result = self.value_in(values, algebra)
            finite = not isinstance(result, int | float | Fraction) or math.isfinite(result)
        except OverflowError:
            finite = False
        except ZeroDivisionError:  # an exact fraction that no float is small enough for
            raise ExpressionError(f'division in "{self}" by a value that is too small') from None
        if not finite:
            raise ExpressionError(f'the value of "{self}" is too large')
        return result

    def dimension(self, dimensions: Mapping[str, Dimension | None]) -> Dimension | None:
        """Physical dimension of the value; None for a bare number, or where a parameter's dimension is unknown."""
        kind = self.kind_of(dimensions)
        return kind if isinstance(kind, Dimension) else None

    def value_in(self, values: Mapping[str, Any], algebra: Algebra) -> Any:
        """Value in SI units of this node of the tree, as a number of an algebra."""
        raise NotImplementedError

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:
        """Physical dimension of the value, or a mark that it is a bare number or unknown."""
        raise NotImplementedError

    def renamed(self, name: Callable[[str], str]) -> Expression:
        """Copy of the expression whose parameters are renamed."""
        raise NotImplementedError

    def written(self) -> tuple[str, int]:
        """Text of the expression, and how strongly its outermost operator binds."""
        raise NotImplementedError

    def within(self, level: int) -> str:
        """Text of the expression, in parentheses if it binds less than ``level``."""
        text, own = self.written()
        return f"({text})" if own < level else text

    def __str__(self) -> str:
        return self.written()[0]


@dataclass(frozen=True)
class Number(Expression):
    """Exact number in SI units as part of an expression.

    ``text`` is what was written, for example ``0.46 kN*m/rad``.
    """

    value: Any  # a real number; stored as a Fraction
    unit_dimension: Dimension | None = None
    text: str | None = field(default=None, compare=False)
    names: ClassVar[frozenset[str]] = frozenset()

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", units.exact(self.value))

    @property
    def unit_written(self) -> str:
        """Unit behind the number as the text of the expression has it; empty where there is none.

        >>> Number(460, units.DIMENSIONS["stiffness"], "0.46 kN*m/rad").unit_written
        'kN*m/rad'
        """
        text = (self.text or "").strip()
        number = units.NUMERAL.match(text)
        return text[number.end() :].strip() if number else ""

    def value_in(self, values: Mapping[str, Any], algebra: Algebra = RATIONAL) -> Any:  # noqa: ARG002
        return algebra.number(self.value)

    evaluate = value_in  # that it is finite was seen when it was read

    def renamed(self, name: Callable[[str], str]) -> Expression:  # noqa: ARG002
        return self

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:  # noqa: ARG002
        return "bare" if self.unit_dimension is None else self.unit_dimension

    def written(self) -> tuple[str, int]:
        text = units.numeral_of(self.value)
        return text, _PRODUCT if "/" in text else _UNARY if text.startswith("-") else _ATOM

    def __str__(self) -> str:
        plain = self.written()[0]
        if self.text is not None or self.unit_dimension is None:
            return self.text or plain
        # A quotient cannot stand before a unit; the nearest float can.
        return f"{float(self.value) if '/' in plain else plain} {self.unit_dimension}"


@dataclass(frozen=True)
class Name(Expression):
    """Name of a parameter as part of an expression."""

    name: str

    @cached_property
    def names(self) -> frozenset[str]:
        """Name of the parameter, as a set."""
        return frozenset({self.name})

    def value_in(self, values: Mapping[str, Any], algebra: Algebra) -> Any:  # noqa: ARG002
        return self._look_up(values)

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:
        return self._look_up(dimensions) or "unknown"

    def _look_up(self, mapping: Mapping[str, Any]) -> Any:
        if self.name not in mapping:
            raise ExpressionError(f'no parameter is named "{self.name}"{did_you_mean(self.name, mapping)}')
        return mapping[self.name]

    def renamed(self, name: Callable[[str], str]) -> Expression:
        return Name(name(self.name))

    def written(self) -> tuple[str, int]:
        return self.name, _ATOM


@dataclass(frozen=True)
class Compound(Expression):
    """Operator, function or constant with its operands as part of an expression; ``sign`` is a key of :data:`RULES`."""

    sign: str
    operands: tuple[Expression, ...] = ()

    @cached_property
    def names(self) -> frozenset[str]:
        """Names of all parameters in the operands."""
        return frozenset[str]().union(*(operand.names for operand in self.operands))

    def value_in(self, values: Mapping[str, Any], algebra: Algebra) -> Any:
        value, operands = RULES[self.sign].value, self.operands
        if len(operands) == 2:  # the usual case, without the generator that would take as long as the arithmetic
            first, second = operands
            return value(self, algebra, first.value_in(values, algebra), second.value_in(values, algebra))
        return value(self, algebra, *(operand.value_in(values, algebra) for operand in operands))

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:
        return RULES[self.sign].kind(self, *[operand.kind_of(dimensions) for operand in self.operands])

    def renamed(self, name: Callable[[str], str]) -> Expression:
        return Compound(self.sign, tuple(operand.renamed(name) for operand in self.operands)) if self.names else self

    def written(self) -> tuple[str, int]:
        rule = RULES[self.sign]
        return rule.text(self), rule.strength


@dataclass(frozen=True)
class Rule:
    """Rule of an operator, a function or a constant: how its value, dimension and text follow from the operands.

    ``value(compound, algebra, *values)`` and ``kind(compound, *kinds)`` are of the values and dimensions of the
    operands; ``text(compound)`` is what parses back to it; ``strength`` is how strongly it binds.
    """

    strength: int
    value: Callable[..., Any]
    kind: Callable[..., _Kind]
    text: Callable[[Compound], str]


def _quotient(compound: Compound, _: Algebra, left: Any, right: Any) -> Any:
    _refuse_zero(right, compound.operands[1])
    return float_if_long(left / right)


def _power(compound: Compound, algebra: Algebra, base: Any, _: Any = None) -> Any:
    """Value, in an algebra, of a power, or of a square root, which has no second operand."""
    source, exponent = compound.operands[0], _exponent(compound)
    if exponent < 0:
        _refuse_zero(base, source)
    if exponent.denominator == 1:
        return float_if_long(base**exponent.numerator)
    if isinstance(base, int | float | Fraction) and base < 0:
        raise ExpressionError(f'"{source}" is {float(base):g}; a negative number has no square root here')
    return algebra.sqrt(base) ** exponent.numerator


def _exponent(compound: Compound) -> Any:
    exponent = compound.operands[-1]
    return exponent.value if compound.sign == "**" and isinstance(exponent, Number) else Fraction(1, 2)


def _refuse_zero(value: Any, source: Expression) -> None:
    zero = value == 0
    if getattr(zero, "ndim", 0) == 0 and bool(zero):
        raise ExpressionError(f'division by zero: "{source}" is 0')


def _common_kind(compound: Compound, left: _Kind, right: _Kind) -> _Kind:
    if isinstance(left, Dimension) and isinstance(right, Dimension) and left != right:
        word = "add" if compound.sign == "+" else "subtract"
        raise ExpressionError(f'"{compound}" would {word} {left} and {right}')
    return right if left == "bare" or (left == "unknown" and isinstance(right, Dimension)) else left


def _combined_kind(compound: Compound, left: _Kind, right: _Kind) -> _Kind:
    if "unknown" in (left, right):
        return "unknown"
    if left == right == "bare":
        return "bare"
    first, second = (DIMENSIONS["1"] if isinstance(kind, str) else kind for kind in (left, right))
    return first * second if compound.sign == "*" else first / second


def _raised_kind(compound: Compound, base: _Kind, _: _Kind = "bare") -> _Kind:
    return base if isinstance(base, str) else base ** _exponent(compound)


def _infix(compound: Compound) -> str:
    (first, second), sign = compound.operands, compound.sign
    level = RULES[sign].strength
    left, right = first.within(level), second.within(level + 1)
    if sign == "/" and isinstance(first, Number) and "/" not in left:
        right = _apart(second) or right
    right = f"({right})" if right.startswith("-") else right
    return f"{left} {sign} {right}" if level == _SUM else f"{left}{sign}{right}"


def _raised_text(compound: Compound) -> str:
    # Powers bind from right to left: a base that is a power itself needs the parentheses, too.
    exponent = compound.operands[1].within(_ATOM)
    return f"{compound.operands[0].within(_ATOM)}**{exponent}"


def _apart(operand: Expression) -> str:
    """Numeral with a plus sign, which keeps the parser from merging it with its neighbour; empty for other operands."""
    text, level = operand.written()
    return f"(+{text})" if isinstance(operand, Number) and level == _ATOM else ""


RULES = {
    "+": Rule(_SUM, lambda _, __, left, right: float_if_long(left + right), _common_kind, _infix),
    "-": Rule(_SUM, lambda _, __, left, right: float_if_long(left - right), _common_kind, _infix),
    "*": Rule(_PRODUCT, lambda _, __, left, right: float_if_long(left * right), _combined_kind, _infix),
    "/": Rule(_PRODUCT, _quotient, _combined_kind, _infix),
    "negative": Rule(
        _UNARY,
        lambda _, __, operand: -operand,
        lambda _, kind: kind,
        lambda compound: f"-{_apart(compound.operands[0]) or compound.operands[0].within(_ATOM)}",
    ),
    "**": Rule(_UNARY, _power, _raised_kind, _raised_text),
    "sqrt": Rule(_ATOM, _power, _raised_kind, lambda compound: f"sqrt({compound.operands[0].within(_SUM)})"),
    "pi": Rule(_ATOM, lambda _, algebra: algebra.pi, lambda _: "bare", lambda _: "pi"),
}
"""Rules of operators, functions and constants by their sign; the exponent of a power is whole or half, at most 4."""

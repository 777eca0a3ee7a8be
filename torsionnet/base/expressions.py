"""Expressions of parameters, such as ``2*k_1`` or ``G*pi*d**4/(32*l)``, as immutable trees.

A tree is made of numbers, names and what :data:`RULES` lists, and works in any algebra: exact fractions, floats, or
sympy through an :class:`Algebra` of its own.

>>> half = Compound("/", (Name("k_1"), Number(2)))
>>> str(half), sorted(half.names), half.evaluate({"k_1": Fraction(1)})
('k_1/2', ['k_1'], Fraction(1, 2))

Here as well: range of sizes that numbers may have, and roots that stay exact where they can; piecewise linear
interpolation of tables: exact with slopes, as floats, and in any algebra.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any, ClassVar, Literal, TypeAlias

import torsionnet.base.units as units
from torsionnet.base.errors import Fault, FaultyValueError, UsageError, unknown_name
from torsionnet.base.phrases import phrase
from torsionnet.base.registers import settle
from torsionnet.base.units import DIMENSIONS, Dimension

SMALLEST_SIZE, LARGEST_SIZE = 1e-40, 1e40
"""Smallest and largest size of a value in SI units, as its square must stay in the range of floats."""


def is_beyond_range(value: Any) -> bool:
    """Whether a value is too small or too large for anything in a drivetrain; 0 is allowed.

    >>> is_beyond_range(1e300), is_beyond_range(0.0)
    (True, False)
    """
    return bool(value) and not SMALLEST_SIZE < abs(value) < LARGEST_SIZE


MOST_BITS = 4096
"""Largest number of bits of an exact fraction, as powers of powers would double them without end; a float has all the
digits that matter."""


def float_if_long(value: Any) -> Any:
    """Number unchanged, but as a float where it is an exact fraction of too many digits."""
    if isinstance(value, Fraction) and value.numerator.bit_length() + value.denominator.bit_length() > MOST_BITS:
        return float(value)
    return value


_UNITS = {1: Fraction(1), -1: Fraction(-1)}


def exact(number: Any) -> Fraction:
    """Exact fraction of a number as written: 0.1 becomes 1/10, not its binary neighbour."""
    if type(number) is int and number in _UNITS:
        return _UNITS[number]
    return (
        number
        if isinstance(number, Fraction)
        else Fraction(repr(float(number)))
        if isinstance(number, float)
        else Fraction(number)
    )


def exact_sqrt(value: Fraction | float) -> Fraction | float:
    """Square root of a number, as a fraction where the root is one."""
    if value < 0:
        raise ArithmeticError(f"the square root of {float(value):.4g} is not real; check the signs of the values")
    if not isinstance(value, Fraction | int):
        return math.sqrt(value)
    # In lowest terms a fraction has a rational root where both parts are squares.
    root = Fraction(math.isqrt(value.numerator), math.isqrt(value.denominator))
    return root if root * root == value else math.sqrt(value)


_SUM, _PRODUCT, _UNARY, _ATOM = 1, 2, 3, 4
_Kind = Dimension | Literal["bare", "unknown"]


class ExpressionError(FaultyValueError):
    """Error of an expression that cannot be read or evaluated; ``offset`` is the column from 0, or None."""

    def __init__(self, fault: str | Fault, offset: int | None = None, *, kind: str = "") -> None:
        super().__init__(fault, kind=kind)
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
            raise ExpressionError(
                Fault(phrase('division in "{}" by a value that is too small', self), kind="not-finite")
            ) from None
        if not finite:
            raise ExpressionError(Fault(phrase('the value of "{}" is too large', self), kind="not-finite"))
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

    def in_names(self, name: Callable[[str], str]) -> str:
        """Text of the expression whose parameters are renamed."""
        return str(self.renamed(name))

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
        settle(self, value=units.exact(self.value))

    @property
    def unit_written(self) -> str:
        """Unit behind the number as the text of the expression has it; empty where there is none.

        >>> Number(460, units.DIMENSIONS["stiffness"], "0.46 kN*m/rad").unit_written
        'kN*m/rad'
        """
        text = (self.text or "").strip()
        number = units.NUMERAL.match(text)
        return text[number.end() :].strip() if number else ""

    @property
    def has_angle(self) -> bool:
        """Whether the unit of the number is of an angle or per angle, as the text has it."""
        return units.has_angle(self.unit_written)

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
        if self.name not in values:
            raise self._unknown(values)
        return values[self.name]

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:
        if self.name not in dimensions:
            raise self._unknown(dimensions)
        return dimensions[self.name] or "unknown"

    def _unknown(self, known: Mapping[str, Any]) -> ExpressionError:
        return ExpressionError(unknown_name("parameter", self.name, known, ()))

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
        said = '"{}" is {:g}; a negative number has no square root here'
        raise ExpressionError(Fault(phrase(said, source, float(base)), kind="incalculable-value"))
    # x^(n/2) = sqrt(x)^n.
    return algebra.sqrt(base) ** exponent.numerator


def _exponent(compound: Compound) -> Any:
    exponent = compound.operands[-1]
    return exponent.value if compound.sign == "**" and isinstance(exponent, Number) else Fraction(1, 2)


def _refuse_zero(value: Any, source: Expression) -> None:
    zero = value == 0
    if getattr(zero, "ndim", 0) == 0 and bool(zero):
        raise ExpressionError(Fault(phrase('division by zero: "{}" is 0', source), kind="incalculable-value"))


def _common_kind(compound: Compound, left: _Kind, right: _Kind) -> _Kind:
    if isinstance(left, Dimension) and isinstance(right, Dimension) and left != right:
        word = "add" if compound.sign == "+" else "subtract"
        raise ExpressionError(Fault(phrase('"{}" would {} {} and {}', compound, word, left, right), kind="wrong-unit"))
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


Rows: TypeAlias = tuple[tuple[Number, ...], ...]
"""Type of the rows of numbers of a table, sorted by their first column."""


def outside_message(rows: Rows, at: Any) -> str:
    """Message that a value lies outside a table, or an empty text."""
    if rows[0][0].value <= at <= rows[-1][0].value:
        return ""
    return f"the table goes from {rows[0][0]} to {rows[-1][0]}"


def value_at(rows: Rows, at: Any, column: int = 1) -> Any:
    """Value of a column of a table, interpolated at ``at``, a number of any algebra with an order.

    It lies in the table.

    >>> rows = ((Number(Fraction(1)), Number(Fraction(10))), (Number(Fraction(3)), Number(Fraction(30))))
    >>> value_at(rows, Fraction("2.5")), slope_at(rows, 2.5)
    (Fraction(25, 1), Fraction(10, 1))
    """
    lower = _piece(rows, at)[0]
    return slope_at(rows, at, column) * (at - lower[0].value) + lower[column].value


def slope_at(rows: Rows, at: Any, column: int = 1) -> Fraction:
    """Slope of a column of a table over the first column at ``at``.

    At a row that of the piece above it, at the last row that of the last piece.
    """
    lower, upper = _piece(rows, at)
    return Fraction((upper[column].value - lower[column].value) / (upper[0].value - lower[0].value))


def _piece(rows: Rows, at: Any) -> tuple[tuple[Number, ...], tuple[Number, ...]]:
    place = _place([row[0].value for row in rows], at)
    return rows[place - 1], rows[place]


def _place(keys: Sequence[Any], at: Any) -> int:
    """Index of the table row that ends the piece on which ``at`` lies."""
    return min(max(bisect_right(keys, at), 1), len(keys) - 1)


def interpolate_float(rows: Rows, at: float) -> float:
    """Value of a table's second column as a float, interpolated at ``at``.

    Outside by no more than a rounding error is allowed.

    Raises
    ------
    UsageError
        It lies outside.

    >>> rows = ((Number(1), Number(10)), (Number(3), Number(30)))
    >>> interpolate_float(rows, 2.5)
    25.0
    """
    keys = [float(row[0].value) for row in rows]
    # What came out of a division may miss the last row by rounding.
    slack = 1e-9 * keys[-1]
    if not keys[0] - slack <= at <= keys[-1] + slack:
        raise UsageError(f"the table goes from {rows[0][0]} to {rows[-1][0]}", kind="out-of-range")
    place = _place(keys, at)
    before, after = keys[place - 1 : place + 1]
    lower, upper = (float(row[1].value) for row in rows[place - 1 : place + 1])
    return lower + (upper - lower) * (at - before) / (after - before)


def interpolate_in_algebra(rows: Rows, at: Any, algebra: Algebra) -> Any:
    """Value of a table's second column as a number of ``algebra``, interpolated at ``at``.

    Beyond the ends that of the nearest row.

    A sum of ramps, (x - x_i + |x - x_i|)/2 times the change of slope at each row, needs no comparison and so works for
    symbols and for numbers with derivatives; at a row the derivative is the mean of both sides.

    Examples
    --------
    >>> from torsionnet.base.expressions import RATIONAL
    >>> rows = ((Number(1), Number(10)), (Number(3), Number(30)), (Number(4), Number(0)))
    >>> [int(interpolate_in_algebra(rows, Fraction(x), RATIONAL)) for x in (0, 2, 3, 5)]
    [10, 20, 30, 0]
    """
    total, slope = algebra.number(rows[0][1].value), Fraction(0)
    for place, (key, level) in enumerate(rows):
        following = rows[place + 1] if place + 1 < len(rows) else None
        ahead = (following[1].value - level.value) / (following[0].value - key.value) if following else Fraction(0)
        if ahead != slope:
            beyond = at - algebra.number(key.value)
            # The ramp beyond a row is (x - x_i + sqrt((x - x_i)^2))/2.
            total = total + algebra.number((ahead - slope) / 2) * (beyond + algebra.sqrt(beyond**2))
        slope = ahead
    return total

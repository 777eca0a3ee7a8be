"""Expressions of parameters, such as ``2*k_1`` or ``G*pi*d**4/(32*l)``, read through a whitelist.

``ast`` only takes the text apart; nothing is ever compiled or evaluated by Python. The tree has seven kinds of nodes,
is immutable and works in any algebra: exact fractions, floats, or sympy through an :class:`Algebra` of its own.

>>> half = parse_expression("k_1/2 + 3*k_2")
>>> sorted(half.names), half.evaluate({"k_1": Fraction(1), "k_2": Fraction(1, 3)})
(['k_1', 'k_2'], Fraction(3, 2))
>>> scalar("0.46 kN*m/rad").evaluate({})
Fraction(460, 1)
"""

from __future__ import annotations

import ast
import keyword
import math
import numbers
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any, ClassVar, Literal

import torsionnet.core.units as units
from torsionnet.core.errors import TorsionnetError, did_you_mean
from torsionnet.core.units import DIMENSIONS, NUMERAL, Dimension, UnitError

RESERVED_NAMES = frozenset({"s", "omega", "ground", "pi", "sqrt"})
_MAX_LENGTH, _MAX_NODES, _MAX_DEPTH, _MAX_EXPONENT = 200, 60, 20, 4
_SUM, _PRODUCT, _UNARY, _ATOM = 1, 2, 3, 4
_Kind = Dimension | Literal["bare", "unknown"]


class ExpressionError(TorsionnetError, ValueError):
    """An expression that cannot be read or evaluated; ``offset`` is the column in the text, from 0, or None."""

    def __init__(self, message: str, offset: int | None = None) -> None:
        super().__init__(message)
        self.offset = offset


@dataclass(frozen=True)
class Algebra:
    """What an expression is evaluated in: how numbers enter, and the two things that are not arithmetic."""

    number: Callable[[Fraction], Any]
    sqrt: Callable[[Any], Any]
    pi: Any


RATIONAL = Algebra(number=lambda number: number, sqrt=units.exact_sqrt, pi=math.pi)
FLOAT = Algebra(number=float, sqrt=math.sqrt, pi=math.pi)


@dataclass(frozen=True)
class Expression:
    """A tree of numbers, names and arithmetic; ``str`` gives a text that parses back to an equal tree."""

    @cached_property
    def names(self) -> frozenset[str]:
        """Give the names of all parameters in the expression."""
        return frozenset[str]().union(*(part.names for part in self.parts()))

    def evaluate(self, values: Mapping[str, Any], algebra: Algebra = RATIONAL) -> Any:
        """Calculate the value in an algebra; raises :class:`ExpressionError`, also for results beyond a float."""
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
        """Derive the dimension; None is a bare number, or a product with a parameter of unknown dimension."""
        kind = self.kind_of(dimensions)
        return kind if isinstance(kind, Dimension) else None

    def parts(self) -> tuple[Expression, ...]:
        """Give the operands."""
        return ()

    def value_in(self, values: Mapping[str, Any], algebra: Algebra) -> Any:
        """Calculate the value of this node."""
        raise NotImplementedError

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:
        """Tell the dimension, and for None which of the two it is: a bare number or unknown."""
        raise NotImplementedError

    def written(self) -> tuple[str, int]:
        """Give the text and how strongly its outermost operator binds."""
        raise NotImplementedError

    def within(self, level: int) -> str:
        """Give the text, in parentheses if it binds less than ``level``."""
        text, own = self.written()
        return f"({text})" if own < level else text

    def __str__(self) -> str:
        return self.written()[0]


@dataclass(frozen=True)
class Number(Expression):
    """An exact number in SI units; ``text`` is what was written, for example ``0.46 kN*m/rad``."""

    value: Any  # a real number; stored as a Fraction
    unit_dimension: Dimension | None = None
    text: str | None = field(default=None, compare=False)
    names: ClassVar[frozenset[str]] = frozenset()

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", units.exact(self.value))

    def value_in(self, values: Mapping[str, Any], algebra: Algebra = RATIONAL) -> Any:  # noqa: ARG002
        return algebra.number(self.value)

    evaluate = value_in  # that it is finite was seen when it was read

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
    """A parameter."""

    name: str

    @cached_property
    def names(self) -> frozenset[str]:
        """Give the name itself."""
        return frozenset({self.name})

    def value_in(self, values: Mapping[str, Any], algebra: Algebra) -> Any:  # noqa: ARG002
        return self._look_up(values)

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:
        return self._look_up(dimensions) or "unknown"

    def _look_up(self, mapping: Mapping[str, Any]) -> Any:
        if self.name not in mapping:
            raise ExpressionError(f'no parameter is named "{self.name}"{did_you_mean(self.name, mapping)}')
        return mapping[self.name]

    def written(self) -> tuple[str, int]:
        return self.name, _ATOM


@dataclass(frozen=True)
class Pi(Expression):
    """The constant pi."""

    def value_in(self, values: Mapping[str, Any], algebra: Algebra) -> Any:  # noqa: ARG002
        return algebra.pi

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:  # noqa: ARG002
        return "bare"

    def written(self) -> tuple[str, int]:
        return "pi", _ATOM


@dataclass(frozen=True)
class Negative(Expression):
    """The operand with its sign turned."""

    operand: Expression

    def parts(self) -> tuple[Expression, ...]:
        return (self.operand,)

    def value_in(self, values: Mapping[str, Any], algebra: Algebra) -> Any:
        return -self.operand.value_in(values, algebra)

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:
        return self.operand.kind_of(dimensions)

    def written(self) -> tuple[str, int]:
        return f"-{_apart(self.operand) or self.operand.within(_ATOM)}", _UNARY


@dataclass(frozen=True)
class Binary(Expression):
    """A sum, difference, product or quotient."""

    operator: Literal["+", "-", "*", "/"]
    left: Expression
    right: Expression

    def parts(self) -> tuple[Expression, ...]:
        return (self.left, self.right)

    def value_in(self, values: Mapping[str, Any], algebra: Algebra) -> Any:
        left, right = self.left.value_in(values, algebra), self.right.value_in(values, algebra)
        if self.operator == "/":
            _refuse_zero(right, self.right)
            return units.limited(left / right)
        return units.limited(
            left * right if self.operator == "*" else left + right if self.operator == "+" else left - right
        )

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:
        left, right = self.left.kind_of(dimensions), self.right.kind_of(dimensions)
        if self.operator in "+-":
            return self._common(left, right)
        if "unknown" in (left, right):
            return "unknown"
        if left == right == "bare":
            return "bare"
        first, second = (DIMENSIONS["1"] if isinstance(kind, str) else kind for kind in (left, right))
        return first * second if self.operator == "*" else first / second

    def _common(self, left: _Kind, right: _Kind) -> _Kind:
        if isinstance(left, Dimension) and isinstance(right, Dimension) and left != right:
            word = "add" if self.operator == "+" else "subtract"
            raise ExpressionError(f'"{self}" would {word} {left} and {right}')
        return right if left == "bare" or (left == "unknown" and isinstance(right, Dimension)) else left

    def written(self) -> tuple[str, int]:
        level = _SUM if self.operator in "+-" else _PRODUCT
        left, right = self.left.within(level), self.right.within(level + 1)
        if self.operator == "/" and isinstance(self.left, Number) and "/" not in left:
            right = _apart(self.right) or right
        right = f"({right})" if right.startswith("-") else right
        return (f"{left} {self.operator} {right}" if level == _SUM else f"{left}{self.operator}{right}"), level


@dataclass(frozen=True)
class Power(Expression):
    """A power with a number as exponent: whole or half, at most 4."""

    base: Expression
    exponent: int | Fraction

    def parts(self) -> tuple[Expression, ...]:
        return (self.base,)

    def value_in(self, values: Mapping[str, Any], algebra: Algebra) -> Any:
        base, exponent = self.base.value_in(values, algebra), Fraction(self.exponent)
        if exponent < 0:
            _refuse_zero(base, self.base)
        if exponent.denominator == 1:
            return units.limited(base**exponent.numerator)
        if isinstance(base, int | float | Fraction) and base < 0:
            raise ExpressionError(f'"{self.base}" is {float(base):g}; a negative number has no square root here')
        return algebra.sqrt(base) ** exponent.numerator

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:
        kind = self.base.kind_of(dimensions)
        return kind if isinstance(kind, str) else kind**self.exponent

    def written(self) -> tuple[str, int]:
        exponent = units.numeral_of(Fraction(self.exponent))
        # Powers bind from right to left: a base that is a power itself needs the parentheses, too.
        return f"{self.base.within(_ATOM)}**{f'({exponent})' if self.exponent < 0 else exponent}", _UNARY


@dataclass(frozen=True)
class SquareRoot(Expression):
    """The square root."""

    operand: Expression

    def parts(self) -> tuple[Expression, ...]:
        return (self.operand,)

    def value_in(self, values: Mapping[str, Any], algebra: Algebra) -> Any:
        return Power(self.operand, Fraction(1, 2)).value_in(values, algebra)

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:
        return Power(self.operand, Fraction(1, 2)).kind_of(dimensions)

    def written(self) -> tuple[str, int]:
        return f"sqrt({self.operand.within(_SUM)})", _ATOM


def _refuse_zero(value: Any, source: Expression) -> None:
    zero = value == 0
    if getattr(zero, "ndim", 0) == 0 and bool(zero):
        raise ExpressionError(f'division by zero: "{source}" is 0')


def _apart(operand: Expression) -> str:
    """Write a numeral with a plus sign, which keeps the parser from making one number of it and its neighbour."""
    text, level = operand.written()
    return f"(+{text})" if isinstance(operand, Number) and level == _ATOM else ""


_CHARACTERS = re.compile(r"[A-Za-z0-9_+\-*/(). ^]*")
_PIECE = re.compile(rf"(?P<number>{NUMERAL.pattern.replace('([+-]?)', '()', 1)})|(?P<name>[A-Za-z_][A-Za-z0-9_]*)|.")
_OPERATION = re.compile(r"\s*[-+*/^()]")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_OPERATORS: dict[type[ast.operator], Literal["+", "-", "*", "/"]] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}  # fmt: skip


def check_name(name: str) -> str | None:
    """Tell why a name cannot be that of a parameter, or None if it can.

    >>> check_name("k_1"), check_name("omega")
    (None, '"omega" is reserved')
    """
    if not _NAME.fullmatch(name):
        return f'"{name}" is no name: a letter comes first, then letters, digits and _ (no accents)'
    if name.lower() in ("nan", "inf", "infinity"):
        return f'"{name}" is no finite number'
    if keyword.iskeyword(name):
        return f'"{name}" is a word of the Python language'
    return f'"{name}" is reserved' if name in RESERVED_NAMES else None


@lru_cache(maxsize=4096)
def parse_expression(text: str) -> Expression:
    """Read an expression without units; raises :class:`ExpressionError` with the offset of the fault.

    Allowed are ``+ - * /``, ``**`` (or ``^``) with an exponent that is whole or half and at most 4, parentheses,
    ``sqrt``, ``pi``, decimal numbers, taken exactly, and names of parameters.

    >>> str(parse_expression("G*pi*d^4/(32*l)"))
    'G*pi*d**4/(32*l)'
    >>> parse_expression("k.real")
    Traceback (most recent call last):
    torsionnet.core.expressions.ExpressionError: "k.real" at column 2: "." stands only in decimal numbers
    """
    try:
        return _Reader(text).expression()
    except (ExpressionError, UnitError) as error:
        offset = error.offset if isinstance(error, ExpressionError) else None
        where = "" if offset is None else f" at column {offset + 1}"
        raise ExpressionError(f'"{_short(text)}"{where}: {error}', offset) from None


def _short(text: str) -> str:
    return text if len(text) <= _MAX_LENGTH else text[:40] + "..."


class _Reader:
    """Turns one text into a tree; ``columns`` leads from its source, with ``**`` for ``^``, back to the text."""

    def __init__(self, text: str) -> None:
        if not 0 < len(text.strip()) <= len(text) <= _MAX_LENGTH:
            raise ExpressionError(f"an expression has 1 to {_MAX_LENGTH} characters, not {len(text)}")
        blanks = len(text) - len(text.lstrip())
        self.source, self.nodes = text.strip().replace("^", "**"), 0
        self.columns = [blanks + i for i, sign in enumerate(text[blanks:]) for _ in range(1 + (sign == "^"))]
        self.check_pieces()

    def fault(self, message: str, node: ast.expr | int) -> ExpressionError:
        column = node if isinstance(node, int) else node.col_offset
        return ExpressionError(message, self.columns[min(column, len(self.columns) - 1)])

    def check_pieces(self) -> None:
        """Refuse by character and word what ``ast`` need not see, or would only call a syntax error."""
        good = _CHARACTERS.match(self.source)
        if good and good.end() < len(self.source):
            raise self.fault(f'"{self.source[good.end()]}" is not allowed in an expression', good.end())
        operand = False
        for piece in _PIECE.finditer(self.source):
            kind, found, start = piece.lastgroup, piece[0], piece.start()
            if kind and operand:
                raise self.fault(f'an operator is missing before "{found}"; a product is written with *', start)
            reason = check_name(found) if kind == "name" and found not in ("pi", "sqrt") else None
            if reason:
                raise self.fault(reason, start)
            if kind == "number":
                self.number(found, start)
            if found == ".":
                raise self.fault('"." stands only in decimal numbers', start)
            operand = bool(kind) or found == ")" or (operand and found == " ")

    def number(self, numeral: str, start: int) -> Number:
        try:
            return Number(units.parse_number(numeral))
        except UnitError as error:
            raise self.fault(str(error), start) from None

    def expression(self) -> Expression:
        try:
            return self.read(ast.parse(self.source, mode="eval").body, 0)
        except SyntaxError as error:
            raise self.fault("this is no complete expression", (error.offset or len(self.source)) - 1) from None
        except (RecursionError, MemoryError):
            raise ExpressionError("the expression is too deeply nested") from None

    def read(self, node: ast.expr, depth: int) -> Expression:
        self.nodes += 1
        if depth > _MAX_DEPTH or self.nodes > _MAX_NODES:
            limit = f"{_MAX_DEPTH} levels" if depth > _MAX_DEPTH else f"{_MAX_NODES} numbers, names and operators"
            raise self.fault(f"the expression has more than {limit}", node)
        if isinstance(node, ast.Constant):
            return self.number(self.source[node.col_offset : node.end_col_offset], node.col_offset)
        if isinstance(node, ast.Name) and node.id != "sqrt":
            return Pi() if node.id == "pi" else Name(node.id)
        if isinstance(node, ast.UnaryOp):
            return self.signed(node, depth)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
            return self.power(node, depth)
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            return self.binary(node, depth)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "sqrt" and node.args:
            return SquareRoot(self.read(node.args[0], depth + 1))
        raise self.fault("allowed are numbers, names, + - * / **, sqrt(x) and pi; nothing else can be called", node)

    def signed(self, node: ast.UnaryOp, depth: int) -> Expression:
        operand = self.read(node.operand, depth + 1)
        if isinstance(node.op, ast.UAdd):
            return operand
        if isinstance(node.operand, ast.Constant) and isinstance(operand, Number):
            return Number(-operand.value)
        return Negative(operand)

    def binary(self, node: ast.BinOp, depth: int) -> Expression:
        # A long sum leans to the left; it is not nested more deeply for that.
        left = self.read(node.left, depth if isinstance(node.left, ast.BinOp) else depth + 1)
        right = self.read(node.right, depth + 1)
        literals = isinstance(node.right, ast.Constant) and not isinstance(node.left, ast.BinOp)
        if literals and isinstance(node.op, ast.Div) and isinstance(left, Number) and right != Number(0):
            return Number(Fraction(left.value) / right.value_in({}, RATIONAL))
        return Binary(_OPERATORS[type(node.op)], left, right)

    def power(self, node: ast.BinOp, depth: int) -> Expression:
        base, exponent = self.read(node.left, depth + 1), self.read(node.right, depth + 1)
        value = Fraction(exponent.value) if isinstance(exponent, Number) else None
        if value is None or value.denominator not in (1, 2) or abs(value) > _MAX_EXPONENT:
            raise self.fault(f"an exponent is a whole or half number of at most {_MAX_EXPONENT}", node.right)
        if _has_power(base):
            raise self.fault("a power of a power is not allowed", node)
        return Power(base, value)


def _has_power(tree: Expression) -> bool:
    return isinstance(tree, Power) or any(_has_power(part) for part in tree.parts())


def scalar(value: object) -> Expression:
    """Take anything a model value may be given as; raises :class:`ExpressionError` for everything else.

    A float is taken for the decimal it is written as; a text is a number, a quantity or an expression; a pint
    quantity is read by its unit.

    >>> scalar(0.1), str(scalar("0.46 kN*m/rad")), str(scalar("2*k_1"))
    (Number(value=Fraction(1, 10), unit_dimension=None, text=None), '0.46 kN*m/rad', '2*k_1')
    >>> scalar("2 k_1")
    Traceback (most recent call last):
    torsionnet.core.expressions.ExpressionError: "k_1" is not a known unit; if it is a parameter, write 2*k_1
    """
    if isinstance(value, Expression):
        return value
    try:
        return _from_text(value) if isinstance(value, str) else _from_object(value)
    except UnitError as error:
        raise ExpressionError(str(error)) from None


def _from_object(value: Any) -> Expression:
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        return Number(value)
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        return _from_quantity(units.read_pint(value))
    got = str(value).lower() if isinstance(value, bool) else _short(repr(value))
    raise ExpressionError(f"expected a number, got {got}")


def _from_text(text: str) -> Expression:
    written = text.strip()
    numeral = NUMERAL.match(written)
    if numeral is None or _OPERATION.match(written, numeral.end()):
        return parse_expression(text)
    rest = written[numeral.end() :].strip()
    try:
        return _from_quantity(units.parse_quantity(written))
    except UnitError as error:
        if not _NAME.fullmatch(rest) or check_name(rest) or "did you mean" in str(error):
            raise
        raise ExpressionError(f"{error}; if it is a parameter, write {numeral[0]}*{rest}") from None


def _from_quantity(given: units.Quantity) -> Expression:
    return Number(given.value, given.dimension, given.text)

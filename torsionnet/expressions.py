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
from typing import Any, Literal

from torsionnet.errors import TorsionnetError, did_you_mean
from torsionnet.units import DIMENSIONS, NUMERAL, Dimension, UnitError, parse_number, parse_quantity

RESERVED_NAMES = frozenset({"s", "omega", "ground", "pi", "sqrt", "inf", "nan"})
_MAX_LENGTH, _MAX_NODES, _MAX_DEPTH, _MAX_EXPONENT = 200, 60, 20, 4
_SUM, _PRODUCT, _UNARY, _ATOM = 1, 2, 3, 4
_Kind = Dimension | Literal["bare", "unknown"]


class ExpressionError(TorsionnetError, ValueError):
    """An expression that cannot be read or evaluated; ``offset`` is the column in the text, from 0, or None."""

    def __init__(self, message: str, offset: int | None = None) -> None:
        super().__init__(message)
        self.offset = offset


def _exact_sqrt(value: Fraction | float) -> Fraction | float:
    if isinstance(value, Fraction):
        root = Fraction(math.isqrt(value.numerator), math.isqrt(value.denominator))
        return root if root * root == value else math.sqrt(value)
    return math.sqrt(value)


@dataclass(frozen=True)
class Algebra:
    """What an expression is evaluated in: how numbers enter, and the two things that are not arithmetic."""

    number: Callable[[Fraction], Any]
    sqrt: Callable[[Any], Any]
    pi: Any


RATIONAL = Algebra(number=Fraction, sqrt=_exact_sqrt, pi=math.pi)
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
            if isinstance(result, int | float | Fraction) and not math.isfinite(result):
                raise OverflowError
        except OverflowError:
            raise ExpressionError(f'the value of "{self}" is too large') from None
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

    value: Fraction | float
    unit_dimension: Dimension | None = None
    text: str | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", _fraction(self.value))

    def value_in(self, values: Mapping[str, Any], algebra: Algebra) -> Any:  # noqa: ARG002
        return algebra.number(Fraction(self.value))

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:  # noqa: ARG002
        return "bare" if self.unit_dimension is None else self.unit_dimension

    def written(self) -> tuple[str, int]:
        text = _numeral(Fraction(self.value))
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
            return left / right
        return left * right if self.operator == "*" else left + right if self.operator == "+" else left - right

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
        return (base if exponent.denominator == 1 else _root(base, self.base, algebra)) ** exponent.numerator

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:
        kind = self.base.kind_of(dimensions)
        return kind if isinstance(kind, str) else kind**self.exponent

    def written(self) -> tuple[str, int]:
        exponent = _numeral(Fraction(self.exponent))
        # Powers bind from right to left: a base that is a power itself needs the parentheses, too.
        return f"{self.base.within(_ATOM)}**{f'({exponent})' if self.exponent < 0 else exponent}", _UNARY


@dataclass(frozen=True)
class SquareRoot(Expression):
    """The square root."""

    operand: Expression

    def parts(self) -> tuple[Expression, ...]:
        return (self.operand,)

    def value_in(self, values: Mapping[str, Any], algebra: Algebra) -> Any:
        return _root(self.operand.value_in(values, algebra), self.operand, algebra)

    def kind_of(self, dimensions: Mapping[str, Dimension | None]) -> _Kind:
        kind = self.operand.kind_of(dimensions)
        return kind if isinstance(kind, str) else kind ** Fraction(1, 2)

    def written(self) -> tuple[str, int]:
        return f"sqrt({self.operand.within(_SUM)})", _ATOM


def _root(value: Any, source: Expression, algebra: Algebra) -> Any:
    if isinstance(value, int | float | Fraction) and value < 0:
        raise ExpressionError(f'"{source}" is {float(value):g}; the square root of a negative number is no number')
    return algebra.sqrt(value)


def _refuse_zero(value: Any, source: Expression) -> None:
    zero = value == 0
    if getattr(zero, "ndim", 0) == 0 and bool(zero):
        raise ExpressionError(f'division by zero: "{source}" is 0')


def _apart(operand: Expression) -> str:
    """Write a numeral with a plus sign, which keeps the parser from making one number of it and its neighbour."""
    text, level = operand.written()
    return f"(+{text})" if isinstance(operand, Number) and level == _ATOM else ""


def _fraction(value: Fraction | float) -> Fraction:
    """Take a float for the shortest decimal that gives it: 0.1 is 1/10."""
    try:
        finite = math.isfinite(value)
    except OverflowError:
        finite = False
    if not finite:
        raise ExpressionError(f"expected a finite number, got {value if isinstance(value, float) else 'a huge one'}")
    if isinstance(value, Fraction | int):
        return Fraction(value)
    return Fraction(float.__repr__(float(value)))


def _numeral(value: Fraction) -> str:
    if value.denominator == 1 and abs(value) < 10**16:
        return str(value)
    short = repr(float(value))
    return short if Fraction(short) == value else str(value)


_CHARACTERS = re.compile(r"[A-Za-z0-9_+\-*/(). ^]*")
_PIECE = re.compile(rf"(?P<number>{NUMERAL.pattern.replace('([+-]?)', '()', 1)})|(?P<name>[A-Za-z_][A-Za-z0-9_]*)|.")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_OPERATORS: dict[type[ast.operator], Literal["+", "-", "*", "/"]] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}  # fmt: skip


def check_name(name: str) -> str | None:
    """Tell why a name cannot be that of a parameter, or None if it can.

    >>> check_name("k_1")
    >>> check_name("omega")
    '"omega" is reserved'
    """
    if not _NAME.fullmatch(name):
        return f'"{name}" is no name: a letter comes first, then letters, digits and _ (no accents)'
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
    torsionnet.expressions.ExpressionError: "k.real" at column 2: "." stands only in decimal numbers
    """
    try:
        return _Reader(text).expression()
    except ExpressionError as error:
        where = f' at column {error.offset + 1}' if error.offset is not None else ""
        raise ExpressionError(f'"{_short(text)}"{where}: {error}', error.offset) from None


def _short(text: str) -> str:
    return text if len(text) <= _MAX_LENGTH else text[:40] + "..."


class _Reader:
    """Turns one text into a tree; ``^`` is replaced first, so columns are mapped back for messages."""

    def __init__(self, text: str) -> None:
        self.text, self.source, self.nodes = text, text.strip().replace("^", "**"), 0
        if not self.source:
            raise ExpressionError("the expression is empty")
        if len(text) > _MAX_LENGTH:
            raise ExpressionError(f"an expression has at most {_MAX_LENGTH} characters")
        self.check_pieces()

    def fault(self, message: str, node: ast.expr | int) -> ExpressionError:
        column = node if isinstance(node, int) else node.col_offset
        offset = len(self.text) - len(self.text.lstrip())
        for character in self.text.strip():
            column -= 2 if character == "^" else 1
            if column < 0:
                break
            offset += 1
        return ExpressionError(message, offset)

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
            if kind == "name":
                self.check_word(found, start)
            elif piece["number"]:
                self.number(found, start)
            elif found == ".":
                raise self.fault('"." stands only in decimal numbers', start)
            operand = found == ")" or bool(kind) or (operand and found == " ")

    def check_word(self, word: str, start: int) -> None:
        if word.lower() in ("nan", "inf", "infinity"):
            raise self.fault(f'"{word}" is no finite number', start)
        reason = None if word in ("pi", "sqrt") else check_name(word)
        if reason:
            raise self.fault(reason, start)

    def number(self, numeral: str, start: int) -> Number:
        match = NUMERAL.fullmatch(numeral)
        try:
            return Number(parse_number(match)) if match else Number(0)
        except (UnitError, ExpressionError) as error:
            raise self.fault(str(error), start) from None

    def expression(self) -> Expression:
        try:
            tree = ast.parse(self.source, mode="eval")
        except SyntaxError as error:
            column = min((error.offset or 1) - 1, len(self.source))
            raise self.fault("this is no complete expression", max(column, 0)) from None
        except (ValueError, RecursionError, MemoryError):
            raise ExpressionError("the expression is too deeply nested") from None
        return self.read(tree.body, 0)

    def read(self, node: ast.expr, depth: int) -> Expression:
        self.nodes += 1
        if depth > _MAX_DEPTH or self.nodes > _MAX_NODES:
            limit = f"{_MAX_DEPTH} levels" if depth > _MAX_DEPTH else f"{_MAX_NODES} numbers, names and operators"
            raise self.fault(f"the expression has more than {limit}", node)
        if isinstance(node, ast.Constant):
            return self.number(self.source[node.col_offset : node.end_col_offset], node.col_offset)
        if isinstance(node, ast.Name):
            return self.name(node)
        if isinstance(node, ast.UnaryOp):
            return self.signed(node, depth)
        if isinstance(node, ast.BinOp):
            return self.power(node, depth) if isinstance(node.op, ast.Pow) else self.binary(node, depth)
        if isinstance(node, ast.Call):
            return self.root(node, depth)
        raise self.fault("only numbers, names, + - * / **, sqrt and pi are allowed", node)

    def name(self, node: ast.Name) -> Expression:
        if node.id == "sqrt":
            raise self.fault("sqrt needs its operand in parentheses", node)
        return Pi() if node.id == "pi" else Name(node.id)

    def signed(self, node: ast.UnaryOp, depth: int) -> Expression:
        operand = self.read(node.operand, depth + 1)
        if isinstance(node.op, ast.UAdd):
            return operand
        if isinstance(node.operand, ast.Constant) and isinstance(operand, Number):
            return Number(-operand.value)
        return Negative(operand)

    def binary(self, node: ast.BinOp, depth: int) -> Expression:
        if type(node.op) not in _OPERATORS:
            raise self.fault("only the operators + - * / ** are allowed", node)
        # A long sum leans to the left; it is not nested more deeply for that.
        left = self.read(node.left, depth if isinstance(node.left, ast.BinOp) else depth + 1)
        right = self.read(node.right, depth + 1)
        if isinstance(node.op, ast.Div) and _is_literal(node.left) and isinstance(node.right, ast.Constant):
            if isinstance(left, Number) and isinstance(right, Number) and right.value:
                return Number(Fraction(left.value) / Fraction(right.value))
        return Binary(_OPERATORS[type(node.op)], left, right)

    def power(self, node: ast.BinOp, depth: int) -> Expression:
        base, exponent = self.read(node.left, depth + 1), self.read(node.right, depth + 1)
        if not isinstance(exponent, Number) or (2 * exponent.value) % 1 or abs(exponent.value) > _MAX_EXPONENT:
            raise self.fault(f"an exponent is a whole or half number of at most {_MAX_EXPONENT}", node.right)
        if _has_power(base):
            raise self.fault("a power of a power is not allowed", node)
        return Power(base, Fraction(exponent.value))

    def root(self, node: ast.Call, depth: int) -> Expression:
        if not isinstance(node.func, ast.Name) or node.func.id != "sqrt":
            raise self.fault("only sqrt can be called; a product is written with *", node)
        if len(node.args) != 1 or node.keywords or isinstance(node.args[0], ast.Starred):
            raise self.fault("sqrt has one operand", node)
        return SquareRoot(self.read(node.args[0], depth + 1))


def _is_literal(node: ast.expr) -> bool:
    inner = node.operand if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub) else node
    return isinstance(inner, ast.Constant)


def _has_power(tree: Expression) -> bool:
    return isinstance(tree, Power) or any(_has_power(part) for part in tree.parts())


_OPERATION = re.compile(r"\s*[-+*/^()]")


def scalar(value: object) -> Expression:
    """Take anything a model value may be given as; raises :class:`ExpressionError` for everything else.

    A float is taken for the decimal it is written as; a text is a number, a quantity or an expression; a pint
    quantity is read by its unit.

    >>> scalar(0.1), str(scalar("0.46 kN*m/rad")), str(scalar("2*k_1"))
    (Number(value=Fraction(1, 10), unit_dimension=None, text=None), '0.46 kN*m/rad', '2*k_1')
    >>> scalar("2 k_1")
    Traceback (most recent call last):
    torsionnet.expressions.ExpressionError: "k_1" is not a known unit; if it is a parameter, write 2*k_1
    """
    if isinstance(value, Expression):
        return value
    if isinstance(value, str):
        return _from_text(value)
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        return _from_pint(value)
    if isinstance(value, bool):
        raise ExpressionError(f"expected a number, got {str(value).lower()}")
    if isinstance(value, numbers.Integral):
        return Number(int(value))
    if isinstance(value, numbers.Real):
        return Number(value if isinstance(value, Fraction) else float(value))
    raise ExpressionError(f"expected a number, a quantity or an expression, got {_short(repr(value))}")


def _from_text(text: str) -> Expression:
    written = text.strip()
    numeral = NUMERAL.match(written)
    if numeral is None or _OPERATION.match(written, numeral.end()):
        return parse_expression(text)
    try:
        quantity = parse_quantity(written)
    except UnitError as error:
        rest = written[numeral.end() :].strip()
        if not _NAME.fullmatch(rest) or check_name(rest) or "did you mean" in str(error):
            raise ExpressionError(str(error)) from None
        product = f"{numeral[0]}*{rest}"
        raise ExpressionError(f'"{rest}" is not a known unit; if it is a parameter, write {product}') from None
    return Number(quantity.value, quantity.dimension, quantity.text)


def _from_pint(quantity: Any) -> Expression:
    # The unit as given goes first: pint itself makes 1/s of Hz, and with it loses the cycle.
    try:
        return _with_unit(quantity)
    except UnitError:
        pass
    try:
        return _with_unit(quantity.to_base_units())
    except UnitError as error:
        raise ExpressionError(f"{_short(str(quantity))}: {error}") from None


def _with_unit(quantity: Any) -> Expression:
    magnitude = scalar(quantity.magnitude)
    if not isinstance(magnitude, Number):
        raise ExpressionError(f"expected a number with a unit, got {_short(repr(quantity))}")
    parsed = parse_quantity(f"{_numeral(Fraction(magnitude.value))} {quantity.units:~}")
    return Number(parsed.value, parsed.dimension, parsed.text)

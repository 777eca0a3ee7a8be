"""Parser of expressions in model files, with a whitelist: numbers, names, + - * / powers, sqrt and pi.

``ast`` only takes the text apart; nothing is ever compiled or evaluated by Python.

>>> half = parse_expression("k_1/2 + 3*k_2")
>>> sorted(half.names), half.evaluate({"k_1": Fraction(1), "k_2": Fraction(1, 3)})
(['k_1', 'k_2'], Fraction(3, 2))
>>> scalar("0.46 kN*m/rad").evaluate({})
Fraction(460, 1)
"""

from __future__ import annotations

import ast
import keyword
import numbers
import re
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import torsionnet.base.units as units
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import RATIONAL, Compound, Expression, ExpressionError, Name, Number
from torsionnet.base.units import NUMERAL, UnitError

RESERVED = {
    "s": "the variable of transfer functions",
    "omega": "the angular frequency",
    "ground": "the node that never moves",
    "pi": "the number 3.14159",
    "sqrt": "the square root",
}
"""Words that no parameter, element or part may be named, with their meaning in expressions."""
RESERVED_NAMES = frozenset(RESERVED)
_MAX_LENGTH, _MAX_NODES, _MAX_DEPTH, _MAX_EXPONENT = 200, 60, 20, 4
_CHARACTERS = re.compile(r"[A-Za-z0-9_+\-*/(). ^]*")
_DOTTED = r"[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z_][A-Za-z0-9_]*)*"
"""Regular expression of a name with dots."""
_PIECE = re.compile(rf"(?P<number>{NUMERAL.pattern.replace('([+-]?)', '()', 1)})|(?P<name>{_DOTTED})|.")
_OPERATION = re.compile(r"\s*[-+*/^()]")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*(\.[A-Za-z][A-Za-z0-9_]*)*")
_SIGNS: dict[type[ast.operator], str] = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}


def check_name(name: str) -> str | None:
    """Message why a name cannot be that of a parameter, or None if it can.

    That of a parameter of a part comes after the name under which the part is used, and a dot.

    >>> check_name("k_1"), check_name("left.k_1"), check_name("omega")
    (None, None, '"omega" is reserved: it stands for the angular frequency; choose another name')
    """
    if not _NAME.fullmatch(name):
        return f'"{name}" is not a valid name: a letter comes first, then letters, digits and _ (no accents)'
    for word in name.split("."):
        if word.lower() in ("nan", "inf", "infinity"):
            return f'"{word}" is no finite number'
        if keyword.iskeyword(word):
            return f'"{word}" is a word of the Python language; choose another name'
        if word in RESERVED:
            return f'"{word}" is reserved: it stands for {RESERVED[word]}; choose another name'
    return None


@lru_cache(maxsize=4096)
def parse_expression(text: str) -> Expression:
    """Expression tree of a text without units, such as ``2*k_1``.

    Raises :class:`ExpressionError` with the offset of the fault.

    Allowed are ``+ - * /``, ``**`` (or ``^``) with an exponent that is whole or half and at most 4, parentheses,
    ``sqrt``, ``pi``, decimal numbers, taken exactly, and names of parameters.

    >>> str(parse_expression("G*pi*d^4/(32*l)"))
    'G*pi*d**4/(32*l)'
    >>> try:
    ...     parse_expression("k .real")
    ... except ExpressionError as error:
    ...     print(error)
    "k .real" at column 3: "." stands only in decimal numbers and names
    """
    try:
        return _Reader(text).expression()
    except (ExpressionError, UnitError) as error:
        offset = error.offset if isinstance(error, ExpressionError) else None
        where = "" if offset is None else f" at column {offset + 1}"
        raise ExpressionError(replace(error.fault, message=f'"{_short(text)}"{where}: {error}'), offset) from None


def _short(text: str) -> str:
    return text if len(text) <= _MAX_LENGTH else text[:40] + "..."


class _Reader:
    """Parser of one expression; ``columns`` leads from its source, with ``**`` for ``^``, back to the text."""

    def __init__(self, text: str) -> None:
        if not 0 < len(text.strip()) <= len(text) <= _MAX_LENGTH:
            raise ExpressionError(
                f"an expression has 1 to {_MAX_LENGTH} characters, not {len(text)}", kind="unreadable-expression"
            )
        blanks = len(text) - len(text.lstrip())
        self.source, self.nodes = text.strip().replace("^", "**"), 0
        self.columns = [blanks + i for i, sign in enumerate(text[blanks:]) for _ in range(1 + (sign == "^"))]

    def unreadable(self, message: str | Fault, node: ast.expr | int) -> ExpressionError:
        column = node if isinstance(node, int) else node.col_offset
        return ExpressionError(message, self.columns[min(column, len(self.columns) - 1)], kind="unreadable-expression")

    def expression(self) -> Expression:
        """Tree of the whole expression."""
        # Characters and words that ast would miss, or only call a syntax error, are refused first.
        good = _CHARACTERS.match(self.source)
        if good and good.end() < len(self.source):
            raise self.unreadable(f'"{self.source[good.end()]}" is not allowed in an expression', good.end())
        operand = False
        for piece in _PIECE.finditer(self.source):
            kind, text, start = piece.lastgroup, piece[0], piece.start()
            if kind and operand:
                raise self.unreadable(f'an operator is missing before "{text}"; a product is written with *', start)
            reason = check_name(text) if kind == "name" and text not in ("pi", "sqrt") else None
            if reason:
                raise self.unreadable(reason, start)
            if kind == "number":
                self.number(text, start)
            if text == ".":
                raise self.unreadable('"." stands only in decimal numbers and names', start)
            operand = bool(kind) or text == ")" or (operand and text == " ")
        try:
            return self.read(ast.parse(self.source, mode="eval").body, 0)
        except SyntaxError as error:
            raise self.unreadable("the expression is incomplete here", (error.offset or len(self.source)) - 1) from None
        except (RecursionError, MemoryError):
            raise ExpressionError("the expression is too deeply nested", kind="unreadable-expression") from None

    def number(self, numeral: str, start: int) -> Number:
        try:
            return Number(units.parse_number(numeral))
        except UnitError as error:
            raise self.unreadable(error.fault, start) from None

    def read(self, node: ast.expr, depth: int) -> Expression:
        self.nodes += 1
        if depth > _MAX_DEPTH or self.nodes > _MAX_NODES:
            limit = f"{_MAX_DEPTH} levels" if depth > _MAX_DEPTH else f"{_MAX_NODES} numbers, names and operators"
            raise self.unreadable(f"the expression has more than {limit}", node)
        if isinstance(node, ast.Constant):
            return self.number(self.source[node.col_offset : node.end_col_offset], node.col_offset)
        if isinstance(node, ast.Name) and node.id != "sqrt":
            return Compound("pi") if node.id == "pi" else Name(node.id)
        if isinstance(node, ast.Attribute) and _NAME.fullmatch(dotted := ast.unparse(node)):
            return Name(dotted)
        if isinstance(node, ast.UnaryOp):
            return self.signed(node, depth)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
            return self.power(node, depth)
        if isinstance(node, ast.BinOp) and type(node.op) in _SIGNS:
            return self.binary(node, depth)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "sqrt" and node.args:
            return Compound("sqrt", (self.read(node.args[0], depth + 1),))
        raise self.unreadable(
            "allowed are numbers, names, + - * / **, sqrt(x) and pi; nothing else can be called", node
        )

    def signed(self, node: ast.UnaryOp, depth: int) -> Expression:
        operand = self.read(node.operand, depth + 1)
        if isinstance(node.op, ast.UAdd):
            return operand
        if isinstance(node.operand, ast.Constant) and isinstance(operand, Number):
            return Number(-operand.value)
        return Compound("negative", (operand,))

    def binary(self, node: ast.BinOp, depth: int) -> Expression:
        # A long sum leans to the left; it is not nested more deeply for that.
        left = self.read(node.left, depth if isinstance(node.left, ast.BinOp) else depth + 1)
        right = self.read(node.right, depth + 1)
        literals = isinstance(node.right, ast.Constant) and not isinstance(node.left, ast.BinOp)
        if literals and isinstance(node.op, ast.Div) and isinstance(left, Number) and right != Number(0):
            return Number(Fraction(left.value) / right.value_in({}, RATIONAL))
        return Compound(_SIGNS[type(node.op)], (left, right))

    def power(self, node: ast.BinOp, depth: int) -> Expression:
        base, exponent = self.read(node.left, depth + 1), self.read(node.right, depth + 1)
        value = Fraction(exponent.value) if isinstance(exponent, Number) else None
        if value is None or value.denominator not in (1, 2) or abs(value) > _MAX_EXPONENT:
            raise self.unreadable(f"an exponent is a whole or half number of at most {_MAX_EXPONENT}", node.right)
        if _has_power(base):
            raise self.unreadable("a power of a power is not allowed", node)
        return Compound("**", (base, Number(value)))


def _has_power(tree: Expression) -> bool:
    return isinstance(tree, Compound) and (tree.sign == "**" or any(map(_has_power, tree.operands)))


def scalar(value: object) -> Expression:
    """Expression from a number, a text or a pint quantity; raises :class:`ExpressionError` for everything else.

    A float is taken for the decimal it is written as; a text is a number, a quantity or an expression; a pint
    quantity is read by its unit.

    >>> scalar(0.1), str(scalar("0.46 kN*m/rad")), str(scalar("2*k_1"))
    (Number(value=Fraction(1, 10), unit_dimension=None, text=None), '0.46 kN*m/rad', '2*k_1')
    >>> try:
    ...     scalar("2 k_1")
    ... except ExpressionError as error:
    ...     print(error)
    "k_1" is not a known unit; if it is a parameter, write 2*k_1
    """
    if isinstance(value, Expression):
        return value
    try:
        if isinstance(value, str):
            written = value.strip()
            numeral = NUMERAL.match(written)
            if numeral is None or _OPERATION.match(written, numeral.end()):
                return parse_expression(value)
            given = units.parse_quantity(written)
        elif isinstance(value, numbers.Real) and not isinstance(value, bool):
            return Number(value)
        elif hasattr(value, "magnitude") and hasattr(value, "units"):
            given = _of_pint(value)
        else:
            got = str(value).lower() if isinstance(value, bool) else _short(repr(value))
            raise ExpressionError(Fault(f"expected a number, got {got}", kind="not-a-number"))
        return Number(given.value, given.dimension, given.text)
    except UnitError as error:
        raise ExpressionError(_or_product(error.fault, value)) from None


def _or_product(fault: Fault, value: object) -> Fault:
    """Fault of a scalar, with the question whether a product of a number and a parameter was meant, as 2*k_1."""
    written = value.strip() if isinstance(value, str) else ""
    numeral = NUMERAL.match(written)
    rest = written[numeral.end() :].strip() if numeral else ""
    if numeral is None or not _NAME.fullmatch(rest) or check_name(rest) or fault.meant or rest in units.AMBIGUOUS:
        return fault
    return replace(fault, message=f"{fault.message}; if it is a parameter, write {numeral[0]}*{rest}")


def _of_pint(quantity: Any) -> units.Quantity:
    """Value in SI units of a quantity of pint, or of an object with ``magnitude``, ``units`` and ``to_base_units``."""
    # The unit as given goes first: in base units pint makes 1/s of Hz and so loses the cycle.
    try:
        return _read_given(quantity)
    except UnitError:
        pass
    try:
        return _read_given(quantity.to_base_units())
    except UnitError as error:
        raise UnitError(replace(error.fault, message=f"{quantity}: {error}")) from None


def _read_given(quantity: Any) -> units.Quantity:
    if not isinstance(quantity.magnitude, numbers.Real):
        raise UnitError(Fault(f"expected one real number, got {quantity.magnitude}", kind="not-a-number"))
    return units.parse_quantity(f"{float(units.exact(quantity.magnitude))!r} {quantity.units:~}")

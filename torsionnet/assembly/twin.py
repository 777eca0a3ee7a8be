"""Exact numbers with their symbolic expressions, of which decisions use the value and formulas the symbol."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

import sympy

from torsionnet.core.expressions import Algebra
from torsionnet.model.elimination import exact


@dataclass(frozen=True, eq=False)
class Twin:
    """Twin of an exact rational value and its sympy expression, equal to a number if its value is."""

    value: Fraction
    symbol: Any

    def __add__(self, other: Any) -> Twin:
        other = twin(other)
        return Twin(self.value + other.value, self.symbol + other.symbol)

    def __mul__(self, other: Any) -> Twin:
        other = twin(other)
        return Twin(self.value * other.value, self.symbol * other.symbol)

    def __truediv__(self, other: Any) -> Twin:
        other = twin(other)
        return Twin(self.value / other.value, self.symbol / other.symbol)

    def __neg__(self) -> Twin:
        return Twin(-self.value, -self.symbol)

    def __sub__(self, other: Any) -> Twin:
        return self + (-twin(other))

    def __rsub__(self, other: Any) -> Twin:
        return twin(other) - self

    def __rtruediv__(self, other: Any) -> Twin:
        return twin(other) / self

    def __pow__(self, power: int) -> Twin:
        return Twin(self.value**power, self.symbol**power)

    __radd__ = __add__
    __rmul__ = __mul__

    def __eq__(self, other: object) -> bool:
        return self.value == (other.value if isinstance(other, Twin) else other)

    def __lt__(self, other: Any) -> bool:
        return bool(self.value < twin(other).value)

    def __gt__(self, other: Any) -> bool:
        return bool(self.value > twin(other).value)

    def __hash__(self) -> int:
        return hash(self.value)


def rational(number: Any) -> Any:
    """Sympy rational equal to a number, exact, never a sympy Float."""
    value = exact(number)
    return sympy.Rational(value.numerator, value.denominator)


def twin(number: Any) -> Twin:
    """Twin (an exact value with its symbol) of a plain number, whose symbol is the number itself."""
    return number if isinstance(number, Twin) else _plain(number)


@lru_cache(maxsize=1024)
def _plain(number: Any) -> Twin:
    return Twin(exact(number), rational(number))


def _root(number: Any) -> Twin:
    number = twin(number)
    return Twin(exact(float(number.value) ** 0.5), sympy.sqrt(number.symbol))


TWINS = Algebra(number=twin, sqrt=_root, pi=Twin(exact(float(sympy.pi)), sympy.pi))
"""Algebra in which expressions of parameters evaluate to twins (an exact value with its symbol)."""


def twin_parameters(definitions: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Twin]:
    """Twins (exact value and symbol) of all parameters by name; a derived one has its expression in the basic ones."""
    twins: dict[str, Twin] = {}
    for name in values:
        expression = definitions[name].value
        symbol = expression.evaluate(twins, TWINS).symbol if expression.names else sympy.Symbol(name)
        twins[name] = Twin(exact(values[name]), symbol)
    return twins

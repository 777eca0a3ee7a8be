"""Numbers that hold a parameter's value in all variants, with which elements evaluate their laws at once.

Elements decide by values now and then. Such a decision falls as the first variant has it; those of which it would fall
otherwise are left for another pass, in which one of them is the first. No decision is guessed at.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.expressions import Algebra
from torsionnet.linear.assembly.rows import FloatArray

CANCELLATION_RATIO = 1e-3
"""Ratio of a sum to its terms below which the sum has lost digits that exact fractions would have kept."""
MOST_PASSES = 64
"""Most passes over variants, one per combination of decisions, beyond which variants are looked at one by one."""


class Decisions:
    """Record of which variants decide like the first one wherever an element chooses by a parameter value.

    Attributes
    ----------
    follows : (n,) boolean array
        Variants of which every decision falls as for the first.
    unsure : (n,) boolean array
        Variants whose numbers have lost digits or are not finite.
    """

    def __init__(self, count: int) -> None:
        self.follows = np.ones(count, dtype=bool)
        self.unsure = np.zeros(count, dtype=bool)

    def decide(self, answers: Any) -> bool:
        """Truth of a comparison for the first variant, after marking the variants for which it differs."""
        first = bool(answers[0])
        self.follows &= answers if first else ~answers
        return first


class VariantNumber:
    """Parameter value in every variant, shape (n,), on which elements calculate as on one number."""

    __slots__ = ("decisions", "values")
    __array_ufunc__ = None  # numpy leaves arithmetic with it to the methods below

    def __init__(self, values: FloatArray, decisions: Decisions) -> None:
        self.values: FloatArray = values
        self.decisions: Decisions = decisions

    def _new(self, values: FloatArray) -> VariantNumber:
        return VariantNumber(values, self.decisions)

    def _sum(self, first: Any, second: Any) -> VariantNumber:
        total = first + second
        self.decisions.unsure |= (np.abs(total) < CANCELLATION_RATIO * np.abs(first)) & (total != 0)
        return self._new(total)

    def __add__(self, other: Any) -> VariantNumber:
        return self._sum(self.values, _plain(other))

    def __sub__(self, other: Any) -> VariantNumber:
        return self._sum(self.values, -_plain(other))

    def __rsub__(self, other: Any) -> VariantNumber:
        return self._sum(-self.values, _plain(other))

    def __mul__(self, other: Any) -> VariantNumber:
        return self._new(self.values * _plain(other))

    def __truediv__(self, other: Any) -> VariantNumber:
        return self._new(self.values / _plain(other))

    def __rtruediv__(self, other: Any) -> VariantNumber:
        return self._new(_plain(other) / self.values)

    def __pow__(self, power: int) -> VariantNumber:
        return self._new(self.values ** float(power))

    def __neg__(self) -> VariantNumber:
        return self._new(-self.values)

    def __abs__(self) -> VariantNumber:
        return self._new(np.abs(self.values))

    __radd__ = __add__
    __rmul__ = __mul__

    def _compared(self, other: Any, how: Callable[[Any, Any], Any]) -> Any:
        if not isinstance(other, VariantNumber | Fraction | int | float):
            return NotImplemented
        return self.decisions.decide(how(self.values, _plain(other)))

    def __eq__(self, other: object) -> Any:
        return self._compared(other, operator.eq)

    def __lt__(self, other: Any) -> Any:
        return self._compared(other, operator.lt)

    def __le__(self, other: Any) -> Any:
        return self._compared(other, operator.le)

    def __gt__(self, other: Any) -> Any:
        return self._compared(other, operator.gt)

    def __ge__(self, other: Any) -> Any:
        return self._compared(other, operator.ge)

    def __bool__(self) -> bool:
        return self.decisions.decide(self.values != 0)

    def __float__(self) -> float:
        self.decisions.decide(self.values == self.values[0])
        return float(self.values[0])

    def __hash__(self) -> int:
        return hash(float(self))


def _plain(number: Any) -> Any:
    return number.values if isinstance(number, VariantNumber) else float(number)


def _root(number: Any) -> Any:
    if number < 0:
        raise ArithmeticError("the square root of a negative number is not real")
    if isinstance(number, VariantNumber):
        return VariantNumber(np.sqrt(number.values), number.decisions)
    return math.sqrt(number)


VARIANTS = Algebra(number=Fraction, sqrt=_root, pi=math.pi)
"""Arithmetic for expressions in which some parameters are a :class:`VariantNumber`."""


def variant_column(number: Any, count: int) -> FloatArray:
    """Values (count,) of a number in every variant, where a plain number is the same in all."""
    return number.values if isinstance(number, VariantNumber) else np.full(count, float(number))


def passes(count: int) -> Iterator[tuple[NDArray[np.intp], Decisions]]:
    """Yield indices of variants and a record of their decisions, until each variant has followed a first one.

    Variants of a combination of decisions beyond :data:`MOST_PASSES` come in no pass.
    """
    rest = np.arange(count)
    for _ in range(MOST_PASSES):
        if not len(rest):
            return
        decisions = Decisions(len(rest))
        yield rest, decisions
        rest = rest[~decisions.follows]

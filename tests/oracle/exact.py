"""Exact numbers, their value as a ball of real numbers, and the rank of rows of fractions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from fractions import Fraction
from typing import TypeAlias

from flint import acb, arb, ctx, fmpq

Scalar: TypeAlias = Fraction | Callable[[], arb]
"""A fraction, or a recipe for what pi or a root makes irrational."""

Row: TypeAlias = Mapping[str, Fraction]


@contextmanager
def precision(bits: int) -> Iterator[None]:
    before = ctx.prec
    ctx.prec = bits
    try:
        yield
    finally:
        ctx.prec = before


def ball(value: Scalar | float) -> arb:
    """The value at the current precision; a float is taken for the exact dyadic number it is."""
    if callable(value):
        return value()
    value = Fraction(value)
    return arb(fmpq(value.numerator, value.denominator))


def imaginary(value: arb) -> acb:
    return acb(arb(0), value)


def combination(*terms: tuple[str, Fraction | int]) -> dict[str, Fraction]:
    """Row of (node, coefficient) pairs."""
    row: dict[str, Fraction] = {}
    for node, coefficient in terms:
        row[node] = row.get(node, Fraction(0)) + Fraction(coefficient)
    return {node: coefficient for node, coefficient in row.items() if coefficient}


def added(row: dict[str, Fraction], factor: Fraction, other: Row) -> None:
    """Add a multiple of another row in place."""
    for name, value in other.items():
        total = row.get(name, Fraction(0)) + factor * value
        if total:
            row[name] = total
        else:
            row.pop(name, None)


class Span:
    """Rows one after the other: which are independent, and how the others are made of them."""

    def __init__(self) -> None:
        self.pivots: dict[str, tuple[dict[str, Fraction], dict[str, Fraction]]] = {}
        self.relations: list[dict[str, Fraction]] = []

    def reduced(self, row: Row, label: str = "") -> tuple[dict[str, Fraction], dict[str, Fraction]]:
        """What is left of a row, and the combination of labelled rows that gives this rest."""
        rest, made_of = dict(row), ({label: Fraction(1)} if label else {})
        for name in list(self.pivots):
            if name in rest:
                pivot, origin = self.pivots[name]
                factor = -rest[name]
                added(rest, factor, pivot)
                added(made_of, factor, origin)
        return rest, made_of

    def add(self, row: Row, label: str = "") -> bool:
        """Whether the row was independent of those before."""
        rest, made_of = self.reduced(row, label)
        if not rest:
            self.relations.append(made_of)
            return False
        name = min(rest)
        scale = 1 / rest[name]
        self.pivots[name] = (
            {key: value * scale for key, value in rest.items()},
            {key: value * scale for key, value in made_of.items()},
        )
        return True


def rank(rows: Sequence[Row]) -> int:
    span = Span()
    return sum(span.add(row) for row in rows)


def null_space(rows: Sequence[Row], names: Sequence[str]) -> dict[str, dict[str, Fraction]]:
    """Every name as a combination of free ones, such that all rows vanish."""
    span = Span()
    for row in rows:
        span.add(row)
    solved: dict[str, dict[str, Fraction]] = {}
    for name in reversed(list(span.pivots)):
        pivot = span.pivots[name][0]
        value: dict[str, Fraction] = {}
        for other, coefficient in pivot.items():
            if other != name:
                added(value, -coefficient, solved.get(other, {other: Fraction(1)}))
        solved[name] = value
    return {name: solved.get(name, {name: Fraction(1)}) for name in names}

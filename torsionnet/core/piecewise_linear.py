"""Piecewise linear interpolation of tables: exact with slopes, as floats, and in any algebra."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from fractions import Fraction
from typing import Any, TypeAlias

from torsionnet.core.errors import UsageError
from torsionnet.core.expressions import Algebra, Number

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
    slack = 1e-9 * keys[-1]
    if not keys[0] - slack <= at <= keys[-1] + slack:
        raise UsageError(f"the table goes from {rows[0][0]} to {rows[-1][0]}")
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
    >>> from torsionnet.core.expressions import RATIONAL
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
            total = total + algebra.number((ahead - slope) / 2) * (beyond + algebra.sqrt(beyond**2))
        slope = ahead
    return total

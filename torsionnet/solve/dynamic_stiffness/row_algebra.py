"""Sums and comparisons of sparse rows up to a factor, for elimination on the graph.

Rows are sparse maps from coordinate to coefficient. Coefficients are known to rounding only, so what cancels to within
the tolerance of its terms is zero, and rows that agree to as many digits are the same.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

Row: TypeAlias = dict[int, float]
Key: TypeAlias = tuple[tuple[int, Any], ...]

LINK_ENTRIES = 2
"""Number of entries, two, of a row that links two coordinates."""


def _rounded(coefficient: float) -> float:
    return coefficient if coefficient.is_integer() else float(f"{coefficient:.13g}")


@dataclass(frozen=True)
class Accuracy:
    """Accuracy of row coefficients, by a tolerance of cancellation and the rounding for comparisons."""

    tolerance: Any
    rounded: Callable[[Any], Any]


DOUBLE = Accuracy(1e-13, _rounded)
"""Accuracy of row coefficients in double precision, as ratios multiplied around a consistent loop meet to about 1e-15
per gear."""


def combine_rows(
    first: Mapping[int, float], second: Mapping[int, float], coordinate: int, accuracy: Accuracy = DOUBLE
) -> Row:
    """Row b = second_v first - first_v second, the combination of two rows that has no entry on coordinate v."""
    over_first, over_second = second.get(coordinate, 0.0), first[coordinate]
    row: Row = {}
    for j in {**first, **second}:
        plus, minus = over_first * first.get(j, 0.0), over_second * second.get(j, 0.0)
        if j != coordinate and abs(plus - minus) > accuracy.tolerance * (abs(plus) + abs(minus)):
            row[j] = plus - minus
    return row


def normalised(row: Mapping[int, float], accuracy: Accuracy = DOUBLE) -> tuple[Key, Row, float]:
    """Key to look a row up by, unit row whose first coefficient is 1, and factor, with row = factor * unit."""
    first = min(row)
    factor = row[first]
    if len(row) == 1:
        return ((first, 1.0),), {first: 1.0}, factor
    unit = {j: row[j] / factor for j in sorted(row)}
    return tuple((j, accuracy.rounded(coefficient)) for j, coefficient in unit.items()), unit, factor


def equivalent_links(
    row: Mapping[int, float], scale: Mapping[int, float], accuracy: Accuracy = DOUBLE
) -> Iterator[tuple[Row, float]]:
    """Yield links and grounds b with weights that together equal one row a, by a a^T = sum of weight * b b^T over b.

    With a_i d_i for a_i, where d is the ``scale`` of the coordinates, a pair i, j gets the link {i: 1/d_i, j: -1/d_j}
    with weight -a_i a_j, and coordinate i the ground {i: 1/d_i} with a_i sum(a): nothing where the row does not answer
    to the motion d.
    """
    scaled = {j: row[j] * scale[j] for j in sorted(row)}
    names = list(scaled)
    total, size = sum(scaled.values()), sum(abs(value) for value in scaled.values())
    for place, i in enumerate(names):
        for j in names[place + 1 :]:
            yield {i: 1 / scale[i], j: -1 / scale[j]}, -scaled[i] * scaled[j]
        if abs(total) > accuracy.tolerance * size:
            yield {i: 1 / scale[i]}, scaled[i] * total


def common_motion(rows: Iterable[Mapping[int, float]]) -> dict[int, float]:
    """Amplitude by coordinate of a motion that two-coordinate links do not resist, where they form no closed loops.

    Links whose ends turn the same way come first: those of the opposite kind may be the inertia of a shaft.
    """
    links = sorted((row for row in rows if len(row) == LINK_ENTRIES), key=lambda row: math.prod(row.values()) > 0)
    around: dict[int, list[tuple[int, float]]] = {}
    for row in links:
        (i, a), (j, b) = row.items()
        around.setdefault(i, []).append((j, -a / b))
        around.setdefault(j, []).append((i, -b / a))
    scale: dict[int, float] = {}
    for root in around:
        waiting = [(root, 1.0)]
        while waiting:
            i, size = waiting.pop()
            if i not in scale:
                scale[i] = size
                waiting += [(j, size * ratio) for j, ratio in reversed(around[i])]
    return scale


@dataclass
class RowTable:
    """Numbered rows, stored once up to a factor, that are found by the columns they touch."""

    accuracy: Accuracy = DOUBLE
    numbers: dict[Key, int] = field(default_factory=dict)
    rows: list[Row] = field(default_factory=list)
    touching: dict[int, set[int]] = field(default_factory=dict)

    def add(self, row: Row) -> tuple[int, float]:
        """Number of a row in the table, added if it is new, and its factor on the stored row."""
        key, unit, factor = normalised(row, self.accuracy)
        number = self.numbers.get(key)
        if number is None:
            number = self.numbers[key] = len(self.rows)
            self.rows.append(unit)
            for j in unit:
                self.touching.setdefault(j, set()).add(number)
        return number, factor

    def take(self, column: int) -> list[int]:
        """Remove the rows that involve a coordinate, and return their numbers, rows over several coordinates first."""
        numbers = list(self.touching.get(column, ()))
        for number in numbers:
            self.remove(number)
        return sorted(numbers, key=lambda number: (len(self.rows[number]) == 1, number))

    def remove(self, number: int) -> None:
        """Remove the row of this number from the table, where the number is not used again."""
        for j in self.rows[number]:
            self.touching[j].discard(number)
        del self.numbers[normalised(self.rows[number], self.accuracy)[0]]

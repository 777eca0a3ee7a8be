"""Null spaces of sparse rows, that is the motions of a drivetrain that strain none of some springs or dampers.

A row with one entry holds its coordinate. Rows with two entries tie coordinates to parts that turn as one, found by
walking from ratio to ratio; the few wider rows are then solved over the parts. All of it costs about as much as there
are entries. Whether a sum of terms vanishes is decided by the rounding that it carries along and never by its size, so
that ranks are right whatever the ratios multiply to.

>>> loop = null_space([{0: 1.0, 1: -3.0}, {1: 1.0, 2: 1.0}, {0: 1.0, 2: 3.0}], 4)
>>> loop.dimension
2
>>> loop.basis()[:, 0] / loop.basis()[1, 0]
array([ 3.,  1., -1.,  0.])
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import FloatArray, RowSystem
from torsionnet.model.elimination import reduce_rows

SparseRow: TypeAlias = Mapping[int, float]

CLOSED_LOOP_TOLERANCE = 1e-11
"""Relative residual below which rows around a loop of gears agree, far above the 1e-15 to which consistent ratios
meet."""
WIDE_ROW_ROUNDING = 1e-13
"""Relative rounding error assumed in coefficients of rows over more than two coordinates, since entries are right to
1e-16 and long products nearly."""


@dataclass(frozen=True)
class NullSpace:
    """Motions, as values by coordinate, in which every row of a set is zero, such as those that strain no spring.

    Attributes
    ----------
    size : int
        Number of coordinates.
    columns : tuple of dict
        Coordinate -> value of each direction; in the order of the first coordinate of its part.
    disjoint : bool
        Whether no coordinate belongs to two directions.
    """

    size: int
    columns: tuple[dict[int, float], ...]
    disjoint: bool

    @property
    def dimension(self) -> int:
        return len(self.columns)

    def first(self, count: int) -> NullSpace:
        """Null space that the first ``count`` directions of this null space span."""
        return replace(self, columns=self.columns[:count])

    def basis(self) -> FloatArray:
        """Orthonormal basis of the null space, shape (number of coordinates, number of directions)."""
        array = np.zeros((self.size, self.dimension))
        for number, column in enumerate(self.columns):
            array[list(column), number] = list(column.values())
        array /= np.abs(array).max(axis=0, initial=0.0)
        return np.asarray(array / np.linalg.norm(array, axis=0) if self.disjoint else np.linalg.qr(array)[0])


@dataclass(frozen=True, eq=False)
class Rounded:
    """Number with a bound of its rounding error, equal to zero where that error may be all of it."""

    value: float
    error: float

    @staticmethod
    def of(number: Rounded | float) -> Rounded:
        """Number with rounding bound made from a float taken as exact, or returned as it is if it has one."""
        return number if isinstance(number, Rounded) else Rounded(number, 0.0)

    def __add__(self, other: Rounded | float) -> Rounded:
        other = Rounded.of(other)
        return Rounded(self.value + other.value, self.error + other.error)

    def __mul__(self, other: Rounded | float) -> Rounded:
        other = Rounded.of(other)
        return Rounded(self.value * other.value, abs(self.value) * other.error + self.error * abs(other.value))

    def __truediv__(self, other: Rounded | float) -> Rounded:
        other = Rounded.of(other)
        value = self.value / other.value
        return Rounded(value, (self.error + abs(value) * other.error) / abs(other.value))

    def __rtruediv__(self, other: float) -> Rounded:
        return Rounded.of(other) / self

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self) -> Rounded:
        return Rounded(-self.value, self.error)

    def __eq__(self, other: object) -> bool:
        return other == 0 and abs(self.value) <= self.error

    __hash__ = None  # type: ignore[assignment]


def unresisted_motions(system: RowSystem, laws: NDArray[np.bool_]) -> NullSpace:
    """Motions of a system, as a null space, that none of the selected laws resists, mask (n_laws,)."""
    return null_space([system.sparse_rows[index] for index in np.flatnonzero(laws)], system.n_coordinates)


def null_space(rows: Sequence[SparseRow], size: int) -> NullSpace:
    """Null space of sparse rows (coordinate -> coefficient) over ``size`` coordinates, right for any ratios."""
    parts = _Parts(rows, size)
    turning = [number for number in range(len(parts.members)) if number not in parts.held]
    wide = [row for row in (parts.over_parts(row) for row in rows if len(row) > 2) if row]
    solved = reduce_rows(wide, {part: part for part in turning}).solved
    columns = {part: parts.part_angles(part, 1.0) for part in turning if part not in solved}
    for part, free in solved.items():
        for other, ratio in free.items():
            columns[other] |= parts.part_angles(part, Rounded.of(ratio).value)
    return NullSpace(size, tuple(columns.values()), disjoint=all(len(free) < 2 for free in solved.values()))


class _Parts:
    """Groups of coordinates that rows with two entries, as of gears and rigid connections, tie to each other.

    ``angle`` of each coordinate is per that of the first one of its part; ``held`` are the parts that cannot turn.
    """

    def __init__(self, rows: Sequence[SparseRow], size: int) -> None:
        links: list[list[tuple[int, float]]] = [[] for _ in range(size)]
        ties = [tuple(row.items()) for row in rows if len(row) == 2]
        for (a, x), (b, y) in ties:
            links[a].append((b, -x / y))
            links[b].append((a, -y / x))
        self.angle, self.part = [0.0] * size, [-1] * size
        self.members: list[list[int]] = []
        for root in range(size):
            if self.part[root] < 0:
                self._walk(root, links)
        self.held = {self.part[column] for row in rows if len(row) == 1 for column in row}
        for (a, x), (b, y) in ties:
            first, second = x * self.angle[a], y * self.angle[b]
            if abs(first + second) > CLOSED_LOOP_TOLERANCE * max(abs(first), abs(second)):
                self.held.add(self.part[a])

    def _walk(self, root: int, links: list[list[tuple[int, float]]]) -> None:
        number, members = len(self.members), [root]
        self.angle[root], self.part[root] = 1.0, number
        for node in members:  # which grows
            for other, ratio in links[node]:
                if self.part[other] < 0:
                    self.angle[other], self.part[other] = ratio * self.angle[node], number
                    members.append(other)
        self.members.append(members)

    def over_parts(self, row: SparseRow) -> dict[int, Any]:
        """Coefficients by group of tied coordinates that can turn, from a row over single coordinates."""
        result: dict[int, Rounded] = {}
        for column, value in row.items():
            part, factor = self.part[column], value * self.angle[column]
            if part in self.held:
                continue
            term = Rounded(factor, WIDE_ROW_ROUNDING * abs(factor))
            result[part] = result[part] + term if part in result else term
        return result

    def part_angles(self, part: int, ratio: float) -> dict[int, float]:
        """Angles by coordinate, of a group of tied coordinates, when its first coordinate turns by ``ratio``."""
        return {column: ratio * self.angle[column] for column in self.members[part]}

"""Sums and comparisons of sparse rows up to a factor, for elimination on the graph.

Rows are sparse maps from coordinate to coefficient. Coefficients are known to rounding only, so what cancels to within
the tolerance of its terms is zero, and rows that agree to as many digits are the same.

Null spaces of sparse rows, that is the motions of a drivetrain that strain none of some springs or dampers.

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

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray, RowSystem
from torsionnet.model.elimination import reduce_rows

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
        # a x_i + b x_j = 0 leaves the link without twist.
        around.setdefault(i, []).append((j, -a / b))
        around.setdefault(j, []).append((i, -b / a))
    scale: dict[int, float] = {}
    # Outwards from one coordinate of each tree; the first link that reaches a coordinate decides.
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


SparseRow: TypeAlias = Mapping[int, float]

CLOSED_LOOP_TOLERANCE = 1e-11
"""Relative residual below which rows around a loop of gears agree, far above the 1e-15 to which consistent ratios
meet."""
WIDE_ROW_ROUNDING = 1e-13
"""Relative rounding error assumed in coefficients of rows over more than two coordinates, since entries are right to
1e-16 and long products nearly."""
STRAINED = 1e-10
"""Share of its terms that a row leaves in a motion that it resists, where the bounds of rounding have outgrown them."""
RANK_TOLERANCE = 1e-11
"""Relative tolerance of ranks of normalised rows, whose ratios are 1 to 100, far above the 1e-15 to which consistent
loops meet."""


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

    def found() -> NullSpace:
        return null_space([system.sparse_rows[index] for index in np.flatnonzero(laws)], system.n_coordinates)

    return system.memo.once(NullSpace, laws.tobytes(), found)


def unresisted_within(motions: NullSpace, system: RowSystem, laws: NDArray[np.bool_]) -> NullSpace:
    """Part of the motions of a system, as a null space, that none of the selected laws resists, mask (n_laws,).

    What a row leaves of its terms in a motion is zero to ``CLOSED_LOOP_TOLERANCE``, as motions found are rounded.
    """
    rows = []
    for index in np.flatnonzero(laws) if motions.dimension else ():
        row: dict[int, Rounded] = {}
        for number, column in enumerate(motions.columns):
            terms = [value * column[place] for place, value in system.sparse_rows[index].items() if place in column]
            total = Rounded(sum(terms), CLOSED_LOOP_TOLERANCE * sum(map(abs, terms)))
            if total != 0:
                row[number] = total
        rows.append(row)
    if not any(rows):
        return motions
    solved = reduce_rows(rows, {number: number for number in range(motions.dimension)}).solved
    columns = {number: dict(column) for number, column in enumerate(motions.columns) if number not in solved}
    for number, free in solved.items():
        for other, ratio in free.items():
            for place, value in motions.columns[number].items():
                share = Rounded.of(ratio).value * value
                columns[other][place] = columns[other].get(place, 0.0) + share
    disjoint = motions.disjoint and all(len(free) < 2 for free in solved.values())
    return NullSpace(motions.size, tuple(columns.values()), disjoint=disjoint)


def null_space(rows: Sequence[SparseRow], size: int) -> NullSpace:
    """Null space of sparse rows (coordinate -> coefficient) over ``size`` coordinates, right for any ratios."""
    parts = _Parts(rows, size)
    turning = [number for number in range(len(parts.members)) if number not in parts.held]
    wide = [row for row in (parts.over_parts(row) for row in rows if len(row) > 2) if row]
    solved = reduce_rows(wide, {part: part for part in turning}).solved
    motions = {part: {part: 1.0} for part in turning if part not in solved}
    for part, free in solved.items():
        for other, ratio in free.items():
            motions[other][part] = Rounded.of(ratio).value
    if any(_strains(motion, row) for row in wide for motion in motions.values()):
        motions = _dense_motions(wide, turning)
    columns: list[dict[int, float]] = []
    for motion in motions.values():
        columns.append({})
        for part, ratio in motion.items():
            columns[-1] |= parts.part_angles(part, ratio)
    held_together = [part for motion in motions.values() for part in motion]
    return NullSpace(size, tuple(columns), disjoint=len(set(held_together)) == len(held_together))


def _strains(motion: Mapping[int, float], row: Mapping[int, Rounded]) -> bool:
    """Whether a motion found is one that the row resists: bounds grow by each step, in full rows beyond the numbers."""
    terms = [number.value * motion.get(part, 0.0) for part, number in row.items()]
    return abs(sum(terms)) > STRAINED * sum(map(abs, terms))


def _dense_motions(rows: Sequence[Mapping[int, Rounded]], turning: Sequence[int]) -> dict[int, dict[int, float]]:
    """Motions of parts that strain no row, by a part that turns in this one alone; from singular values of unit rows.

    >>> ends = {0: Rounded(1.0, 0.0), 1: Rounded(1.0, 0.0), 3: Rounded(-2.0, 0.0)}
    >>> for part, motion in _dense_motions([ends], [0, 1, 3]).items():
    ...     print(part, {other: round(turned, 9) for other, turned in motion.items()})
    0 {0: 1.0, 3: 0.5}
    1 {1: 1.0, 3: 0.5}
    """
    place = {part: number for number, part in enumerate(turning)}
    full = np.zeros((len(rows), len(turning)))
    for number, row in enumerate(rows):
        full[number, [place[part] for part in row]] = [term.value for term in row.values()]
    _, sigma, vt = np.linalg.svd(full / np.linalg.norm(full, axis=1, keepdims=True))
    basis = echelon_basis(vt[int(np.sum(sigma > RANK_TOLERANCE * sigma[0])) :].T)
    alone = np.count_nonzero(basis, axis=1, keepdims=True) == 1
    motions = {}
    for own, column in zip(np.argmax(alone & (basis == 1), axis=0).tolist(), basis.T, strict=True):
        told = zip(turning, column.tolist(), strict=True)
        motions[turning[own]] = {turning[own]: 1.0} | {part: turned for part, turned in told if turned}
    return dict(sorted(motions.items()))


def echelon_basis(basis: FloatArray) -> FloatArray:
    """Basis (n_q, n) in echelon form, where each column has a coordinate of its own.

    Separate trains get separate rigid modes.
    """
    basis = basis.copy()
    free = np.ones(len(basis), dtype=bool)
    for column in range(basis.shape[1]):
        row = int(np.argmax(np.abs(basis[:, column]) * free))
        free[row] = False
        basis[:, column] /= basis[row, column]
        others = np.arange(basis.shape[1]) != column
        basis[:, others] -= np.outer(basis[:, column], basis[row, others])
    basis[np.abs(basis) < RANK_TOLERANCE * np.max(np.abs(basis), initial=0.0)] = 0.0
    return basis


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
        # Ratios around a loop that do not meet hold their part still.
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
        # What rounding leaves of terms that cancel, as of ratios around a loop of gears, holds nothing.
        return {part: total for part, total in result.items() if total != 0}

    def part_angles(self, part: int, ratio: float) -> dict[int, float]:
        """Angles by coordinate, of a group of tied coordinates, when its first coordinate turns by ``ratio``."""
        return {column: ratio * self.angle[column] for column in self.members[part]}

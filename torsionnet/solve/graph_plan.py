r"""The order of elimination on the graph of a row system, worked out once for all frequencies and parameters.

With D = sum_e kappa_e a_e a_e^T, eliminating coordinate v with S = sum_e kappa_e a_ev^2 leaves

    D' = sum_{e<f} kappa_e kappa_f / S  b b^T,    b = a_fv a_e - a_ev a_f

one row b for each pair of rows that touch v. Among links and grounds this is star-mesh: two links y_vi, y_vj give the
link y_vi y_vj / S, a link and the ground g_v give the ground y_vi g_v / S. Nothing is subtracted, so that a drivetrain
that turns freely keeps its full accuracy however slow it is. Ratios, and laws over three and more coordinates, are rows
like any other. A motion r q follows in the same way from the loads f and motions of the coordinates that are left,

    r q = r_v f_v / S + sum_e (kappa_e a_ev / S) b_e q,    b_e = a_ev r - r_v a_e
    f_j' = f_j - sum_e (kappa_e a_ev a_ej / S) f_v

Coordinates with few neighbours go first: on a tree the leaves, without fill.
"""

from __future__ import annotations

import collections
import heapq
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from torsionnet.solve.row_algebra import Key, Row, clique, combined, common_motion, normalised

MOST_ROWS = 2
"""Rows on one coordinate, as a multiple of what links and grounds would be, from which on they become such."""


class Pair(NamedTuple):
    """kappa[target] += factor kappa_i kappa_j / S, for places i < j among the terms of a step."""

    i: int
    j: int
    factor: float
    target: int


@dataclass(frozen=True)
class Motion:
    """value[slot] = load f_v / S + sum of factor (kappa_i / S) value[source] over ``parts`` (i, factor, source)."""

    slot: int
    load: float
    parts: tuple[tuple[int, float, int], ...]


@dataclass(frozen=True)
class Step:
    """Elimination of one coordinate.

    Attributes
    ----------
    coordinate : int
    terms : tuple of (slot, a_v^2)
        S = sum of a_v^2 kappa[slot].
    splits : tuple of (slot, ((slot, weight), ...))
        Before all else: kappa of a row over many coordinates handed to links and grounds.
    pairs : tuple of Pair
    loads : tuple of (i, j, factor)
        f_j += factor (kappa_i / S) f_v.
    motions : tuple of Motion
        Needed on the way back, in reverse order of the steps.
    closes_loop : bool
        Whether links among the neighbours arise, so that a tiny S spoils them.
    shared : tuple of int
        Places among the terms of which kappa_i / S is needed.
    """

    coordinate: int
    terms: tuple[tuple[int, float], ...]
    splits: tuple[tuple[int, tuple[tuple[int, float], ...]], ...]
    pairs: tuple[Pair, ...]
    loads: tuple[tuple[int, int, float], ...]
    motions: tuple[Motion, ...]
    closes_loop: bool
    shared: tuple[int, ...]


@dataclass(frozen=True)
class Plan:
    """Steps of the elimination.

    Attributes
    ----------
    sources : tuple of ((law, factor), ...)
        kappa[slot] = sum of factor kappa_law, for the first slots.
    n_slots : int
    steps : tuple of Step
    outputs : tuple of (value slot or -1, factor)
        Motion of every row asked for.
    n_values : int
    """

    sources: tuple[tuple[tuple[int, float], ...], ...]
    n_slots: int
    steps: tuple[Step, ...]
    outputs: tuple[tuple[int, float], ...]
    n_values: int

    @property
    def is_tree(self) -> bool:
        return not any(step.closes_loop for step in self.steps)


@dataclass
class _Table:
    """Rows up to a factor, each with a number, found by the coordinates they touch."""

    numbers: dict[Key, int] = field(default_factory=dict)
    rows: list[Row] = field(default_factory=list)
    touching: dict[int, set[int]] = field(default_factory=dict)

    def add(self, row: Row) -> tuple[int, float]:
        """Number of the row and the factor it is of it."""
        key, unit, factor = normalised(row)
        number = self.numbers.get(key)
        if number is None:
            number = self.numbers[key] = len(self.rows)
            self.rows.append(unit)
            for j in unit:
                self.touching.setdefault(j, set()).add(number)
        return number, factor

    def take(self, coordinate: int) -> list[int]:
        """Remove and return the rows on a coordinate, those over several coordinates first."""
        numbers = list(self.touching.get(coordinate, ()))
        for number in numbers:
            self.remove(number)
        return sorted(numbers, key=lambda number: (len(self.rows[number]) == 1, number))

    def remove(self, number: int) -> None:
        for j in self.rows[number]:
            self.touching[j].discard(number)
        del self.numbers[normalised(self.rows[number])[0]]


def make_plan(laws: Sequence[Row], outputs: Sequence[Row], loaded: Iterable[int], last: int | None) -> Plan:
    """Plan for the motion of ``outputs``.

    Parameters
    ----------
    laws : sequence of rows
        The row of every law.
    outputs : sequence of rows
    loaded : iterable of int
        Coordinates with a load.
    last : int, optional
        Coordinate to keep to the end: with the only load there, the answer is a product along the path to it.
    """
    return _Planner(laws, outputs, set(loaded), last).plan()


class _Planner:
    def __init__(self, laws: Sequence[Row], outputs: Sequence[Row], loaded: set[int], last: int | None) -> None:
        self.laws, self.motions = _Table(), _Table()
        self.loaded, self.last = loaded, last
        self.scale: dict[int, float] | None = None
        sources: list[list[tuple[int, float]]] = []
        for index, row in enumerate(laws):
            if row:
                slot, factor = self.laws.add(row)
                sources += [[] for _ in range(slot + 1 - len(sources))]
                sources[slot].append((index, factor * factor))
        self.sources = tuple(tuple(source) for source in sources)
        self.outputs = tuple(self.motions.add(row) if row else (-1, 0.0) for row in outputs)

    def plan(self) -> Plan:
        steps = tuple(self._step(coordinate) for coordinate in self._order())
        return Plan(self.sources, len(self.laws.rows), steps, self.outputs, len(self.motions.rows))

    def _order(self) -> Iterable[int]:
        """Coordinates as they come to have the fewest neighbours; each is eliminated before the next is asked for."""
        names = {*self.laws.touching, *self.loaded, *self.motions.touching} - {self.last}
        waiting = [(len(self._neighbours(v)), v) for v in names]
        heapq.heapify(waiting)
        while waiting:
            degree, v = heapq.heappop(waiting)
            if v not in names:
                continue
            now = self._neighbours(v)
            if len(now) > degree:
                heapq.heappush(waiting, (len(now), v))
                continue
            names.discard(v)
            yield v
            for j in now & names:
                heapq.heappush(waiting, (len(self._neighbours(j)), j))
        if self.last is not None:
            yield self.last

    def _neighbours(self, coordinate: int) -> set[int]:
        rows = self.laws.rows
        return {j for number in self.laws.touching.get(coordinate, ()) for j in rows[number]} - {coordinate}

    def _step(self, v: int) -> Step:
        splits = self._split(v)
        slots = self.laws.take(v)
        rows = [self.laws.rows[slot] for slot in slots]
        pairs, loads = tuple(self._pairs(v, rows)), self._loads(v, rows)
        motions = tuple(self._motion(v, number, rows) for number in self.motions.take(v))
        shared = {*(pair.i for pair in pairs), *(i for i, _, _ in loads)}
        shared |= {i for motion in motions for i, _, _ in motion.parts}
        return Step(
            coordinate=v,
            terms=tuple((slot, row[v] * row[v]) for slot, row in zip(slots, rows, strict=True)),
            splits=splits,
            pairs=pairs,
            loads=loads,
            motions=motions,
            closes_loop=len({j for row in rows for j in row}) > 2,  # noqa: PLR2004
            shared=tuple(sorted(shared)),
        )

    def _pairs(self, v: int, rows: Sequence[Row]) -> Iterable[Pair]:
        for i, first in enumerate(rows):
            for j in range(i + 1, len(rows)):
                row = combined(first, rows[j], v)
                if row:
                    target, factor = self.laws.add(row)
                    yield Pair(i, j, factor * factor, target)

    def _loads(self, v: int, rows: Sequence[Row]) -> tuple[tuple[int, int, float], ...]:
        if v not in self.loaded:
            return ()
        found = tuple((i, j, -row[v] * row[j]) for i, row in enumerate(rows) for j in row if j != v)
        self.loaded.update(j for _, j, _ in found)
        return found

    def _motion(self, v: int, number: int, rows: Sequence[Row]) -> Motion:
        row, parts = self.motions.rows[number], []
        for i, law in enumerate(rows):
            rest = combined(row, law, v)
            if rest:
                source, factor = self.motions.add(rest)
                parts.append((i, law[v] * factor, source))
        return Motion(number, row[v] if v in self.loaded else 0.0, tuple(parts))

    def _split(self, v: int) -> tuple[tuple[int, tuple[tuple[int, float], ...]], ...]:
        """Where rows on v would multiply, hand those that are not along the common motion to links and grounds."""
        numbers = self.laws.touching.get(v, set())
        if len(numbers) <= MOST_ROWS * (len(self._neighbours(v)) + 1):
            return ()
        if self.scale is None:
            self.scale = collections.defaultdict(lambda: 1.0, common_motion(self.laws.rows))
        splits = []
        for number in sorted(numbers):
            row = self.laws.rows[number]
            shares = list(clique(row, self.scale)) if len(row) > 1 else []
            if len(shares) > 1:
                self.laws.remove(number)
                added = [(*self.laws.add(part), weight) for part, weight in shares]
                splits.append((number, tuple((slot, weight * factor**2) for slot, factor, weight in added)))
        return tuple(splits)

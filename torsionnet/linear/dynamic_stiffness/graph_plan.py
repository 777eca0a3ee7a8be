"""Elimination order of the coordinates of a drivetrain's graph, found once for all frequencies and parameters.

With D = sum_e kappa_e a_e a_e^T, eliminating coordinate v with S = sum_e kappa_e a_ev^2 leaves

    D' = sum_{e<f} kappa_e kappa_f / S  b b^T,    b = a_fv a_e - a_ev a_f

one row b for each pair of rows that touch v. Among links and grounds this is star-mesh: two links y_vi, y_vj give the
link y_vi y_vj / S, a link and the ground g_v give the ground y_vi g_v / S. Nothing is subtracted, so that a drivetrain
that turns freely keeps its full accuracy however slow it is. Ratios, and laws over three and more coordinates, are rows
like any other. Loads are rows with a weight, f = sum_l w_l l, and pass to the same rows as motions r q that are read:

    w_l l  ->  w_l (kappa_e a_ev / S) b_e,                    b_e = a_ev l - l_v a_e
    r q    =   r_v f_v / S + sum_e (kappa_e a_ev / S) b_e q,  b_e = a_ev r - r_v a_e,  f_v = sum_l w_l l_v

Given columns (imposed angles, gaps of rigid connections) are in all rows and never eliminated. A motion over them alone
is known. The reaction on one of them, g, is what arrives there, sum_l w_l l_g - sum_e kappa_e a_eg (a_e q); it is taken
as soon as a single row is left that knows g, so that nothing is subtracted there either.

Coordinates with few rows go first: on a tree the leaves, without fill.

Steps of an elimination on the graph, as operations on numbered slots without numerical values.

Slots hold dynamic stiffnesses of rows kappa, weights of loads w, and motions of rows; each is an array over points.
"""

from __future__ import annotations

import collections
import heapq
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from torsionnet.linear.assembly.law_stiffness import LawTerms
from torsionnet.linear.dynamic_stiffness.row_algebra import (
    DOUBLE,
    Accuracy,
    Row,
    RowTable,
    combine_rows,
    common_motion,
    equivalent_links,
)


class EliminatedPair(NamedTuple):
    """Pair of rows i < j that adds factor kappa_i kappa_j / S to the stiffness ``target`` in an elimination."""

    i: int
    j: int
    factor: float
    target: int


class PassedLoad(NamedTuple):
    """Load that an eliminated coordinate passes on to another row, w[target] += factor (kappa_i / S) w[slot]."""

    slot: int
    i: int
    factor: float
    target: int


@dataclass(frozen=True)
class MotionStep:
    """Formula for the motion of a row by back-substitution, once later coordinates are known.

    value[slot] = load f_v / S + sum of factor (kappa_i / S) value[source] over ``terms`` (i, factor, source).
    """

    slot: int
    load: float
    terms: tuple[tuple[int, float, int], ...]


@dataclass(frozen=True)
class EliminationStep:
    """Elimination of one coordinate, with the stiffnesses and loads that pass on to its neighbours.

    Attributes
    ----------
    coordinate : int
    handed_on : tuple of (slot, ((slot, weight), ...))
        Before all else: kappa of a row that other rows take over.
    terms : tuple of (slot, a_v^2)
        S = sum of a_v^2 kappa[slot].
    pairs : tuple of EliminatedPair
    loads : tuple of (slot, l_v)
        f_v = sum of l_v w[slot].
    passed : tuple of PassedLoad
    motions : tuple of MotionStep
        Needed on the way back, in reverse order of the steps.
    shared : tuple of int
        Places among the terms of which kappa_i / S is needed.
    """

    coordinate: int
    handed_on: tuple[tuple[int, tuple[tuple[int, float], ...]], ...]
    terms: tuple[tuple[int, float], ...]
    pairs: tuple[EliminatedPair, ...]
    loads: tuple[tuple[int, float], ...]
    passed: tuple[PassedLoad, ...]
    motions: tuple[MotionStep, ...]
    shared: tuple[int, ...]


@dataclass(frozen=True)
class ReactionStep:
    """Formula for the torque that holds an imposed angle or a rigid connection, as sums over stiffnesses and loads.

    The sum is of factor kappa[slot] value[motion] over ``laws``, and of factor w[slot] over ``loads``.
    """

    laws: tuple[tuple[int, float, int], ...]
    loads: tuple[tuple[int, float], ...]


@dataclass(frozen=True)
class EliminationPlan:
    """Order and steps that eliminate all coordinates from the equations of motion, for all frequencies and values.

    Attributes
    ----------
    sources : tuple of ((law, factor), ...)
        kappa[slot] = sum of factor kappa_law, for the first slots.
    n_slots, n_loads, n_motions : int
        Numbers of slots for kappa, for weights of loads and for motions.
    n_excitations : int
    weights : tuple of (slot, excitation, factor)
        Loads to begin with.
    given : tuple of (motion slot, (motion under every excitation, ...))
        Motions that need not be solved for.
    steps : tuple of EliminationStep
    outputs : tuple of (motion slot or -1, factor)
    reactions : tuple of ReactionStep
    """

    sources: tuple[tuple[tuple[int, float], ...], ...]
    n_slots: int
    n_loads: int
    n_motions: int
    n_excitations: int
    weights: tuple[tuple[int, int, float], ...]
    given: tuple[tuple[int, tuple[float, ...]], ...]
    steps: tuple[EliminationStep, ...]
    outputs: tuple[tuple[int, float], ...]
    reactions: tuple[ReactionStep, ...]

    @cached_property
    def law_terms(self) -> tuple[LawTerms, ...]:
        """Sources as arrays: the first terms of all sums, then the second ones, ..., so that no slot comes twice."""
        terms = []
        for number in range(max(map(len, self.sources), default=0)):
            some = [(slot, *source[number]) for slot, source in enumerate(self.sources) if len(source) > number]
            slots, laws, factors = zip(*some, strict=True)
            terms.append(LawTerms(np.array(slots), np.array(laws), np.array(factors)))
        return tuple(terms)


SPLIT_ROW_MULTIPLE = 2
"""Rows on one coordinate, over the links and grounds that would replace them, above which they are split into these, as
elimination then takes fewer operations."""
MOST_UNSPLIT_ROWS = 30
"""Number of rows on a coordinate up to which rows are never split into links and grounds, as splitting subtracts and
costs digits."""


def make_plan(
    laws: Sequence[Row],
    n_free: int,
    loads: Sequence[Row],
    motions: Sequence[Row],
    outputs: Sequence[Row],
    reactions: Sequence[int],
    *,
    other_order: bool = False,
    accuracy: Accuracy = DOUBLE,
) -> EliminationPlan:
    """Elimination plan that yields the motions of ``outputs`` and the reaction torques on given columns.

    Parameters
    ----------
    laws : sequence of rows
        The row of every law; columns from ``n_free`` on are given.
    n_free : int
    loads, motions : sequences of rows
        Of every excitation: torques on columns, and motions of given columns.
    outputs : sequence of rows
    reactions : sequence of int
        Given columns.
    other_order : bool
        Eliminate towards another root than the first load.
    accuracy : Accuracy
        Of the coefficients.
    """
    planner = _Planner(laws, n_free, loads, motions, outputs, reactions, accuracy)
    if other_order:
        planner.choose_other_root()
    steps = tuple(planner.step(coordinate) for coordinate in planner.order())
    for column in planner.open:
        planner.taken[column] = planner.reaction(column)
    # Motions of imposed angles alone are the same angles in rad under every excitation, whatever the drivetrain.
    given = [
        (slot, tuple(sum(a * motion.get(j, 0.0) for j, a in row.items()) for motion in motions))
        for slot, row in enumerate(planner.motions.rows)
        if min(row) >= n_free
    ]
    return EliminationPlan(
        sources=tuple(map(tuple, planner.sources)),
        n_slots=len(planner.laws.rows),
        n_loads=len(planner.loads.rows),
        n_motions=len(planner.motions.rows),
        n_excitations=len(motions),
        weights=tuple((weights[0], e, weights[1]) for e, weights in planner.weights if weights),
        given=tuple(given),
        steps=steps,
        outputs=planner.outputs,
        reactions=tuple(planner.taken[column] for column in reactions),
    )


class _Planner:
    def __init__(
        self,
        laws: Sequence[Row],
        n_free: int,
        loads: Sequence[Row],
        motions: Sequence[Row],
        outputs: Sequence[Row],
        reactions: Sequence[int],
        accuracy: Accuracy,
    ) -> None:
        self.n_free, self.accuracy = n_free, accuracy
        self.driven, self.open = {j for motion in motions for j in motion}, set(reactions)
        self.taken: dict[int, ReactionStep] = {}
        self.laws, self.loads, self.motions = (RowTable(accuracy) for _ in range(3))
        self.scale: dict[int, float] | None = None
        # Laws on one row up to a factor f share a slot, whose dynamic stiffness is the sum of f^2 kappa.
        self.sources: list[list[tuple[int, float]]] = []
        for index, row in enumerate(laws):
            if there := self._law(row):
                slot, factor = there
                self.sources += [[] for _ in range(slot + 1 - len(self.sources))]
                self.sources[slot].append((index, factor * factor))
        self.weights = [(e, self._kept(self.loads, row)) for e, row in enumerate(loads)]
        self.outputs = tuple(self._kept(self.motions, row) or (-1, 0.0) for row in outputs)
        self.last = min((j for row in loads[:1] for j in row if j < n_free), default=None)

    def choose_other_root(self) -> None:
        """End the elimination at another coordinate than that of the first load, so that rounding errors differ."""
        free = (j for table in (self.motions, self.laws) for row in table.rows for j in row if j < self.n_free)
        self.last = next(free, None) if self.last is None else None

    # --- rows -------------------------------------------------------------------------------------------------------

    def _law(self, row: Row) -> tuple[int, float] | None:
        """Number of the row that holds a law's stiffness, and factor of the law's own row on it, or None if not needed.

        A law is not needed if it resists only given motions that are not read.
        """
        row = {j: a for j, a in row.items() if j < self.n_free or j in self.driven or j in self.open}
        between_given = any(j in self.driven for j in row) and any(j in self.open for j in row)
        if any(j < self.n_free for j in row) or between_given:
            return self.laws.add(row)
        return None

    def _kept(self, table: RowTable, row: Row) -> tuple[int, float] | None:
        """Number and factor of a load or motion in its table, over coordinates and those given columns that count.

        Loads do work on open gaps, motions follow driven columns. None where nothing is left of the row.
        """
        given = self.open if table is self.loads else self.driven
        row = {j: a for j, a in row.items() if j < self.n_free or j in given}
        return table.add(row) if row else None

    # --- order ------------------------------------------------------------------------------------------------------

    def order(self) -> Iterable[int]:
        """Yield the coordinates in order of elimination, fewest rows first, each eliminated before the next is chosen.

        Among links and grounds these are those with the fewest neighbours: on a tree the leaves, without fill.
        """
        touched = {*self.laws.touching, *self.loads.touching, *self.motions.touching}
        names = {j for j in touched if j < self.n_free} - {self.last}
        touching = self.laws.touching
        waiting = [(len(touching.get(v, ())), v) for v in names]
        heapq.heapify(waiting)
        while waiting:
            expected, v = heapq.heappop(waiting)
            if v not in names:
                continue
            # Elimination around it has given it more rows since.
            now = len(touching.get(v, ()))
            if now > expected:
                heapq.heappush(waiting, (now, v))
                continue
            names.discard(v)
            around = self._neighbours(v) & names
            yield v
            for j in around:
                heapq.heappush(waiting, (len(touching.get(j, ())), j))
        if self.last is not None:
            yield self.last

    def _neighbours(self, coordinate: int) -> set[int]:
        rows = self.laws.rows
        return {j for number in self.laws.touching.get(coordinate, ()) for j in rows[number]} - {coordinate}

    # --- steps ------------------------------------------------------------------------------------------------------

    def step(self, v: int) -> EliminationStep:
        """Elimination of coordinate v: its pivot, and what takes the place of the rows, loads and motions on v.

        The equations, with b and b_e, stand in the header of the module.
        """
        # Reactions on given columns are taken as soon as they depend on a single row.
        handed_on = [*self._settled_reactions()] if self.open else []
        # Many rows on v: the fewer links and grounds that equal them take their place.
        n_rows = len(self.laws.touching.get(v, ()))
        if n_rows > MOST_UNSPLIT_ROWS and n_rows > SPLIT_ROW_MULTIPLE * (len(self._neighbours(v)) + 1):
            handed_on += self._split_into_links(v)
        slots, loads = self.laws.take(v), self.loads.take(v)
        rows = [self.laws.rows[slot] for slot in slots]
        # D': one row b for each pair of rows on v, but where b vanishes or resists given motions alone.
        pairs = [
            EliminatedPair(i, j, there[1] * there[1], there[0])
            for i, first in enumerate(rows)
            for j in range(i + 1, len(rows))
            if (there := self._law(combine_rows(first, rows[j], v, self.accuracy)))
        ]
        # w_l l -> w_l (kappa_e a_ev/S) b_e: a load on v goes where each row ties v to, by the row's share of S.
        passed = [
            PassedLoad(slot, i, row[v] * there[1], there[0])
            for slot in loads
            for i, row in enumerate(rows)
            if (there := self._kept(self.loads, combine_rows(self.loads.rows[slot], row, v, self.accuracy)))
        ]
        # r q = r_v f_v/S + sum_e (kappa_e a_ev/S) b_e q, on the way back, when all motions but v are known.
        motions = []
        for number in self.motions.take(v):
            motion = self.motions.rows[number]
            terms = tuple(
                (i, row[v] * there[1], there[0])
                for i, row in enumerate(rows)
                if (there := self._kept(self.motions, combine_rows(motion, row, v, self.accuracy)))
            )
            motions.append(MotionStep(number, motion[v] if loads else 0.0, terms))
        shared = {*(pair.i for pair in pairs), *(part.i for part in passed)}
        shared |= {i for step in motions for i, _, _ in step.terms}
        return EliminationStep(
            coordinate=v,
            handed_on=tuple(handed_on),
            terms=tuple((slot, row[v] * row[v]) for slot, row in zip(slots, rows, strict=True)),
            pairs=tuple(pairs),
            loads=tuple((slot, self.loads.rows[slot][v]) for slot in loads),
            passed=tuple(passed),
            motions=tuple(motions),
            shared=tuple(sorted(shared)),
        )

    def _split_into_links(self, v: int) -> Iterable[tuple[int, tuple[tuple[int, float], ...]]]:
        """Yield numbers of the rows on a coordinate that links and grounds replace, with these and their weights.

        Rows along the common motion are not split.
        """
        if self.scale is None:
            self.scale = collections.defaultdict(lambda: 1.0, common_motion(self.laws.rows))
        for number in sorted(self.laws.touching[v]):
            row = self.laws.rows[number]
            shares = list(equivalent_links(row, self.scale, self.accuracy)) if len(row) > 1 else []
            if len(shares) > 1:
                yield self._handed_on(number, shares)

    def _handed_on(self, slot: int, shares: Iterable[tuple[Row, float]]) -> tuple[int, tuple[tuple[int, float], ...]]:
        """Replace a row by weighted rows, and return its number with numbers and weights of those that take over."""
        self.laws.remove(slot)
        taking_over = ((self._law(row), weight) for row, weight in shares)
        return slot, tuple((there[0], weight * there[1] ** 2) for there, weight in taking_over if there)

    # --- reactions --------------------------------------------------------------------------------------------------

    def _settled_reactions(self) -> Iterable[tuple[int, tuple[tuple[int, float], ...]]]:
        """Take reactions that depend on a single row, and yield the numbers of rows that drop the given column."""
        for column in sorted(self.open):
            slots = self.laws.touching.get(column, set())
            if len(slots) == 1 and not self.loads.touching.get(column):
                (slot,) = slots
                self.taken[column] = self.reaction(column)
                self.open.discard(column)
                yield self._handed_on(slot, [(self.laws.rows[slot], 1.0)])

    def reaction(self, column: int) -> ReactionStep:
        # sum_l w_l l_g - sum_e kappa_e a_eg (a_e q)
        laws = []
        for slot in sorted(self.laws.touching.get(column, ())):
            row = self.laws.rows[slot]
            motion = self._kept(self.motions, {j: a for j, a in row.items() if j != column})
            if motion:
                laws.append((slot, -row[column] * motion[1], motion[0]))
        loads = [(slot, self.loads.rows[slot][column]) for slot in sorted(self.loads.touching.get(column, ()))]
        return ReactionStep(tuple(laws), tuple(loads))

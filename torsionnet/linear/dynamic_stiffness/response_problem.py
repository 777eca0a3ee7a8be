"""Linear problem behind a response, with rows of laws, unit excitations, and motions and reactions to solve for.

Columns below ``n_free`` are coordinates, which follow from the equations of motion. Those from there on are given: an
imposed angle, or the gap of a rigid connection, which is held at zero so that its reaction can be read.

Operation tapes that carry out elimination plans, by back-substitution or by carrying readings forward.

Weights of loads go forward with the elimination. What is read either comes back along the way, all motions from one
solution, or goes forward like a load: the dynamic stiffness is symmetric, and with r D^-1 l built up on the way nothing
has to be kept for a way back. That is the better way for few readings.

>>> import numpy as np
>>> from torsionnet.linear.assembly.law_stiffness import LawStiffness
>>> rows = [{0: 1.0}, {1: 1.0}, {0: 1.0, 1: -1.0}]
>>> free = ResponseProblem(rows, 2, (Loading(load={0: 1.0}),), ({1: 1.0}, {0: 1.0, 1: -1.0}))
>>> J, c, k = (np.array([values]) for values in ([1.0, 3.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1e9]))
>>> motion = eliminate(free, LawStiffness(J, c, k, omega=np.array([1e-3])))
>>> [f"{value.real:.12g}" for value in motion[:, 0, 0]]
['-250000', '7.5e-10']
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import TypeAlias, TypeVar

import numpy as np

from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.assembly.rows import ComplexArray
from torsionnet.linear.dynamic_stiffness.graph_plan import EliminationPlan, EliminationStep, make_plan
from torsionnet.linear.dynamic_stiffness.row_algebra import DOUBLE, Accuracy, Row
from torsionnet.linear.dynamic_stiffness.tape import (
    CONSTANT,
    LAW,
    LAW_SUM,
    ONE,
    OUTPUT,
    Array,
    Operation,
    Tape,
    TapeQuantity,
    Writer,
    sweep,
)

MOST_FORWARD_READINGS = 2
"""Largest number of readings that are carried forward with the loads, as that takes fewer operations than
back-substitution for so few."""
Key = TypeVar("Key")
"""Key of a quantity in a table, the number of a slot or of a reading, or of a reading and an excitation."""


def make_tape(plan: EliminationPlan) -> Tape:
    """Operation tape of an elimination plan, whose value n_excitations * reading + excitation is that reading.

    Examples
    --------
    >>> from torsionnet.linear.dynamic_stiffness.graph_plan import make_plan
    >>> tape = make_tape(make_plan([{0: 1.0}, {0: 1.0, 1: -1.0}], 2, [{1: 1.0}], [{}], [{1: 1.0}], ()))
    >>> len(tape.operations), tape.n_registers
    (6, 3)
    """
    n_read = len(plan.outputs) + len(plan.reactions)
    taping = (_Forward if n_read <= MOST_FORWARD_READINGS else _Back)(plan)
    for (reading, excitation), value in taping.read().items():
        number, name = reading * plan.n_excitations + excitation, taping.writer.name(value)
        taping.writer.operations.append(Operation(OUTPUT, number, name, 0, value.factor))
    return taping.writer.tape(n_read * plan.n_excitations)


@dataclass(frozen=True)
class _Eliminated:
    """Elimination step with the shares kappa_i / S of its rows, and the motion f_v / S in rad by excitation."""

    step: EliminationStep
    shares: dict[int, TapeQuantity]
    loads: dict[int, TapeQuantity]


class _Taping:
    """Writer of the part of a tape that both kinds have in common, the elimination of laws and loads.

    ``read`` of either kind gives the values of what is read, by the numbers of reading and excitation.
    """

    def __init__(self, plan: EliminationPlan) -> None:
        self.plan, self.writer = plan, Writer()
        self.links: dict[int, TapeQuantity] = {}
        self.fresh = set(range(len(plan.sources)))
        self.weights: list[dict[int, TapeQuantity]] = [{} for _ in range(plan.n_excitations)]
        for slot, excitation, factor in plan.weights:
            self._add(self.weights[excitation], slot, TapeQuantity(-1, factor))

    def _add(self, table: dict[Key, TapeQuantity], key: Key, term: TapeQuantity) -> None:
        table[key] = self.writer.plus(table.get(key), term)

    def _link(self, slot: int, added: TapeQuantity | None = None) -> TapeQuantity:
        """Dynamic stiffness in N m/rad of a row slot, with a term ``added``, as a quantity of the tape.

        That of laws is not worked out before use.
        """
        if slot in self.fresh:
            self.fresh.discard(slot)
            if added is None:
                name = self.writer.new(LAW, b=slot)
            else:
                name = self.writer.new(LAW_SUM, self.writer.name(added), slot, added.factor)
            self.links[slot] = TapeQuantity(name, 1.0)
        elif added is not None:
            self.links[slot] = self.writer.plus(self.links.get(slot), added)
        return self.links[slot]

    def _eliminated(self) -> Iterable[_Eliminated]:
        """Write the elimination of one coordinate after the other, and yield its shares and the motions of loads."""
        writer = self.writer
        for step in self.plan.steps:
            for slot, parts in step.handed_on:
                for target, weight in parts:
                    self._link(target, added=writer.times(self._link(slot), TapeQuantity(-1, weight)))
            if not (step.shared or step.loads):
                yield _Eliminated(step, {}, {})
                continue
            terms = [self._link(slot) for slot, _ in step.terms]
            # Pivot S = sum kappa_e a_ev^2 in N m/rad, the total stiffness on the coordinate.
            pivot = None
            for term, (_, square) in zip(terms, step.terms, strict=True):
                pivot = writer.plus(pivot, writer.times(term, TapeQuantity(-1, square)))
            S = pivot or TapeQuantity(writer.new(CONSTANT, factor=0.0), 1.0)
            # Shares s_i = kappa_i/S; several of them by one reciprocal, as a product takes less than a quotient.
            if len(step.shared) > 1:
                inverse = writer.over(ONE, S)
                shares = {i: writer.times(terms[i], inverse) for i in step.shared}
            else:
                shares = {i: writer.over(terms[i], S) for i in step.shared}
            # D' = sum_{i<j} factor s_i kappa_j b b^T.
            for i, j, factor, target in step.pairs:
                pair = writer.times(writer.times(shares[i], terms[j]), TapeQuantity(-1, factor))
                self._link(target, added=pair)
            loads = {}
            for excitation, weights in enumerate(self.weights):
                # w[target] += factor s_i w[slot]: loads on the coordinate pass on to other rows ...
                for slot, i, factor, target in step.passed:
                    if slot in weights:
                        passed = writer.times(writer.times(weights[slot], shares[i]), TapeQuantity(-1, factor))
                        self._add(weights, target, passed)
                # ... and their sum over S is the motion that they cause on the spot.
                load = None
                for slot, factor in step.loads:
                    if slot in weights:
                        load = writer.plus(load, writer.times(weights[slot], TapeQuantity(-1, factor)))
                if load is not None:
                    loads[excitation] = writer.over(load, S)
            yield _Eliminated(step, shares, loads)


class _Back(_Taping):
    """Writer of a tape with back-substitution, which gives all motions under one excitation after another."""

    def read(self) -> dict[tuple[int, int], TapeQuantity]:
        way = list(self._eliminated())
        values: dict[tuple[int, int], TapeQuantity] = {}
        for excitation in range(self.plan.n_excitations):
            motions = self._motions(way, excitation)
            for reading, value in self._read(motions, excitation):
                values[reading, excitation] = value
        return values

    def _motions(self, way: Sequence[_Eliminated], excitation: int) -> dict[int, TapeQuantity]:
        writer = self.writer
        motions = {slot: TapeQuantity(-1, given[excitation]) for slot, given in self.plan.given if given[excitation]}
        # Back along the way: r q = r_v f_v/S + sum_e (kappa_e a_ev/S) b_e q, equation (3.5).
        for eliminated in reversed(way):
            for motion in eliminated.step.motions:
                total = None
                if motion.load and excitation in eliminated.loads:
                    total = writer.times(eliminated.loads[excitation], TapeQuantity(-1, motion.load))
                for i, factor, source in motion.terms:
                    if source in motions:
                        part = writer.times(eliminated.shares[i], motions[source])
                        part = writer.times(part, TapeQuantity(-1, factor))
                        total = writer.plus(total, part)
                if total is not None:
                    motions[motion.slot] = total
        return motions

    def _read(self, motions: dict[int, TapeQuantity], excitation: int) -> Iterable[tuple[int, TapeQuantity]]:
        writer = self.writer
        for number, (slot, factor) in enumerate(self.plan.outputs):
            if slot in motions:
                yield number, writer.times(motions[slot], TapeQuantity(-1, factor))
        for number, reaction in enumerate(self.plan.reactions, len(self.plan.outputs)):
            total = None
            # Reaction of a given column, sum_l w_l l_g - sum_e kappa_e a_eg (a_e q).
            for slot, factor, motion in reaction.laws:
                if motion in motions:
                    torque = writer.times(writer.times(self._link(slot), motions[motion]), TapeQuantity(-1, factor))
                    total = writer.plus(total, torque)
            for slot, factor in reaction.loads:
                if slot in self.weights[excitation]:
                    weight = self.weights[excitation][slot]
                    total = writer.plus(total, writer.times(weight, TapeQuantity(-1, factor)))
            if total is not None:
                yield number, total


class _Forward(_Taping):
    """Writer of a tape with readings carried forward as weights, which the loads meet on the way."""

    def read(self) -> dict[tuple[int, int], TapeQuantity]:
        writer = self.writer
        self.carried: dict[int, dict[int, TapeQuantity]] = defaultdict(dict)
        values: dict[tuple[int, int], TapeQuantity] = {}
        for number, (slot, factor) in enumerate(self.plan.outputs):
            self._add(self.carried[slot], number, TapeQuantity(-1, factor))
        for eliminated in self._eliminated():
            for motion in eliminated.step.motions:
                for reading, weight in self._weights_on(motion.slot):
                    # r q = sum factor s_i (b q): the weight of the motion passes on to those it is made of ...
                    for i, factor, source in motion.terms:
                        part = writer.times(weight, eliminated.shares[i])
                        self._add(self.carried[source], reading, writer.times(part, TapeQuantity(-1, factor)))
                    # ... and meets f_v / S, what loads do on the spot.
                    if motion.load:
                        own = writer.times(weight, TapeQuantity(-1, motion.load))
                        for e, met in [(e, writer.times(own, load)) for e, load in eliminated.loads.items()]:
                            self._add(values, (reading, e), met)
        for slot, given in self.plan.given:
            for reading, weight in self._weights_on(slot):
                angles = [(e, TapeQuantity(-1, angle)) for e, angle in enumerate(given) if angle]
                for e, met in [(e, writer.times(weight, angle)) for e, angle in angles]:
                    self._add(values, (reading, e), met)
        for number, reaction in enumerate(self.plan.reactions, len(self.plan.outputs)):
            for slot, factor in reaction.loads:
                for excitation, weights in enumerate(self.weights):
                    if slot in weights:
                        held = writer.times(weights[slot], TapeQuantity(-1, factor))
                        self._add(values, (number, excitation), held)
        return values

    def _weights_on(self, slot: int) -> list[tuple[int, TapeQuantity]]:
        """Weights by reading with which the motion of this number counts, reactions that depend on it included."""
        for number, reaction in enumerate(self.plan.reactions, len(self.plan.outputs)):
            for law, factor, motion in reaction.laws:
                if motion == slot:
                    weight = self.writer.times(self._link(law), TapeQuantity(-1, factor))
                    self._add(self.carried[slot], number, weight)
        return list(self.carried.pop(slot, {}).items())


MOST_SINGLE_TORQUES = 4
"""Largest number of excitation torques that are solved one by one, since each then has its own coordinate at the root
of the tree."""
RECENT_PLANS, LARGEST_KEPT = 16, 2500
"""Number of recent plans with their tapes that are kept, and largest number of laws of one, for the sake of memory."""
GOLDEN = (math.sqrt(5) - 1) / 2
"""Golden ratio minus one, whose multiples modulo 1 spread the scale factors of coordinates most evenly."""


@dataclass(frozen=True)
class Loading:
    """Unit excitation, torques ``load`` in N m by column and angles ``motion`` in rad of given columns.

    All other given columns are at rest.
    """

    load: Row = field(default_factory=dict)
    motion: Row = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class ResponseProblem:
    """Linear problem behind a response, with rows of laws, excitations, and motions and reactions to solve for.

    Attributes
    ----------
    laws : sequence of rows
        gamma of every law over all columns.
    n_free : int
        Number of coordinates.
    excitations : tuple of Loading
    outputs : tuple of rows
        Rows of the motions to be solved for, over all columns.
    reactions : tuple of int
        Given columns whose reaction is solved for: the torque that the drivetrain, held there, exerts.
    other_order : bool
        Whether to eliminate towards another root, in coordinates of odd sizes: which gives the same but for rounding.
    accuracy : Accuracy
        Of the coefficients in all rows.
    """

    laws: Sequence[Row]
    n_free: int
    excitations: tuple[Loading, ...]
    outputs: tuple[Row, ...]
    reactions: tuple[int, ...] = ()
    other_order: bool = False
    accuracy: Accuracy = DOUBLE

    @property
    def n_read(self) -> int:
        return len(self.outputs) + len(self.reactions)

    @cached_property
    def eliminations(self) -> tuple[tuple[list[int], ResponseProblem], ...]:
        """Groups of excitation numbers that one elimination solves, each group with its response problem.

        Few torques are solved one by one, and all imposed motions at once.
        """
        loads = [number for number, loading in enumerate(self.excitations) if not loading.motion]
        motions = [number for number, loading in enumerate(self.excitations) if loading.motion]
        groups = [[number] for number in loads] if len(loads) <= MOST_SINGLE_TORQUES else [loads]
        groups += [motions] if motions else []
        if len(groups) == 1:
            return ((groups[0], self),)
        return tuple(
            (group, replace(self, excitations=tuple(self.excitations[number] for number in group))) for group in groups
        )

    @cached_property
    def in_other_order(self) -> ResponseProblem:
        """Copy of the response problem with another elimination order and scales, so that rounding errors differ.

        Where what is read is a small difference, as of 1 and a share next to it, its digits end with those of the 1,
        however the stiffnesses are moved. In other sizes it is no longer 1.
        """
        return replace(self, other_order=True)

    @cached_property
    def planned(self) -> tuple[EliminationPlan, Tape]:
        """Plan and tape, which depend on rows alone: a model whose values alone change asks for the same again."""
        rows = [[*self.laws], [excitation.load for excitation in self.excitations], [*self.outputs]]
        if self.other_order:
            # Coordinates in odd sizes, q_j = d_j q'_j with d_j between 1 and 2, different for each.
            odd = [1 + (column + 1) * GOLDEN % 1 for column in range(self.n_free)]
            rows = [
                [{j: a * odd[j] if j < self.n_free else a for j, a in row.items()} for row in some] for some in rows
            ]
        laws, loads, outputs = (tuple(tuple(row.items()) for row in some) for some in rows)
        motions = tuple(tuple(excitation.motion.items()) for excitation in self.excitations)
        planned = recent_plan if len(laws) <= LARGEST_KEPT else recent_plan.__wrapped__
        return planned(
            laws, self.n_free, loads, motions, outputs, self.reactions, other_order=self.other_order,
            accuracy=self.accuracy,
        )  # fmt: skip


FixedRows: TypeAlias = tuple[tuple[tuple[int, float], ...], ...]
"""Rows that can be part of a key."""


@lru_cache(maxsize=RECENT_PLANS)
def recent_plan(
    laws: FixedRows,
    n_free: int,
    loads: FixedRows,
    motions: FixedRows,
    outputs: FixedRows,
    reactions: tuple[int, ...],
    *,
    other_order: bool,
    accuracy: Accuracy,
) -> tuple[EliminationPlan, Tape]:
    """Elimination plan and its tape, kept for rows that come again."""
    rows, torques, angles, read = ([dict(row) for row in some] for some in (laws, loads, motions, outputs))
    plan = make_plan(rows, n_free, torques, angles, read, reactions, other_order=other_order, accuracy=accuracy)
    return plan, make_tape(plan)


Walk: TypeAlias = Callable[[Tape, LawStiffness], Array]


def eliminate(problem: ResponseProblem, laws: LawStiffness, walk: Walk = sweep) -> ComplexArray:
    """Motions (rad) and reactions (N m) per unit excitation, (n_read, n_exc, n_points), by tapes run in numpy.

    Another ``walk`` runs them in another way.
    """
    values = np.zeros((problem.n_read, len(problem.excitations), laws.n_points), dtype=complex)
    with np.errstate(all="ignore"):
        for excitations, part in problem.eliminations:
            plan, tape = part.planned
            solved = walk(tape, laws.law_sums(len(plan.sources), plan.law_terms))
            values[:, excitations] = solved.reshape(problem.n_read, len(excitations), laws.n_points)
    return values

"""Linear problem behind a response, with rows of laws, unit excitations, and motions and reactions to solve for.

Columns below ``n_free`` are coordinates, which follow from the equations of motion. Those from there on are given: an
imposed angle, or the gap of a rigid connection, which is held at zero so that its reaction can be read.

Here as well: the problem for named outputs and measured inputs, and the map from its solution to their readings.

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
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from torsionnet.linear.assembly.law_stiffness import Functional, LawStiffness, Term
from torsionnet.linear.assembly.rows import Assembly, ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.graph_plan import EliminationPlan, make_plan
from torsionnet.linear.dynamic_stiffness.row_algebra import DOUBLE, Accuracy, Row
from torsionnet.linear.dynamic_stiffness.tape import OUTPUT, Array, Tape, make_tape, sweep
from torsionnet.model.channels import Input
from torsionnet.model.kinematics import exact_row

if TYPE_CHECKING:
    from torsionnet.linear.assembly.action_laws import ActionLaw

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


Number: TypeAlias = Callable[[Any], Any]
"""Function that makes the coefficient of a row from a rational, as a float or as a number with many digits."""


class SolvedTerm(NamedTuple):
    """Term of a reading, which is ``factor``, or the coefficient of ``term``, times row ``solved`` of the solution."""

    solved: int
    term: Term | None
    factor: Fraction = Fraction(1)

    def contribution(self, laws: LawStiffness, values: ComplexArray) -> ComplexArray:
        """Contribution of this term to the reading, in its unit per unit excitation, shape (n_exc, n_points)."""
        if self.term is None:
            return np.asarray(float(self.factor) * values[self.solved])
        # Factor on the angle of the term: s^power, or the dynamic stiffness of its law.
        law = self.term.law
        gain = laws.s**self.term.power if law is None else laws.of(law)
        return np.asarray(float(self.term.factor) * gain * values[self.solved])


@dataclass(frozen=True)
class Gap:
    """Virtual opening, in rad, of a rigid connection whose torque is read, with the laws and nodes that it moves."""

    laws: Mapping[int, Fraction]
    nodes: Mapping[str, Fraction]

    def work(self, row: Mapping[str, Fraction | int]) -> Fraction:
        """Work in J, per rad that the gap opens, of the torques in N m that ``row`` gives by node."""
        return sum((share * self.nodes.get(node, Fraction(0)) for node, share in row.items()), start=Fraction(0))


@dataclass(frozen=True, eq=False)
class ReadingProblem:
    """Response problem for all readings of a request, with the map from its solution to every reading.

    Attributes
    ----------
    problem : ResponseProblem
    readings : tuple of SolvedTerm
        Every reading as a single term of the solution.
    terms : tuple of (SolvedTerm, ...)
        Of measured inputs, what their size is compared with: the reading written out as terms of motion.
    applied : (n_readings, n_exc) array
        The share of applied torques in that.
    sensed : tuple of int
        Which of what is solved the actions follow; their torques are the last excitations of the problem.
    driven : tuple of mapping
        Action -> factor of its torque in every reading.
    """

    problem: ResponseProblem
    readings: tuple[SolvedTerm, ...]
    terms: tuple[tuple[SolvedTerm, ...], ...]
    applied: FloatArray
    sensed: tuple[int, ...] = ()
    driven: tuple[Mapping[int, Fraction], ...] = ()

    @property
    def n_excitations(self) -> int:
        """Number of the request's excitations, in which the torques of actions are not counted."""
        return len(self.problem.excitations) - len(self.sensed)

    def excitations_reaching(self, reading: int) -> frozenset[int]:
        """Numbers of the excitations that move a reading at all, directly or by way of actions."""
        # Excitations by the motion or reaction that they reach: only those are outputs on a tape, numbered
        # n_excitations * solved + number. All others are zero whatever the stiffnesses.
        reached: dict[int, set[int]] = {}
        for excitations, part in self.problem.eliminations:
            operations = part.planned[1].operations
            for value in operations[operations[:, 0] == OUTPUT, 1].tolist():
                place, number = divmod(value, len(excitations))
                reached.setdefault(place, set()).add(excitations[number])
        reaching = set(reached.get(self.readings[reading].solved, ()))
        # Excitations after those of the request are torques of actions, which hand on what they sense.
        waiting = [*self.driven[reading], *(number - self.n_excitations for number in reaching)]
        seen: set[int] = set()
        while waiting:
            action = waiting.pop()
            if action < 0 or action in seen:
                continue
            seen.add(action)
            more = reached.get(self.sensed[action], set())
            reaching |= more
            waiting += [number - self.n_excitations for number in more]
        return frozenset(number for number in reaching if number < self.n_excitations)

    @cached_property
    def in_other_order(self) -> ReadingProblem:
        """Copy of the response problem that is eliminated in another order, so that its rounding errors differ."""
        return replace(self, problem=self.problem.in_other_order)


def make_reading_problem(
    assembly: Assembly,
    outputs: Sequence[Functional],
    measured: Sequence[Functional],
    excitations: Sequence[Input],
    number: Number = float,
    accuracy: Accuracy = DOUBLE,
) -> ReadingProblem:
    """Response problem for outputs and measured inputs under excitations, with coefficients at this accuracy."""
    readings = [*outputs, *measured]
    n_given = assembly.system.n_coordinates + len(assembly.kinematics.imposed)
    twists = dict(enumerate((channel for channel in excitations if channel.is_on_element), n_given))
    twisted = {law_of_imposed_twist(assembly, channel.of): column for column, channel in twists.items()}
    rows, gaps = _Rows(assembly, number, twisted), _Gaps()
    # One term of motion is read from its row, a balance of several torques as the reaction on a gap.
    solved = [
        gaps.term(reading) if reading.applied or len(reading.terms) != 1 else rows.term(reading.terms[0])
        for reading in readings
    ]
    terms: list[tuple[SolvedTerm, ...]] = [() for _ in outputs]
    terms += [tuple(rows.term(term) for term in reading.terms) for reading in measured]
    sensed = tuple(rows.number_of(assembly.columns_of(action.sensed, number)) for action in assembly.system.actions)
    columns = dict(enumerate(gaps.opened, n_given + len(twists)))
    # gamma of every law, with what opening gaps adds to it and imposed twists take from it.
    rounded = number is float
    laws = [*assembly.law_columns] if rounded else [assembly.columns_of(row, number) for row in assembly.exact_rows]
    for column, gap in columns.items():
        for law, work in gap.laws.items():
            laws[law] = {**laws[law], column: number(work)}
    for law, column in twisted.items():
        laws[law] = {**laws[law], column: number(Fraction(-1))}
    problem = ResponseProblem(
        laws,
        assembly.system.n_coordinates,
        _loadings(assembly, excitations, columns, twists, number),
        tuple(rows.rows),
        tuple(columns),
        accuracy=accuracy,
    )
    applied = np.zeros((len(readings), len(excitations)))
    for place, reading in enumerate(measured, len(outputs)):
        for column, channel in enumerate(excitations):
            applied[place, column] = float(reading.direct(channel.row)) if channel.quantity == "torque" else 0.0
    # Reactions on gaps stand behind the motions of the solution.
    solved = [part if part.term else part._replace(solved=len(rows.rows) + part.solved) for part in solved]
    driven = tuple(reading.actions for reading in readings)
    return ReadingProblem(problem, tuple(solved), tuple(terms), applied, sensed, driven)


def law_of_imposed_twist(assembly: Assembly, element: str) -> int:
    """Number of the law in which an input imposes the twist of an element. Such an element has only one law."""
    return assembly.owners.index(element)


def _loadings(
    assembly: Assembly,
    excitations: Sequence[Input],
    gaps: Mapping[int, Gap],
    twists: Mapping[int, Input],
    number: Number,
) -> tuple[Loading, ...]:
    """Unit excitations, then a unit torque of each action, with the torques in N m that they put on gaps."""
    loadings: list[Loading] = []
    reduced = assembly.kinematics.reduction.reduced
    driving: list[Input | ActionLaw] = [*excitations, *assembly.system.actions]
    for driver in driving:
        if isinstance(driver, Input) and driver.is_on_element:
            motion = {column: number(Fraction(1)) for column, twist in twists.items() if twist == driver}
            loadings.append(Loading(motion=motion))
            continue
        # Torques on nodes as torques on coordinates, f = T^T a, and an imposed angle as its own column.
        nodes: Mapping[str, Fraction | int] = driver.row if isinstance(driver, Input) else driver.nodes
        row: Mapping[str, Any] = exact_row(reduced(driver.row)) if isinstance(driver, Input) else driver.row
        columns = assembly.columns_of(row, number)
        if isinstance(driver, Input) and driver.quantity == "angle":
            loadings.append(Loading(motion=columns))
        else:
            at_gaps = {column: number(work) for column, gap in gaps.items() if (work := gap.work(nodes))}
            loadings.append(Loading(load={**columns, **at_gaps}))
    return tuple(loadings)


@dataclass
class _Rows:
    """Motions to be solved for as rows, in which each motion stands once however many readings share it."""

    assembly: Assembly
    number: Number
    twisted: Mapping[int, int]
    """Column of the imposed twist, by the number of the law in which the twist is imposed."""
    rows: list[Row] = field(default_factory=list)
    numbers: dict[frozenset[tuple[int, float]], int] = field(default_factory=dict)

    def term(self, term: Term) -> SolvedTerm:
        row = self.assembly.columns_of(term.exact, self.number)
        if term.law is not None and term.law in self.twisted:
            row = {**row, self.twisted[term.law]: self.number(Fraction(-1))}
        return SolvedTerm(self.number_of(row), term)

    def number_of(self, row: Row) -> int:
        """Number of a motion among those to be solved for, which is appended if it is new."""
        number = self.numbers.setdefault(frozenset(row.items()), len(self.rows))
        if number == len(self.rows):
            self.rows.append(row)
        return number


@dataclass
class _Gaps:
    """Gaps at the rigid connections whose torques are solved for, each once.

    Torques at ports of one element may be equal up to a factor.
    """

    opened: list[Gap] = field(default_factory=list)
    numbers: dict[tuple[frozenset[tuple[Any, Fraction]], ...], int] = field(default_factory=dict)

    def term(self, reading: Functional) -> SolvedTerm:
        """Term by which a torque is read as one reaction on a gap, so that its exact coefficients cancel."""
        # With the virtual motion z the balance reads -kappa_i (a_i z) of every law; the column of the gap has +a_i z.
        laws: dict[int, Fraction] = {}
        for term in reading.terms:
            if term.law is not None:
                laws[term.law] = laws.get(term.law, Fraction(0)) - term.factor
        # Divided by the first size, equal gaps at several ports are one column.
        sizes = [*laws.items(), *reading.applied.items()]
        factor = next((size for _, size in sizes if size), Fraction(1))
        laws = {law: work / factor for law, work in laws.items() if work}
        nodes = {node: share / factor for node, share in reading.applied.items() if share}
        number = self.numbers.setdefault((frozenset(laws.items()), frozenset(nodes.items())), len(self.opened))
        if number == len(self.opened):
            self.opened.append(Gap(laws, nodes))
        return SolvedTerm(number, None, factor)

"""From readings and excitations by name to rows over columns, and from solved rows back to readings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from torsionnet.assembly.functionals import Functional, Term, coefficient
from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.assembly.system import Assembly
from torsionnet.channels import Input
from torsionnet.kinematics import exact_row
from torsionnet.solve.plan import felt
from torsionnet.solve.problem import Excitation, Problem
from torsionnet.solve.row_algebra import Row


class Part(NamedTuple):
    """A share of a reading: coefficient of ``term``, or else ``factor``, times number ``solved`` of what is solved."""

    solved: int
    term: Term | None
    factor: float = 1.0

    def of(self, kappa: LawStiffness, values: ComplexArray) -> ComplexArray:
        """The share (n_exc, n_lanes)."""
        if self.term is None:
            return np.asarray(self.factor * values[self.solved])
        return coefficient(self.term, kappa) * values[self.solved]


@dataclass(frozen=True, eq=False)
class Posed:
    """A problem, and what its solution says about every reading.

    Attributes
    ----------
    problem : Problem
    parts : tuple of (Part, ...)
        Every reading is the sum of its parts.
    terms : tuple of (Part, ...)
        Of measured inputs, what their size is compared with: the reading written out as terms of motion.
    applied : (n_readings, n_exc) array
        The share of applied torques in that.
    """

    problem: Problem
    parts: tuple[tuple[Part, ...], ...]
    terms: tuple[tuple[Part, ...], ...]
    applied: FloatArray

    def felt_by(self, reading: int) -> frozenset[int]:
        """Excitations that reach a reading at all."""
        found: set[int] = set()
        parts = self.problem.parts
        for number, part in enumerate(parts):
            reached = felt(part.plan)
            for share in self.parts[reading]:
                found |= {number + excitation for excitation in reached[share.solved]}
        return frozenset(found)


def pose(
    assembly: Assembly, outputs: Sequence[Functional], measured: Sequence[Functional], excitations: Sequence[Input]
) -> Posed:
    """The problem behind outputs and measured inputs."""
    readings = [*outputs, *measured]
    n_given = assembly.system.n_coordinates + len(assembly.kinematics.imposed)
    opened = {reaction.constraint: reaction for reading in readings for reaction in reading.reactions}
    gaps = {constraint: n_given + number for number, constraint in enumerate(opened)}
    laws = [dict(row) for row in assembly.law_columns] if gaps else list(assembly.law_columns)
    for constraint, reaction in opened.items():
        for law, work in reaction.work.items():
            laws[law][gaps[constraint]] = float(work)
    rows = _Rows()
    own = [tuple(rows.parts(reading.own)) for reading in readings]
    terms: list[tuple[Part, ...]] = [() for _ in outputs]
    terms += [tuple(rows.parts(reading.terms)) for reading in measured]
    place = {constraint: len(rows.rows) + number for number, constraint in enumerate(gaps)}
    torques = [
        tuple(Part(place[reaction.constraint], None, float(reaction.factor)) for reaction in reading.reactions)
        for reading in readings
    ]
    problem = Problem(
        laws,
        assembly.system.n_coordinates,
        tuple(_excitation(assembly, one, [(gaps[c], r.motion) for c, r in opened.items()]) for one in excitations),
        tuple(rows.rows),
        tuple(gaps.values()),
    )
    applied = np.zeros((len(readings), len(excitations)))
    for number, reading in enumerate(measured, len(outputs)):
        for column, one in enumerate(excitations):
            applied[number, column] = float(reading.applied(one.of)) if one.quantity == "torque" else 0.0
    parts = tuple(left + right for left, right in zip(own, torques, strict=True))
    return Posed(problem, parts, tuple(terms), applied)


def _excitation(
    assembly: Assembly, excitation: Input, gaps: Sequence[tuple[int, Mapping[str, Fraction]]]
) -> Excitation:
    effect = assembly.columns_of(exact_row(assembly.kinematics.reduced({excitation.of: 1})))
    if excitation.quantity == "angle":
        return Excitation(motion=effect)
    at_gaps = {column: float(motion[excitation.of]) for column, motion in gaps if excitation.of in motion}
    return Excitation(load={**effect, **at_gaps})


@dataclass
class _Rows:
    """Rows asked for, each once."""

    rows: list[Row] = field(default_factory=list)
    numbers: dict[frozenset[tuple[int, float]], int] = field(default_factory=dict)

    def parts(self, terms: Sequence[Term]) -> Iterator[Part]:
        for term in terms:
            number = self.numbers.setdefault(frozenset(term.columns.items()), len(self.rows))
            if number == len(self.rows):
                self.rows.append(dict(term.columns))
            yield Part(number, term)

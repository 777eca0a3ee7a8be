"""Readings in many digits, from the exact values of a model: for the few places where double precision is not enough.

All numbers are the rationals an author wrote, s may be any complex number. What cancels to less than the digits left of
its terms is zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

import numpy as np

from torsionnet.assembly.functionals import Functional, Term
from torsionnet.assembly.system import Assembly
from torsionnet.core.errors import SolveError
from torsionnet.model.channels import Input
from torsionnet.model.elimination import exact
from torsionnet.model.kinematics import exact_row, pseudo_node
from torsionnet.solve.refine import eliminate
from torsionnet.solve.transfer_request import TransferRequest

DIGITS = 200
TRUSTED = 0.55
"""Share of the digits that mean something in a sum: the others are for poles near s and for spreads of the values."""

Number: TypeAlias = Any
"""A number of mpmath."""


@dataclass(frozen=True)
class _Law:
    row: dict[str, Number]
    exact_row: dict[str, Fraction]
    inertia: Number
    damping: Number
    stiffness: Number
    loss: Number
    table: Any

    def kappa(self, s: Number) -> Number:
        """Dynamic stiffness; of a table at |Im s|, and beside the axis with its damping."""
        import mpmath

        total = self.stiffness * (1 + self.loss) + s * (self.damping + s * self.inertia)
        if self.table is not None:
            total += mpmath.mpmathify(complex(self.table.kappa(np.array([abs(float(mpmath.im(s)))]))[0]))
            total += mpmath.re(s) * number(self.table.damping[0])
        return total


class ManyDigits:
    """A request to an assembly, in as many digits as ``mpmath.workdps`` says, within which it is to be used."""

    def __init__(self, assembly: Assembly, request: TransferRequest) -> None:
        self.request = request
        self.place = {name: index for index, name in enumerate(assembly.kinematics.coordinates)}
        self.imposed = [pseudo_node(name) for name in assembly.kinematics.imposed]
        self.laws = [_law(law, row) for law, row in zip(assembly.laws, assembly.exact_rows, strict=True)]
        self.effects = [
            {name: number(a) for name, a in exact_row(assembly.kinematics.reduced({one.of: 1})).items()}
            for one in request.excitations
        ]

    def transfer(self, s: Number) -> list[list[Number]] | None:
        """Outputs over inputs at one s; None where the measured inputs do not tell the excitations apart.

        Raises
        ------
        SolveError
            No digits are left.
        """
        kappa = [law.kappa(s) for law in self.laws]
        motions = [self._motion(kappa, *pair) for pair in zip(self.request.excitations, self.effects, strict=True)]
        outputs = [self._reading(one, motions, kappa, s) for one in self.request.outputs]
        if not self.request.is_measured:
            return outputs
        return _quotient(outputs, [self._reading(one, motions, kappa, s) for one in self.request.measured])

    def _motion(self, kappa: Sequence[Number], excitation: Input, effect: dict[str, Number]) -> dict[str, Number]:
        """Every coordinate and imposed angle under a unit excitation, by name."""
        motion = dict.fromkeys(self.imposed, number(0))
        matrix: list[dict[int, Number]] = [{} for _ in self.place]
        loads = [number(0) for _ in self.place]
        if excitation.quantity == "torque":
            for name in effect.keys() & self.place.keys():
                loads[self.place[name]] = effect[name]
        else:
            motion |= effect
        for stiffness, law in zip(kappa, self.laws, strict=True):
            follows = sum((law.row[name] * motion[name] for name in law.row.keys() & motion.keys()), start=number(0))
            free = [name for name in law.row if name in self.place]
            for i in free:
                loads[self.place[i]] -= stiffness * law.row[i] * follows
                for j in free:
                    _add(matrix[self.place[i]], self.place[j], stiffness * number(law.exact_row[i] * law.exact_row[j]))
        _, solution = eliminate(matrix, loads)
        if len(solution) < len(self.place):
            raise SolveError("the response cannot be told from rounding; ask for another frequency")
        least = max((abs(angle) for angle in solution), default=number(0)) * _share()
        return motion | {name: _above(solution[index], least) for name, index in self.place.items()}

    def _reading(
        self, reading: Functional, motions: Sequence[dict[str, Number]], kappa: Sequence[Number], s: Number
    ) -> list[Number]:
        """Under every excitation; exactly 0 where nothing is left of its terms."""
        row = []
        for excitation, motion in zip(self.request.excitations, motions, strict=True):
            applied = reading.applied.get(excitation.of, 0) if excitation.quantity == "torque" else 0
            row.append(
                _left([number(applied), *(part for term in reading.terms for part in _parts(term, motion, kappa, s))])
            )
        return row


def _law(law: Any, row: dict[str, Fraction]) -> _Law:
    import mpmath

    return _Law(
        {name: number(a) for name, a in row.items()},
        row,
        number(law.inertia),
        number(law.damping),
        number(law.stiffness),
        mpmath.mpc(0, number(law.loss_factor)) if law.loss_factor else 0,
        law.table,
    )


def _share() -> Number:
    """What is left of a sum in which all digits cancel that mean something."""
    import mpmath

    return mpmath.mpf(10) ** -round(TRUSTED * mpmath.mp.dps)


def _above(value: Number, least: Number) -> Number:
    """The value, or 0 where it is rounding."""
    return value if abs(value) > least else number(0)


def number(value: Any) -> Number:
    """A rational or float with all its digits; the ratio of two integers keeps 10 * 0.1 at 1."""
    import mpmath

    fraction = exact(value)
    return mpmath.mpf(fraction.numerator) / fraction.denominator


def _parts(term: Term, motion: dict[str, Number], kappa: Sequence[Number], s: Number) -> list[Number]:
    over = number(term.factor) * (s**term.power if term.law is None else kappa[term.law])
    return [over * number(share) * motion[name] for name, share in term.exact.items()]


def _add(row: dict[int, Number], column: int, value: Number) -> None:
    row[column] = row.get(column, 0) + value


def _quotient(outputs: list[list[Number]], measured: list[list[Number]]) -> list[list[Number]] | None:
    """Outputs times the inverse of the measured inputs, sums in which nothing is left being 0.

    By Cramer's rule: an elimination would leave rounding in place of zeros of the inverse.
    """
    places = range(len(measured))
    every = (1 << len(measured)) - 1
    whole = _minors(measured).get(every, number(0))
    if not whole:
        return None
    inverse: list[list[Number]] = [[number(0)] * len(measured) for _ in places]
    for j in places:
        minors = _minors([*measured[:j], *measured[j + 1 :]])
        for k in places:
            inverse[k][j] = (-1) ** (k + j) * minors.get(every ^ (1 << k), number(0)) / whole
    parts = [[[row[k] * inverse[k][j] for k in places] for j in places] for row in outputs]
    return [[_left(terms) for terms in row] for row in parts]


def _minors(rows: Sequence[Sequence[Number]]) -> dict[int, Number]:
    """Determinants of all these rows in as many columns, by the bits of the columns; those not there are 0."""
    found = {0: number(1)}
    for row in rows:
        terms: dict[int, list[Number]] = {}
        for chosen, minor in found.items():
            for column, value in enumerate(row):
                if value and minor and not chosen >> column & 1:
                    sign = (-1) ** (chosen >> column).bit_count()
                    terms.setdefault(chosen | 1 << column, []).append(sign * value * minor)
        found = {chosen: _left(parts) for chosen, parts in terms.items()}
    return found


def _left(terms: Sequence[Number]) -> Number:
    """Their sum, exactly 0 where nothing is left of them."""
    return _above(sum(terms), _share() * sum(abs(term) for term in terms))

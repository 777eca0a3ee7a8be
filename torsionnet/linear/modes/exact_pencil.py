"""Characteristic equation of a drivetrain with controllers in rational numbers, for roots at s = 0.

P(s) of :class:`~torsionnet.linear.modes.active_pencil.ActivePencil` is a series in s with rational coefficients, delays
included, since values are given as decimals. Singularity at zero is decided exactly, and its multiplicity is counted
modulo a large prime, with the series of exponentials cut off where these no longer matter.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import factorial
from typing import TypeAlias

from torsionnet.linear.assembly.system import Assembly
from torsionnet.linear.modes.ehrlich_aberth import minimum_degree_order
from torsionnet.linear.modes.modular_arithmetic import determinant, interpolating_polynomial, primes, residue
from torsionnet.model.elimination import exact

ExactVector: TypeAlias = Mapping[int, Fraction]


@dataclass(frozen=True)
class DelayedRow:
    """Delayed terms -N(s) e^(-s delay) L in one action's row of P(s), with rational coefficients.

    ``sensed`` is L, ``numerator`` N, ascending.
    """

    row: int
    numerator: tuple[Fraction, ...]
    sensed: ExactVector
    delay: Fraction

    def coefficient(self, power: int) -> Fraction:
        """Coefficient, a rational, of s^power in the series of a controller's N(s) e^(-s delay)."""
        total = Fraction(0)
        for m, value in enumerate(self.numerator[: power + 1]):
            total += value * (-self.delay) ** (power - m) / factorial(power - m)
        return total


@dataclass(frozen=True, eq=False)
class ExactPencil:
    """Matrix P(s) of the characteristic equation in rational numbers, by entries and delayed rows of actions.

    Polynomials are ascending.
    """

    size: int
    undelayed: Mapping[tuple[int, int], tuple[Fraction, ...]]
    delayed: tuple[DelayedRow, ...]
    _powers: dict[int, list[dict[int, Fraction]]] = field(default_factory=dict)

    @classmethod
    def of(cls, assembly: Assembly) -> ExactPencil:
        """Matrix P(s) of an assembly with controllers, exact, over coordinates and then torques of actions."""
        index = {name: place for place, name in enumerate(assembly.kinematics.coordinates)}
        entries: dict[tuple[int, int], list[Fraction]] = {}

        def add(i: int, j: int, power: int, value: Fraction) -> None:
            held = entries.setdefault((i, j), [])
            held += [Fraction(0)] * (power + 1 - len(held))
            held[power] += value

        for law, row in zip(assembly.laws, assembly.exact_rows, strict=True):
            ours = {index[name]: value for name, value in row.items() if name in index}
            for power, value in enumerate((exact(law.stiffness), exact(law.damping), exact(law.inertia))):
                for i, a in ours.items() if value else ():
                    for j, b in ours.items():
                        add(i, j, power, value * a * b)
        delayed = []
        for place, action in enumerate(assembly.system.actions, len(index)):
            for name, value in action.row.items():
                if name in index:
                    add(index[name], place, 0, -value)
            for power, value in enumerate(action.denominator):
                add(place, place, power, value)
            sensed = {index[name]: value for name, value in action.sensed.items() if name in index}
            delayed.append(DelayedRow(place, action.numerator, sensed, action.delay))
        found = {place: tuple(values) for place, values in entries.items()}
        return cls(len(index) + len(assembly.system.actions), found, tuple(delayed))

    def coefficient_rows(self, k: int) -> list[dict[int, Fraction]]:
        """Rows of the coefficient matrix of s^k in the exact P(s), each as a map from column to rational."""
        if k not in self._powers:
            rows: list[dict[int, Fraction]] = [{} for _ in range(self.size)]
            for (i, j), values in self.undelayed.items():
                if k < len(values) and values[k]:
                    rows[i][j] = values[k]
            for one in self.delayed:
                factor = one.coefficient(k)
                for j, value in one.sensed.items() if factor else ():
                    rows[one.row][j] = rows[one.row].get(j, Fraction(0)) - factor * value
            self._powers[k] = [{j: value for j, value in row.items() if value} for row in rows]
        return self._powers[k]

    def coefficient_times(self, k: int, vector: ExactVector) -> dict[int, Fraction]:
        """Coefficient matrix of s^k in the exact P(s) times a vector, as a map from row to rational."""
        found = {}
        for i, row in enumerate(self.coefficient_rows(k)):
            shorter, longer = (row, vector) if len(row) < len(vector) else (vector, row)
            total = sum((value * longer[j] for j, value in shorter.items() if j in longer), start=Fraction(0))
            if total:
                found[i] = total
        return found

    def counts(self, most: int) -> tuple[int, int]:
        """Number of poles of a controlled drivetrain, and of these at zero up to ``most``, with multiplicity.

        With delays only the number at zero has a meaning.
        """
        prime = next(primes())
        entries = {place: list(values) for place, values in self.undelayed.items()}
        degree = 2 * self.size
        for one in self.delayed:
            highest = len(one.numerator) - 1 + (most if one.delay else 0)
            series = [one.coefficient(power) for power in range(highest + 1)]
            for j, value in one.sensed.items():
                held = entries.setdefault((one.row, j), [])
                held += [Fraction(0)] * (len(series) - len(held))
                for power, factor in enumerate(series):
                    held[power] -= factor * value
            degree += max(highest, len(entries[one.row, one.row]) - 1) - 2
        order, _ = minimum_degree_order(self.size, entries)
        residues = {place: [residue(value, prime) for value in values] for place, values in entries.items()}

        def value_at(point: int) -> int:
            rows: list[dict[int, int]] = [{} for _ in range(self.size)]
            for (i, j), values in residues.items():
                value = sum(factor * pow(point, power, prime) for power, factor in enumerate(values)) % prime
                if value:
                    rows[i][order[j]] = value
            return determinant(rows, prime)

        coefficients = interpolating_polynomial([value_at(point) for point in range(degree + 1)], prime)
        zeros = next((power for power, value in enumerate(coefficients) if value), 0)
        return len(coefficients) - 1, zeros


def is_singular(rows: Sequence[ExactVector]) -> bool:
    """Whether a square matrix of rationals is singular, where "no" is certain and "yes" wrong about once in 1e16.

    It depends on one prime.
    """
    prime = next(primes())
    order, _ = minimum_degree_order(len(rows), [(i, j) for i, row in enumerate(rows) for j in row])
    return not determinant([{order[j]: residue(value, prime) for j, value in row.items()} for row in rows], prime)

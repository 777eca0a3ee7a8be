"""Bordered matrix P(s) for poles against measured inputs, in rational numbers, with exact counts of its roots.

With unknown excitations u, the rates s at which the readings L(s) q + d u can stay zero are the roots of det P(s),

    P(s) = [ D(s)  -B ]  =  P_0 + P_1 s + P_2 s^2
           [ L(s)   d ]

Rounded numbers do not decide how many roots there are, how many are zero and which are repeated; the determinant modulo
large primes does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice
from typing import TypeAlias

from torsionnet.linear.assembly.law_stiffness import powers_of_s
from torsionnet.linear.assembly.system import Assembly
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest
from torsionnet.linear.modes.ehrlich_aberth import minimum_degree_order
from torsionnet.linear.modes.modular_arithmetic import (
    Coefficients,
    determinant,
    interpolating_polynomial,
    primes,
    rational_from_residue,
    residue,
    square_free,
)
from torsionnet.model.elimination import exact
from torsionnet.model.kinematics import exact_row

MAX_PRIMES = 40
"""Most primes of 61 bits that are joined, enough for coefficients of repeated factors of some 700 digits."""

ExactRow: TypeAlias = dict[int, Fraction]


@dataclass(frozen=True)
class Bordered:
    """Bordered matrix P_0 + P_1 s + P_2 s^2 in exact rows over coordinates q and unknown excitations u.

    The first ``n_coordinates`` columns are q.
    """

    powers: tuple[list[ExactRow], list[ExactRow], list[ExactRow]]
    n_coordinates: int

    @classmethod
    def of(cls, assembly: Assembly, request: TransferRequest) -> Bordered:
        """Bordered matrix P(s) for the poles of an assembly against the measured inputs of a request."""
        index = {name: number for number, name in enumerate(assembly.kinematics.coordinates)}
        n, m = len(index), len(request.excitations)
        powers: tuple[list[ExactRow], ...] = tuple([{} for _ in range(n + m)] for _ in range(3))
        for law, row in zip(assembly.laws, assembly.exact_rows, strict=True):
            ours = {index[name]: value for name, value in row.items() if name in index}
            for power, value in enumerate((exact(law.stiffness), exact(law.damping), exact(law.inertia))):
                for i, a in ours.items():
                    for j, b in ours.items():
                        _add(powers[power][i], j, value * a * b)
        for column, excitation in enumerate(request.excitations):
            for name, value in exact_row(assembly.kinematics.reduced(excitation.row)).items():
                if name in index:  # the rest of the torque acts on imposed angles, which stand still
                    _add(powers[0][index[name]], n + column, -value)
        for line, reading in enumerate(request.measured, start=n):
            for term in reading.terms:
                ours = {index[name]: value for name, value in term.exact.items() if name in index}
                for power, share in enumerate(powers_of_s(assembly, term)):
                    for i, a in ours.items():
                        _add(powers[power][line], i, term.factor * share * a)
            for column, excitation in enumerate(request.excitations):
                _add(powers[0][line], n + column, reading.direct(excitation.row))
        kept = ([{key: value for key, value in row.items() if value} for row in block] for block in powers)
        return cls(tuple(kept), n)  # type: ignore[arg-type]

    @property
    def size(self) -> int:
        """Number of rows of the bordered matrix, which is that of coordinates and excitations together."""
        return len(self.powers[0])

    @property
    def entries(self) -> dict[tuple[int, int], tuple[Fraction, ...]]:
        """Coefficients of s^0, s^1 and s^2 of every nonzero entry of the bordered matrix, by row and column."""
        places = dict.fromkeys((i, j) for block in self.powers for i, row in enumerate(block) for j in row)
        return {(i, j): tuple(block[i].get(j, Fraction(0)) for block in self.powers) for i, j in places}

    def determinant(self, prime: int) -> Coefficients:
        """Coefficients of the bordered matrix's determinant, a polynomial in s, modulo a prime, ascending."""
        order, _ = minimum_degree_order(self.size, self.entries)
        blocks = [[{order[j]: residue(x, prime) for j, x in row.items()} for row in block] for block in self.powers]
        return interpolating_polynomial(
            [determinant(_at(blocks, s, prime), prime) for s in range(2 * self.n_coordinates + 1)], prime
        )

    def roots(self) -> tuple[int, int] | None:
        """Number of poles against the measured inputs, and of these at zero, or None if the determinant vanishes."""
        coefficients = self.determinant(next(primes()))
        return (len(coefficients) - 1, _zeros(coefficients)) if coefficients else None

    def repeated(self) -> dict[int, list[Fraction]] | None:
        """Polynomials of the poles that are repeated and not zero, exact and monic, by multiplicity, or None.

        It is None where primes do not suffice.

        The polynomials modulo several primes are joined until one prime more does not change them.
        """
        joined: dict[int, list[int]] = {}
        modulus, last = 1, None
        for prime in islice(primes(), MAX_PRIMES):
            coefficients = self.determinant(prime)
            factors = square_free(coefficients[_zeros(coefficients) :], prime)
            found = {multiplicity: factor for multiplicity, factor in factors.items() if multiplicity > 1}
            if {m: len(factor) for m, factor in joined.items()} != {m: len(factor) for m, factor in found.items()}:
                joined, modulus = found, prime
            else:
                inverse = pow(modulus, -1, prime)
                for m, values in joined.items():
                    joined[m] = [
                        x + modulus * ((y - x) * inverse % prime) for x, y in zip(values, found[m], strict=True)
                    ]
                modulus *= prime
            now = {m: [rational_from_residue(value, modulus) for value in values] for m, values in joined.items()}
            if now == last and not any(None in values for values in now.values()):
                return now  # type: ignore[return-value]
            last = now
        return None


def _add(row: ExactRow, column: int, value: Fraction) -> None:
    row[column] = row.get(column, Fraction(0)) + value


def _at(blocks: Sequence[Sequence[dict[int, int]]], point: int, prime: int) -> list[dict[int, int]]:
    rows: list[dict[int, int]] = [{} for _ in blocks[0]]
    for power, block in enumerate(blocks):
        for row, part in zip(rows, block, strict=True):
            for column, value in part.items():
                row[column] = (row.get(column, 0) + point**power * value) % prime
    return [{column: value for column, value in row.items() if value} for row in rows]


def _zeros(coefficients: Coefficients) -> int:
    return next(power for power, value in enumerate(coefficients) if value)

"""The bordered system of measured-input poles in exact rationals, and what can be counted on it.

With unknown excitations u, the rates s at which the readings L(s) q + d u can stay zero are the roots of det P(s),

    P(s) = [ D(s)  -B ]  =  P_0 + P_1 s + P_2 s^2
           [ L(s)   d ]

How many of them there are, and how many are zero, no rounded number can tell. The determinant is therefore taken in the
field of integers modulo a large prime: its lowest and its highest coefficient vanish there only where they vanish in
rationals, but for one chance in 1e16.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from torsionnet.assembly.system import Assembly
from torsionnet.elements import Law
from torsionnet.elimination import exact
from torsionnet.kinematics import exact_row
from torsionnet.solve.question import Question
from torsionnet.solve.refine import least_fill

PRIME = 2**61 - 1

ExactRow: TypeAlias = dict[int, Fraction]


@dataclass(frozen=True)
class Bordered:
    """P_0, P_1, P_2 as sparse exact rows over (q, u); ``n_coordinates`` of the unknowns are q."""

    powers: tuple[list[ExactRow], list[ExactRow], list[ExactRow]]
    n_coordinates: int

    @classmethod
    def of(cls, assembly: Assembly, question: Question) -> Bordered:
        index = {name: number for number, name in enumerate(assembly.kinematics.coordinates)}
        n, m = len(index), len(question.excitations)
        powers: tuple[list[ExactRow], ...] = tuple([{} for _ in range(n + m)] for _ in range(3))
        for law, row in zip(assembly.laws, assembly.exact_rows, strict=True):
            ours = {index[name]: value for name, value in row.items() if name in index}
            for power, value in enumerate(_law_powers(law)):
                for i, a in ours.items():
                    for j, b in ours.items():
                        _add(powers[power][i], j, value * a * b)
        for column, excitation in enumerate(question.excitations):
            for name, value in exact_row(assembly.kinematics.reduced({excitation.of: 1})).items():
                _add(powers[0][index[name]], n + column, -value)
        for line, reading in enumerate(question.measured, start=n):
            for term in reading.terms:
                ours = {index[name]: value for name, value in term.exact.items() if name in index}
                shares = (
                    [Fraction(term.power == p) for p in range(3)]
                    if term.law is None
                    else _law_powers(assembly.laws[term.law])
                )
                for power, share in enumerate(shares):
                    for i, a in ours.items():
                        _add(powers[power][line], i, term.factor * share * a)
            for column, excitation in enumerate(question.excitations):
                _add(powers[0][line], n + column, exact(reading.direct.get(excitation.of, 0)))
        kept = ([{key: value for key, value in row.items() if value} for row in block] for block in powers)
        return cls(tuple(kept), n)  # type: ignore[arg-type]

    @property
    def size(self) -> int:
        return len(self.powers[0])

    @property
    def entries(self) -> dict[tuple[int, int], tuple[Fraction, ...]]:
        """Coefficients of s^0, s^1 and s^2 of every entry of P."""
        places = dict.fromkeys((i, j) for block in self.powers for i, row in enumerate(block) for j in row)
        return {(i, j): tuple(block[i].get(j, Fraction(0)) for block in self.powers) for i, j in places}

    def roots(self) -> tuple[int, int] | None:
        """How many roots det P(s) has, with multiplicity, and how many of them are zero; None where it vanishes."""
        order, _ = least_fill(self.size, self.entries)
        blocks = [[{order[j]: _residue(x) for j, x in row.items()} for row in block] for block in self.powers]
        values = [_determinant(_at(blocks, point)) for point in range(2 * self.n_coordinates + 1)]
        coefficients = [power for power, value in enumerate(_interpolated(values)) if value]
        return (coefficients[-1], coefficients[0]) if coefficients else None


def _law_powers(law: Law) -> list[Fraction]:
    return [exact(law.stiffness), exact(law.damping), exact(law.inertia)]


def _add(row: ExactRow, column: int, value: Fraction) -> None:
    row[column] = row.get(column, Fraction(0)) + value


# --- modulo the prime -----------------------------------------------------------------------------------------------


def _residue(value: Fraction) -> int:
    return value.numerator * pow(value.denominator, -1, PRIME) % PRIME


def _at(blocks: Sequence[Sequence[dict[int, int]]], point: int) -> list[dict[int, int]]:
    rows: list[dict[int, int]] = [{} for _ in blocks[0]]
    for power, block in enumerate(blocks):
        factor = point**power
        for row, part in zip(rows, block, strict=True):
            for column, value in part.items():
                row[column] = (row.get(column, 0) + factor * value) % PRIME
    return [{column: value for column, value in row.items() if value} for row in rows]


def _determinant(rows: list[dict[int, int]]) -> int:
    """By elimination column after column, each with the shortest row that holds it."""
    result, places = 1, list(range(len(rows)))
    for column in range(len(rows)):
        holders = [place for place in places[column:] if column in rows[place]]
        if not holders:
            return 0
        pivot = min(holders, key=lambda place: len(rows[place]))
        at = places.index(pivot, column)
        if at != column:
            places[at], places[column] = places[column], pivot
            result = -result
        head = rows[pivot].pop(column)
        result = result * head % PRIME
        inverse = pow(head, -1, PRIME)
        for place in holders:
            if place != pivot:
                _subtract(rows[place], rows[pivot], rows[place].pop(column) * inverse % PRIME)
    return result


def _subtract(row: dict[int, int], other: dict[int, int], factor: int) -> None:
    for column, value in other.items():
        left = (row.get(column, 0) - factor * value) % PRIME
        if left:
            row[column] = left
        else:
            row.pop(column, None)


def _interpolated(values: list[int]) -> list[int]:
    """Coefficients, ascending, of the polynomial with these values at 0, 1, 2, ..."""
    differences = list(values)
    for order in range(1, len(values)):
        inverse = pow(order, -1, PRIME)
        for i in range(len(values) - 1, order - 1, -1):
            differences[i] = (differences[i] - differences[i - 1]) * inverse % PRIME
    result: list[int] = []
    for point in range(len(values) - 1, -1, -1):
        shifted = [0, *result]
        result = [(low - point * high) % PRIME for low, high in zip(shifted, [*result, 0], strict=True)]
        result[0] = (result[0] + differences[point]) % PRIME
    return result

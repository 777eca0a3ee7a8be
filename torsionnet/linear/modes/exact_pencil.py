"""Characteristic equation of a drivetrain with controllers in rational numbers, for roots at s = 0.

P(s) of :class:`~torsionnet.linear.modes.active_pencil.ActivePencil` is a series in s with rational coefficients, delays
included, since values are given as decimals. Singularity at zero is decided exactly, and its multiplicity is counted
modulo a large prime, with the series of exponentials cut off where these no longer matter.

Chains of motions for poles at zero, by which these are taken out of the characteristic equation. A motion x(s) = x_0 +
s x_1 + .. for which P(s) x(s) begins with s^k (a root polynomial; its coefficients are a Jordan chain: I. Gohberg, P.
Lancaster and L. Rodman, "Matrix polynomials", 1982, section 1.5) replaces a coordinate,

    P(s) x(s) / s^k    in the column of that coordinate

which takes k roots at zero out of det P and leaves all others. While the matrix is still singular at zero, a null
vector gives the next chain. All numbers are exact: a root at zero is not distinguished from a slow root by its size.

Columns of the characteristic equation from which roots at zero are taken out, in double precision. The division by
powers of s is exact: powers of s that cancel are not formed, and of delays

    e^(-s tau) = sum of (-s tau)^m / m! for m < r, + (-s tau)^r phi_r(-s tau)

leaves phi_r, which is entire (N. J. Higham, "Functions of matrices", 2008, section 10.7.4).
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import factorial
from typing import TypeAlias

import numpy as np

from torsionnet.base.errors import SolveError
from torsionnet.base.expressions import exact
from torsionnet.linear.assembly.action_laws import polynomial
from torsionnet.linear.assembly.rows import Assembly, ComplexArray, FloatArray
from torsionnet.linear.modes.ehrlich_aberth import minimum_degree_order
from torsionnet.linear.modes.modular_arithmetic import determinant, interpolating_polynomial, primes, residue
from torsionnet.model.elimination import reduce_rows

ExactVector: TypeAlias = Mapping[int, Fraction]


@dataclass(frozen=True)
class DelayedTerms:
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
        # e^(-s tau) = sum of (-s tau)^m / m!
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
    delayed: tuple[DelayedTerms, ...]
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

        # D(s) = sum over the laws of (k + c s + J s^2) a a^T
        for law, row in zip(assembly.laws, assembly.exact_rows, strict=True):
            ours = {index[name]: value for name, value in row.items() if name in index}
            for power, value in enumerate((exact(law.stiffness), exact(law.damping), exact(law.inertia))):
                for i, a in ours.items() if value else ():
                    for j, b in ours.items():
                        add(i, j, power, value * a * b)
        delayed = []
        # The torque T of an action: -B T beside D(s) q, and a row E(s) T - N(s) e^(-s tau) L q = 0 of its own.
        for place, action in enumerate(assembly.system.actions, len(index)):
            for name, value in action.row.items():
                if name in index:
                    add(index[name], place, 0, -value)
            for power, value in enumerate(action.denominator):
                add(place, place, power, value)
            sensed = {index[name]: value for name, value in action.sensed.items() if name in index}
            delayed.append(DelayedTerms(place, action.numerator, sensed, action.delay))
        undelayed = {place: tuple(values) for place, values in entries.items()}
        return cls(len(index) + len(assembly.system.actions), undelayed, tuple(delayed))

    def coefficient_rows(self, k: int) -> list[dict[int, Fraction]]:
        """Rows of the coefficient matrix of s^k in the exact P(s), each as a map from column to rational."""
        if k not in self._powers:
            rows: list[dict[int, Fraction]] = [{} for _ in range(self.size)]
            for (i, j), values in self.undelayed.items():
                if k < len(values) and values[k]:
                    rows[i][j] = values[k]
            for delayed_row in self.delayed:
                factor = delayed_row.coefficient(k)
                for j, value in delayed_row.sensed.items() if factor else ():
                    rows[delayed_row.row][j] = rows[delayed_row.row].get(j, Fraction(0)) - factor * value
            self._powers[k] = [{j: value for j, value in row.items() if value} for row in rows]
        return self._powers[k]

    def coefficient_times(self, k: int, vector: ExactVector) -> dict[int, Fraction]:
        """Coefficient matrix of s^k in the exact P(s) times a vector, as a map from row to rational."""
        product = {}
        for i, row in enumerate(self.coefficient_rows(k)):
            shorter, longer = (row, vector) if len(row) < len(vector) else (vector, row)
            total = sum((value * longer[j] for j, value in shorter.items() if j in longer), start=Fraction(0))
            if total:
                product[i] = total
        return product

    def counts(self, most: int) -> tuple[int, int]:
        """Number of poles of a controlled drivetrain, and of these at zero up to ``most``, with multiplicity.

        With delays only the number at zero has a meaning.
        """
        prime = next(primes())
        entries = {place: list(values) for place, values in self.undelayed.items()}
        # Bound of the degree of det P: 2 for every coordinate, that of N or E for every action.
        degree = 2 * self.size
        for delayed in self.delayed:
            # Of a delay only the terms count that can reach a root at zero of the multiplicity asked for.
            highest = len(delayed.numerator) - 1 + (most if delayed.delay else 0)
            series = [delayed.coefficient(power) for power in range(highest + 1)]
            for j, value in delayed.sensed.items():
                held = entries.setdefault((delayed.row, j), [])
                held += [Fraction(0)] * (len(series) - len(held))
                for power, factor in enumerate(series):
                    held[power] -= factor * value
            degree += max(highest, len(entries[delayed.row, delayed.row]) - 1) - 2
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


# Chains of motions for poles at zero, by which these are taken out of the characteristic equation.


@dataclass(frozen=True)
class ZeroChain:
    """Motion x(s) of a root at zero, as vectors by power of s, and the power k with which P(s) x(s) begins."""

    motion: tuple[ExactVector, ...]
    order: int


def zero_chains(pencil: ExactPencil, weights: Sequence[float]) -> dict[int, ZeroChain]:
    """Chains of motions for poles at zero, by the index of the column of P(s) that each replaces.

    The sum of their orders is the number of roots at zero.

    Each replaces the column whose entry in a null vector is largest by ``weights`` (n,).

    Raises
    ------
    SolveError
        The determinant vanishes at every s.
    """
    chains: dict[int, ZeroChain] = {}
    # det P has no more roots at zero than its degree, unless it vanishes.
    most = sum(len(delayed.numerator) for delayed in pencil.delayed) + sum(
        max((len(values) for (row, _), values in pencil.undelayed.items() if row == i), default=0)
        for i in range(pencil.size)
    )
    while is_singular(rows := deflated_coefficient(pencil, chains, 0)):
        vectors = null_vectors(rows)
        if not vectors:
            break
        if sum(known.order for known in chains.values()) > most:
            text = "the torques of controllers cancel the dynamic stiffness: no motion balances a load"
            raise SolveError(f"{text}; change a control law", kind="no-solution")
        column, chain = _next_chain(vectors[0], chains, weights)
        chains[column] = chain
    return chains


def deflated_coefficient(pencil: ExactPencil, chains: Mapping[int, ZeroChain], power: int) -> list[dict[int, Fraction]]:
    """Rows (column -> rational) of the s^power coefficient in P(s), with some poles at zero taken out."""
    rows = [{j: value for j, value in row.items() if j not in chains} for row in pencil.coefficient_rows(power)]
    for j, chain in chains.items():
        for m, vector in enumerate(chain.motion):
            if m <= chain.order + power:
                for i, value in pencil.coefficient_times(chain.order + power - m, vector).items():
                    rows[i][j] = rows[i].get(j, Fraction(0)) + value
    return [{j: value for j, value in row.items() if value} for row in rows]


def null_vectors(rows: Sequence[ExactVector]) -> list[dict[int, Fraction]]:
    """Vectors (column -> rational) that span the null space of a square matrix of rationals, exactly."""
    size = len(rows)
    solved = reduce_rows([row for row in rows if row], {i: i for i in range(size)}).solved
    vectors = {column: {column: Fraction(1)} for column in range(size) if column not in solved}
    if vectors:
        for name, row in solved.items():
            for column, value in row.items():
                vectors[column][name] = value
    return list(vectors.values())


def _next_chain(
    vector: ExactVector, chains: Mapping[int, ZeroChain], weights: Sequence[float]
) -> tuple[int, ZeroChain]:
    """Index of the column of P(s) that a null vector replaces, and the chain of motions that replaces it."""
    # x = sum of v_i / v_column s^(highest - k_i) x_i(s): P x begins one power of s later than those before.
    orders = {i: chains[i].order if i in chains else 0 for i in vector}
    highest = max(orders.values())
    column = max((i for i in vector if orders[i] == highest), key=lambda i: abs(float(vector[i])) * weights[i])
    motion: dict[int, dict[int, Fraction]] = {}
    for i, factor in vector.items():
        for m, part in enumerate(chains[i].motion if i in chains else ({i: Fraction(1)},)):
            held = motion.setdefault(m + highest - orders[i], {})
            for j, value in part.items():
                held[j] = held.get(j, Fraction(0)) + factor / vector[column] * value
    whole = tuple({j: value for j, value in motion.get(m, {}).items() if value} for m in range(max(motion) + 1))
    return column, ZeroChain(whole, highest + 1)


# Columns of the characteristic equation from which roots at zero are taken out, in double precision.

SERIES_TERMS = 40
"""Number of terms in the series of phi_r for arguments up to r + 1, the last of which are far below rounding."""


@dataclass(frozen=True)
class DelayedSum:
    """Delayed terms in one row of the column for a controller, -sum of p_m s^(m - k) e^(-s delay).

    Terms that cancel are left out.

    ``terms`` are m - k and p_m.
    """

    row: int
    terms: tuple[tuple[int, float], ...]
    delay: float

    def value_at(self, s: complex) -> complex:
        """Value of the delayed part at the Laplace variable s in rad/s."""
        return -sum(value * self._factor(power, s) for power, value in self.terms)

    def derivative(self, s: complex) -> complex:
        """Derivative of the delayed part by the Laplace variable s, at s in rad/s."""
        total = 0j
        for power, value in self.terms:
            # d/ds of s^p e^(-s tau); over s^r stands what follows r terms of e^(-s tau), (-tau)^r phi_r(-s tau).
            slope = -self.delay * _phi(0, -s * self.delay) * s**power if power >= 0 else 0j
            if power > 0:
                slope += power * s ** (power - 1) * _phi(0, -s * self.delay)
            if power < 0:
                z, r = -s * self.delay, -power
                slope = (-self.delay) ** (r + 1) * (_phi(r, z) - r * _phi(r + 1, z))
            total -= value * slope
        return total

    def size(self, s: complex) -> float:
        """Sum of the magnitudes of the delayed terms at the Laplace variable s in rad/s, to judge rounding by."""
        return float(sum(abs(value * self._factor(power, s)) for power, value in self.terms))

    def _factor(self, power: int, s: complex) -> complex:
        z = -s * self.delay
        return s**power * _phi(0, z) if power >= 0 else (-self.delay) ** -power * _phi(-power, z)


def _phi(r: int, z: complex) -> complex:
    """Value phi_r(z) = (e^z - sum of z^m/m! for m < r) / z^r, without cancellation for small z."""
    if r == 0:
        with np.errstate(all="ignore"):  # e^z overflows far to the left
            return complex(np.exp(z))
    # The series next to zero; farther off phi_r = (phi_{r-1} - 1 / (r-1)!) / z cancels nothing.
    if abs(z) <= r + 1:
        total, term = 0j, 1 / math.factorial(r) + 0j
        for m in range(1, SERIES_TERMS):
            total += term
            term *= z / (r + m)
        return total
    return (_phi(r - 1, z) - 1 / math.factorial(r - 1)) / z


@dataclass(frozen=True)
class DeflatedColumn:
    """Column P(s) x(s)/s^k that replaces the column of one coordinate or torque in the characteristic equation.

    Attributes
    ----------
    place : int
        Index of the replaced column.
    chain : ZeroChain
        The motion x(s) and k, exactly.
    motion : (n_m, n) array
        Coefficients of x(s), ascending powers.
    undelayed : (n_p, n) array
        Coefficients of the part without delay, ascending powers.
    delayed : tuple of DelayedSum
    strains : (n_m, n_laws) array
        Motions of the laws in x(s), for loss factors.
    """

    place: int
    chain: ZeroChain
    motion: FloatArray
    undelayed: FloatArray
    delayed: tuple[DelayedSum, ...]
    strains: FloatArray

    @property
    def order(self) -> int:
        """Number k of roots at zero that the column takes out of the characteristic equation."""
        return self.chain.order

    def motion_at(self, s: complex) -> ComplexArray:
        """Motion x(s)/s^k over coordinates and torques (n,) at s in rad/s, for which the column stands."""
        powers = np.complex128(s) ** (np.arange(len(self.motion)) - self.order)
        return np.asarray(powers @ self.motion)

    def values_at(self, s: complex) -> ComplexArray:
        """Entries (n,) of the column at s in rad/s, without loss factors."""
        column = np.asarray(polynomial(list(self.undelayed), s), dtype=complex)
        for delayed in self.delayed:
            column[delayed.row] += delayed.value_at(s)
        return column

    def derivative(self, s: complex) -> ComplexArray:
        """Derivatives (n,) of the column's entries by s, at s in rad/s."""
        column = np.asarray(polynomial([m * row for m, row in enumerate(self.undelayed)][1:], s), dtype=complex)
        column = column + np.zeros(self.undelayed.shape[1])
        for delayed in self.delayed:
            column[delayed.row] += delayed.derivative(s)
        return column

    def size(self, s: complex) -> FloatArray:
        """Sums (n,) of the magnitudes of the terms in the column's entries at s, to judge rounding by."""
        sizes = np.asarray(polynomial(list(np.abs(self.undelayed)), abs(s)), dtype=float)
        for delayed in self.delayed:
            sizes[delayed.row] += delayed.size(s)
        return sizes

    def strain(self, s: complex) -> ComplexArray:
        """Twists (n_laws,) of the laws in x(s)/s^k, which loss factors resist. They may hold negative powers of s."""
        powers = np.complex128(s) ** (np.arange(len(self.strains)) - self.order)
        return np.asarray(powers @ self.strains)


def deflated_columns(assembly: Assembly, exact: ExactPencil, weights: FloatArray) -> tuple[DeflatedColumn, ...]:
    """Columns of the characteristic equation with roots at zero taken out, one for every chain of roots.

    The ``weights`` (n,) choose the columns that are replaced.
    """
    chains = zero_chains(exact, weights.tolist())
    return tuple(_column(assembly, exact, place, chain) for place, chain in chains.items())


def _column(assembly: Assembly, exact: ExactPencil, place: int, chain: ZeroChain) -> DeflatedColumn:
    n, k = exact.size, chain.order
    motion = np.zeros((len(chain.motion), n))
    degree = max(len(values) for values in exact.undelayed.values()) + len(motion) - 1
    undelayed = np.zeros((max(degree - k, 1), n))
    strains = np.zeros((len(motion), len(assembly.laws)))
    index = {name: number for number, name in enumerate(assembly.kinematics.coordinates)}
    for m, vector in enumerate(chain.motion):
        motion[m, list(vector)] = [float(value) for value in vector.values()]
        for law, row in enumerate(assembly.exact_rows):
            strains[m, law] = float(sum(value * vector.get(index.get(name, -1), 0) for name, value in row.items()))
    # P(s) x(s) / s^k; what stands below s^k cancels exactly and is not formed.
    sums: defaultdict[tuple[int, int], Fraction] = defaultdict(Fraction)
    for (i, j), values in exact.undelayed.items():
        for m, vector in enumerate(chain.motion):
            for power, value in enumerate(values) if j in vector else ():
                if power + m >= k:
                    sums[power + m - k, i] += value * vector[j]
    for (power, i), total in sums.items():
        undelayed[power, i] = float(total)
    delayed = tuple(_delayed(row_of_action, chain) for row_of_action in exact.delayed)
    return DeflatedColumn(place, chain, motion, undelayed, tuple(part for part in delayed if part.terms), strains)


def _delayed(delayed: DelayedTerms, chain: ZeroChain) -> DelayedSum:
    factors: defaultdict[int, Fraction] = defaultdict(Fraction)
    for m, vector in enumerate(chain.motion):
        sensed = sum(value * vector[j] for j, value in delayed.sensed.items() if j in vector)
        for power, value in enumerate(delayed.numerator) if sensed else ():
            factors[power + m - chain.order] += value * sensed
    kept = tuple((power, float(value)) for power, value in factors.items() if value)
    return DelayedSum(delayed.row, kept, float(delayed.delay))

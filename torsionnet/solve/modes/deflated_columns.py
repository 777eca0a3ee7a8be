"""Columns of the characteristic equation from which zero has been taken as a root, in double precision.

What has been divided by s is divided before anything is rounded: powers of s that cancel are not there, and of delays

    e^(-s tau) = sum of (-s tau)^m / m! for m < r, + (-s tau)^r phi_r(-s tau)

leaves phi_r, which is entire (N. J. Higham, "Functions of matrices", 2008, section 10.7.4).
"""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsionnet.assembly.action_law import polynomial
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.assembly.system import Assembly
from torsionnet.solve.modes.exact_pencil import DelayedRow, ExactPencil
from torsionnet.solve.modes.zero_chains import ZeroChain, zero_chains

TERMS = 40
"""Of the series of phi_r where its argument is below r + 1."""


@dataclass(frozen=True)
class DelayedSum:
    """-sum of p_m s^(m - k) e^(-s delay) without what cancels, in one row; ``terms`` are m - k and p_m."""

    row: int
    terms: tuple[tuple[int, float], ...]
    delay: float

    def at(self, s: complex) -> complex:
        """Its value."""
        return -sum(value * self._factor(power, s) for power, value in self.terms)

    def rate(self, s: complex) -> complex:
        """Its derivative."""
        total = 0j
        for power, value in self.terms:
            slope = -self.delay * _phi(0, -s * self.delay) * s**power if power >= 0 else 0j
            if power > 0:
                slope += power * s ** (power - 1) * _phi(0, -s * self.delay)
            if power < 0:
                z, r = -s * self.delay, -power
                slope = (-self.delay) ** (r + 1) * (_phi(r, z) - r * _phi(r + 1, z))
            total -= value * slope
        return total

    def size(self, s: complex) -> float:
        """The sum of the magnitudes of its terms."""
        return float(sum(abs(value * self._factor(power, s)) for power, value in self.terms))

    def _factor(self, power: int, s: complex) -> complex:
        z = -s * self.delay
        return s**power * _phi(0, z) if power >= 0 else (-self.delay) ** -power * _phi(-power, z)


def _phi(r: int, z: complex) -> complex:
    """(e^z - sum of z^m/m! for m < r) / z^r."""
    if r == 0:
        with np.errstate(all="ignore"):  # far to the left nothing comes back
            return complex(np.exp(z))
    if abs(z) <= r + 1:
        total, term = 0j, 1 / math.factorial(r) + 0j
        for m in range(1, TERMS):
            total += term
            term *= z / (r + m)
        return total
    return (_phi(r - 1, z) - 1 / math.factorial(r - 1)) / z


@dataclass(frozen=True)
class DeflatedColumn:
    """P(s) x(s)/s^k in the place of the column of one coordinate or torque.

    Attributes
    ----------
    place : int
        The column.
    chain : ZeroChain
        x(s) and k, exactly.
    motion : (n_m, n) array
        x(s), ascending.
    lasting : (n_p, n) array
        What has no delay, ascending.
    delayed : tuple of DelayedSum
    strained : (n_m, n_laws) array
        Motions of the laws in x(s), for loss factors.
    """

    place: int
    chain: ZeroChain
    motion: FloatArray
    lasting: FloatArray
    delayed: tuple[DelayedSum, ...]
    strained: FloatArray

    @property
    def order(self) -> int:
        """k, how many roots at zero the column takes out."""
        return self.chain.order

    def of(self, s: complex) -> ComplexArray:
        """x(s)/s^k, (n,)."""
        powers = np.complex128(s) ** (np.arange(len(self.motion)) - self.order)
        return np.asarray(powers @ self.motion)

    def at(self, s: complex) -> ComplexArray:
        """The column without loss factors, (n,)."""
        found = np.asarray(polynomial(list(self.lasting), s), dtype=complex)
        for one in self.delayed:
            found[one.row] += one.at(s)
        return found

    def rate(self, s: complex) -> ComplexArray:
        """Its derivative."""
        found = np.asarray(polynomial([m * row for m, row in enumerate(self.lasting)][1:], s), dtype=complex)
        found = found + np.zeros(self.lasting.shape[1])
        for one in self.delayed:
            found[one.row] += one.rate(s)
        return found

    def size(self, s: complex) -> FloatArray:
        """The sum of the magnitudes of its terms."""
        found = np.asarray(polynomial(list(np.abs(self.lasting)), abs(s)), dtype=float)
        for one in self.delayed:
            found[one.row] += one.size(s)
        return found

    def strain(self, s: complex) -> ComplexArray:
        """Motions of the laws, (n_laws,): in what loss factors resist, powers of s below zero may be left."""
        powers = np.complex128(s) ** (np.arange(len(self.strained)) - self.order)
        return np.asarray(powers @ self.strained)


def deflated_columns(assembly: Assembly, exact: ExactPencil, weights: FloatArray) -> tuple[DeflatedColumn, ...]:
    """Of all chains at zero (:mod:`.zero_chains`)."""
    chains = zero_chains(exact, weights.tolist())
    return tuple(_column(assembly, exact, place, chain) for place, chain in chains.items())


def _column(assembly: Assembly, exact: ExactPencil, place: int, chain: ZeroChain) -> DeflatedColumn:
    n, k = exact.size, chain.order
    motion = np.zeros((len(chain.motion), n))
    degree = max(len(values) for values in exact.lasting.values()) + len(motion) - 1
    lasting = np.zeros((max(degree - k, 1), n))
    strained = np.zeros((len(motion), len(assembly.laws)))
    index = {name: number for number, name in enumerate(assembly.kinematics.coordinates)}
    for m, vector in enumerate(chain.motion):
        motion[m, list(vector)] = [float(value) for value in vector.values()]
        for law, row in enumerate(assembly.exact_rows):
            strained[m, law] = float(sum(value * vector.get(index.get(name, -1), 0) for name, value in row.items()))
    sums: defaultdict[tuple[int, int], Fraction] = defaultdict(Fraction)
    for (i, j), values in exact.lasting.items():
        for m, vector in enumerate(chain.motion):
            for power, value in enumerate(values) if j in vector else ():
                if power + m >= k:
                    sums[power + m - k, i] += value * vector[j]
    for (power, i), total in sums.items():
        lasting[power, i] = float(total)
    delayed = tuple(_delayed(one, chain) for one in exact.delayed)
    return DeflatedColumn(place, chain, motion, lasting, tuple(one for one in delayed if one.terms), strained)


def _delayed(one: DelayedRow, chain: ZeroChain) -> DelayedSum:
    factors: defaultdict[int, Fraction] = defaultdict(Fraction)
    for m, vector in enumerate(chain.motion):
        sensed = sum(value * vector[j] for j, value in one.sensed.items() if j in vector)
        for power, value in enumerate(one.numerator) if sensed else ():
            factors[power + m - chain.order] += value * sensed
    kept = tuple((power, float(value)) for power, value in factors.items() if value)
    return DelayedSum(one.row, kept, float(one.delay))

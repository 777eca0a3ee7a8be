"""Columns of the characteristic equation from which roots at zero are taken out, in double precision.

The division by powers of s is exact: powers of s that cancel are not formed, and of delays

    e^(-s tau) = sum of (-s tau)^m / m! for m < r, + (-s tau)^r phi_r(-s tau)

leaves phi_r, which is entire (N. J. Higham, "Functions of matrices", 2008, section 10.7.4).
"""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray, polynomial
from torsionnet.linear.assembly.system import Assembly
from torsionnet.linear.modes.exact_pencil import DelayedRow, ExactPencil
from torsionnet.linear.modes.zero_chains import ZeroChain, zero_chains

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

    def at(self, s: complex) -> complex:
        """Value of the delayed part at the Laplace variable s in rad/s."""
        return -sum(value * self._factor(power, s) for power, value in self.terms)

    def derivative(self, s: complex) -> complex:
        """Derivative of the delayed part by the Laplace variable s, at s in rad/s."""
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

    def at(self, s: complex) -> ComplexArray:
        """Entries (n,) of the column at s in rad/s, without loss factors."""
        found = np.asarray(polynomial(list(self.undelayed), s), dtype=complex)
        for one in self.delayed:
            found[one.row] += one.at(s)
        return found

    def derivative(self, s: complex) -> ComplexArray:
        """Derivatives (n,) of the column's entries by s, at s in rad/s."""
        found = np.asarray(polynomial([m * row for m, row in enumerate(self.undelayed)][1:], s), dtype=complex)
        found = found + np.zeros(self.undelayed.shape[1])
        for one in self.delayed:
            found[one.row] += one.derivative(s)
        return found

    def size(self, s: complex) -> FloatArray:
        """Sums (n,) of the magnitudes of the terms in the column's entries at s, to judge rounding by."""
        found = np.asarray(polynomial(list(np.abs(self.undelayed)), abs(s)), dtype=float)
        for one in self.delayed:
            found[one.row] += one.size(s)
        return found

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
    sums: defaultdict[tuple[int, int], Fraction] = defaultdict(Fraction)
    for (i, j), values in exact.undelayed.items():
        for m, vector in enumerate(chain.motion):
            for power, value in enumerate(values) if j in vector else ():
                if power + m >= k:
                    sums[power + m - k, i] += value * vector[j]
    for (power, i), total in sums.items():
        undelayed[power, i] = float(total)
    delayed = tuple(_delayed(one, chain) for one in exact.delayed)
    return DeflatedColumn(place, chain, motion, undelayed, tuple(one for one in delayed if one.terms), strains)


def _delayed(one: DelayedRow, chain: ZeroChain) -> DelayedSum:
    factors: defaultdict[int, Fraction] = defaultdict(Fraction)
    for m, vector in enumerate(chain.motion):
        sensed = sum(value * vector[j] for j, value in one.sensed.items() if j in vector)
        for power, value in enumerate(one.numerator) if sensed else ():
            factors[power + m - chain.order] += value * sensed
    kept = tuple((power, float(value)) for power, value in factors.items() if value)
    return DelayedSum(one.row, kept, float(one.delay))

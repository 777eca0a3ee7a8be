"""Derivatives of the equations and of the readings between two vectors, to parameters and to s."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.solve.sensitivity.augmented import Augmented
from torsionnet.solve.sensitivity.sensor_derivatives import ReadingDerivative

Slopes = Mapping[int, Sequence[tuple[int, ComplexArray]]]
"""Law -> (parameter, derivative of its dynamic stiffness (n_f,))."""


def equation_slopes(
    system: Augmented, kappa: ComplexArray, slopes: Slopes, x: ComplexArray, z: ComplexArray
) -> ComplexArray:
    """Z . dD x for every parameter, (n_p, n_f); x and z are (n_f, n) over angles and torques of conditions."""
    n_q, count = system.laws.values.shape[1], system.inertia.slopes.shape[1]
    total = np.zeros((count, len(x)), dtype=complex)
    motion, adjoint = x[:, :n_q], z[:, :n_q]
    for law in system.varied:
        row = system.laws.values[law]
        u, v = combined(motion, row), combined(adjoint, row)
        for p, slope in slopes[law]:
            total[p] += slope * u * v
        for p in moved_by(system.laws.slopes[law]):
            moved = system.laws.slopes[law][:, p]
            total[p] += kappa[:, law] * (combined(motion, moved) * v + u * combined(adjoint, moved))
    for number in np.flatnonzero(system.conditions.slopes.any(axis=(1, 2))):
        for p in moved_by(system.conditions.slopes[number]):
            moved = system.conditions.slopes[number][:, p]
            total[p] += z[:, n_q + number] * combined(motion, moved) + x[:, n_q + number] * combined(adjoint, moved)
    return total


def reading_slopes(
    system: Augmented,
    one: ReadingDerivative,
    omega: FloatArray | ComplexArray,
    kappa: ComplexArray,
    slopes: Slopes,
    x: ComplexArray,
) -> ComplexArray:
    """Dc . x for every parameter, (n_p, n_f)."""
    n_q, count = system.laws.values.shape[1], system.inertia.slopes.shape[1]
    motion, torques = x[:, :n_q], x[:, n_q:]
    total = np.zeros((count, len(x)), dtype=complex)
    for p in range(count):
        total[p] += (1j * omega) ** one.power * combined(motion, one.motion_slopes[:, p])
        total[p] += combined(torques, one.condition_slopes[:, p])
    for law in map(int, np.flatnonzero((one.laws != 0) | one.law_slopes.any(axis=1))):
        u = combined(motion, system.laws.values[law])
        for p in moved_by(one.law_slopes[law : law + 1]):
            total[p] += one.law_slopes[law, p] * kappa[:, law] * u
        for p, slope in slopes[law]:
            total[p] += one.laws[law] * slope * u
        for p in moved_by(system.laws.slopes[law]):
            total[p] += one.laws[law] * kappa[:, law] * combined(motion, system.laws.slopes[law][:, p])
    return total


def equation_rate(system: Augmented, s: complex, x: ComplexArray, z: ComplexArray) -> complex:
    """Z . dD/ds x at one s, for laws J s^2 + c s + k; x and z are (n,)."""
    n_q = system.laws.values.shape[1]
    u, v = system.laws.values @ x[:n_q], system.laws.values @ z[:n_q]
    return complex(np.sum(law_rates(system, s) * u * v))


def reading_rate(system: Augmented, one: ReadingDerivative, s: complex, x: ComplexArray) -> complex:
    """dc/ds . x at one s."""
    n_q = system.laws.values.shape[1]
    own = one.power * s ** max(one.power - 1, 0) * (one.motion @ x[:n_q]) if one.power else 0.0
    return complex(own + np.sum(one.laws * law_rates(system, s) * (system.laws.values @ x[:n_q])))


def law_rates(system: Augmented, s: complex) -> ComplexArray:
    """D kappa / ds of every law."""
    return np.asarray(2 * s * system.inertia.values + system.damping.values, dtype=np.complex128)


def moved_by(slopes: FloatArray) -> NDArray[np.intp]:
    """Parameters on which any of the entries (n, n_p) depends."""
    return np.flatnonzero(slopes.any(axis=0))


def combined(columns: ComplexArray, weights: FloatArray) -> ComplexArray:
    """Columns (n_f, n) times weights (n,); most of these are 0."""
    total = np.zeros(len(columns), dtype=complex)
    for index in np.flatnonzero(weights):
        total += weights[index] * columns[:, index]
    return total

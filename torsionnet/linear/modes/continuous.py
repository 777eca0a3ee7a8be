"""Lowest modes without damping of a drivetrain with continuous shafts, which has infinitely many.

Every mode is bracketed by the count of Wittrick and Williams and bisected to the last digit.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import FloatArray, RowSystem
from torsionnet.linear.dynamic_stiffness.reduction import (
    echelon,
    resisted_coordinates,
    restrict_to,
    without_empty_laws,
)
from torsionnet.linear.dynamic_stiffness.row_algebra import unresisted_motions
from torsionnet.linear.modes.wittrick_williams import ModeCount

Mask: TypeAlias = NDArray[np.bool_]

DEFAULT_COUNT = 20
"""Number of modes with continuous shafts that are calculated where the caller gives no number."""
SAME_FREQUENCY = 1e-10
"""Relative difference below which natural frequencies are one repeated frequency, as bisection ends at rounding."""
SLOWEST_VIBRATION = 1e-9
"""Lowest frequency at which vibrations are sought, over the lowest natural frequency of any shaft by itself."""
BISECTIONS = 110
"""Most halvings of a bracket, more than the digits of double precision need over all decades of frequency."""
OFF_CLAMPED = 1.0123
"""Factor on trial frequencies, to keep off natural frequencies of shafts with both ends held, where D is infinite."""


def elastic(system: RowSystem) -> Mask:
    """Mask (n_laws,) of the laws that resist a slow motion, that is of springs and elastic shafts."""
    found = system.stiffness > 0
    found[[law for law, table in system.dynamic if table.is_elastic]] = True
    return np.asarray(found)


def rigid_motions(system: RowSystem) -> FloatArray:
    """Shapes (n_q, n_rigid) of motions that no spring resists."""
    return echelon(unresisted_motions(system, elastic(system)).basis())


def number_below(system: RowSystem, omega: float) -> int:
    """Number of natural frequencies without damping below omega in rad/s, rigid bodies included."""
    system = without_empty_laws(system)
    system = without_empty_laws(restrict_to(system, resisted_coordinates(system)))
    return max(int(ModeCount(system).below(np.array([omega])).item()), int(rigid_motions(system).shape[1]))


def natural_rates(system: RowSystem, count: int) -> FloatArray:
    """Lowest natural frequencies without damping in rad/s, rigid bodies as 0, shape (count,)."""
    modes = ModeCount(system)
    rigid = rigid_motions(system).shape[1]
    if count <= rigid:
        return np.zeros(count)
    wanted = np.arange(rigid + 1, count + 1)
    first = first_rate(system)
    upper = OFF_CLAMPED * first
    while modes.below(np.array([upper]))[0] < count:
        upper *= 2
        if upper > 1e12 * first:
            text = f"fewer than {count} modes of the continuous shafts were found below {upper / (2 * np.pi):.3g} Hz"
            raise SolveError(f"{text}; ask for fewer with lowest or up_to")
    low, high = np.full(len(wanted), SLOWEST_VIBRATION * first), np.full(len(wanted), upper)
    for _ in range(BISECTIONS):
        middle = np.where(high > 2 * low, np.sqrt(low * high), (low + high) / 2)
        above = modes.below(middle) >= wanted
        low, high = np.where(above, low, middle), np.where(above, middle, high)
        if np.all(high - low <= 2 * np.spacing(high)):
            break
    return np.concatenate([np.zeros(rigid), (low + high) / 2])


def first_rate(system: RowSystem) -> float:
    """Lowest natural frequency in rad/s of any continuous shaft by itself, with both ends free."""
    rates = []
    for _, table in system.dynamic:
        if table.is_continuous:
            k, J, *_ = (float(one) for one in table.coefficients)
            rates.append(np.pi * np.sqrt(k / J))
    return float(min(rates))


def undamped_modes(system: RowSystem, count: int) -> tuple[FloatArray, FloatArray]:
    """Natural frequencies (count,) in rad/s without damping and real shapes (n_q, count), rigid bodies first."""
    system = without_empty_laws(system)
    kept = resisted_coordinates(system)
    rates, shapes = _undamped_modes(without_empty_laws(restrict_to(system, kept)), count)
    every = np.zeros((system.n_coordinates, len(rates)))
    every[kept] = shapes
    return rates, every


def _undamped_modes(system: RowSystem, count: int) -> tuple[FloatArray, FloatArray]:
    rates, rigid = natural_rates(system, count), rigid_motions(system)
    shapes = np.zeros((system.n_coordinates, count))
    shapes[:, : rigid.shape[1]] = rigid[:, :count]
    modes = ModeCount(system)
    for group in equal_rates(rates):
        if rates[group[0]] > 0:
            shapes[:, group] = _null_vectors(system, modes, float(np.mean(rates[group])), len(group))
    return rates, shapes


def equal_rates(rates: FloatArray) -> list[list[int]]:
    """Groups of indices of rising natural frequencies that are equal within rounding."""
    found: list[list[int]] = []
    for place, rate in enumerate(rates):
        if found and rate - rates[found[-1][0]] <= SAME_FREQUENCY * rate:
            found[-1].append(place)
        else:
            found.append([place])
    return found


def _null_vectors(system: RowSystem, modes: ModeCount, omega: float, count: int) -> FloatArray:
    """Shapes (n_q, count) of the modes at a natural frequency in rad/s, which D(omega) resists least."""
    kappa = modes.real_stiffness(np.array([omega]))[:, 0]
    rows = system.rows
    D = rows.T @ (kappa[:, None] * rows)
    scale = 1 / np.sqrt(np.maximum(np.abs(rows.T**2 @ np.abs(kappa)), 1e-300))
    values, vectors = np.linalg.eigh(scale[:, None] * D * scale)
    chosen = np.argsort(np.abs(values))[:count]
    found = scale[:, None] * vectors[:, chosen]
    return np.asarray(found / np.abs(found).max(axis=0))

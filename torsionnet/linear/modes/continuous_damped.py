"""Poles in rad/s and mode shapes of a drivetrain with continuous shafts and damping.

Each mode without damping is followed while the damping grows to its value, by Newton steps on D(s) q = 0 with the exact
D(s). Real poles are where the number of negative pivots of the real D(s) changes along the negative real
axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray, RowSystem
from torsionnet.linear.dynamic_stiffness.reduction import require_resistance, stiff_laws
from torsionnet.linear.dynamic_stiffness.row_algebra import unresisted_motions
from torsionnet.linear.modes.continuous import (
    SAME_FREQUENCY,
    elastic,
    equal_rates,
    first_rate,
    negative_pivots,
    rigid_motions,
    undamped_modes,
)
from torsionnet.linear.modes.spectrum import Eigenpairs, Mode

NEWTON_STEPS, CONVERGED = 30, 1e-14
"""Most Newton steps for a damped mode, and the relative step, near rounding, at which these end."""
SMALLEST_DAMPING_STEP = 2.0**-12
"""Smallest share of the damping that is added at a time, so that a mode which needs smaller steps counts as lost."""
LEAST_MAC, LARGEST_MOVE = 0.5, 0.5
"""Least MAC of the shapes before and after a step of damping, and largest move of a pole over its distance to
others."""
REAL_GRID, REAL_DECADES = 900, (-9, 3)
"""Number of points on the negative real axis, and their range in decades around the modes, so that real poles 3 % apart
are told apart.

Two real poles between neighbouring points, 3 % apart, are missed.
"""
ON_AXIS = 1e-9
"""Imaginary part of a pole, over its size, up to which the pole has arrived at the real axis."""
LEAST_CHANGE = 1e-9
"""Change of the torques of a shape across a real pole, over their size, below which there is rounding and no pole."""
BISECTIONS = 60
"""Most halvings of a bracket of a real pole, more than the digits of double precision need between two points."""


@dataclass(frozen=True)
class DampedSystem:
    """Dynamic stiffness D(s) in N m/rad of a system of which only a share of the damping acts."""

    system: RowSystem

    def stiffness(self, s: complex, share: float) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Dynamic stiffness (n_laws,) of the laws in N m/rad at s, and its derivatives by Re s and by Im s.

        There are two derivatives because losses depend on |Im s|.
        """
        system, at, omega = self.system, np.array([s]), np.array([abs(s.imag)])
        kappa = system.stiffness + s * (share * system.damping + s * system.inertia)
        rate = share * system.damping + 2 * s * system.inertia
        across = np.zeros(len(rate), dtype=complex)
        for law, table in system.dynamic:
            lossy = table.with_loss(share)
            direct, followed = lossy.rates(at, omega)
            kappa[law] += lossy.at(at, omega)[0]
            rate[law] += direct[0]
            across[law] += followed[0]
        return kappa, rate, across + 1j * rate

    def matrices(self, s: complex, share: float) -> tuple[ComplexArray, ComplexArray, ComplexArray, FloatArray]:
        """Matrix D(s) in N m/rad, (n_q, n_q), its derivatives by Re s and Im s, and scales (n_q,) for its terms.

        The scales make the terms of one size.
        """
        rows = self.system.rows
        kappa, along, across = (part[:, None] for part in self.stiffness(s, share))
        scale = 1 / np.sqrt(rows.T**2 @ np.abs(kappa[:, 0]) + 1e-300)
        return rows.T @ (kappa * rows), rows.T @ (along * rows), rows.T @ (across * rows), np.asarray(scale)

    def newton(self, s: complex, shape: ComplexArray, share: float) -> Mode:
        """Mode (pole in rad/s, shape) by Newton steps from one nearby, with Re s and Im s as two real unknowns."""
        q, previous = shape / np.linalg.norm(shape), np.inf
        for iteration in range(1, NEWTON_STEPS + 1):
            D, along, across, scale = self.matrices(s, share)
            D, along, across = (scale[:, None] * part * scale for part in (D, along, across))
            y = q / scale
            y = y / np.linalg.norm(y)
            # Newton's step on D(s) q = 0 with the length along y fixed; D is not analytic where losses follow |Im s|.
            size = max(float(np.linalg.norm(along @ y)), 1e-300)
            bordered = np.block([[D, (along @ y)[:, None] / size], [y.conj()[None, :], np.zeros((1, 1))]])
            right = np.array([[*np.zeros(len(y)), 1.0], [*(-across @ y / size), 0.0]]).T
            change, across_part = np.linalg.lstsq(bordered, right, rcond=1e-15)[0].T
            further = -change[-1].imag / (across_part[-1].imag or np.inf)  # keeps the step along Re s real
            change = change + further * across_part
            step = complex(change[-1].real, further) / size
            s, q = s + step, scale * change[:-1]
            moved = abs(step) / abs(s)
            if moved <= CONVERGED or (moved <= 1e-11 and moved >= previous):
                return Mode(complex(s), q / np.abs(q).max(), float(moved), True, iteration)
            previous = moved
        return Mode(complex(s), q / np.abs(q).max(), float(moved), False, NEWTON_STEPS)


def damped_modes(system: RowSystem, count: int) -> tuple[FloatArray, Eigenpairs, int]:
    """Shapes (n_q, n_rigid) of rigid motions, all other modes found, and the number of vibrations that were lost.

    The lowest ``count`` modes without damping are followed; real poles up to their frequencies are added.
    """
    require_resistance(system, (system.inertia > 0) | (system.damping != 0) | stiff_laws(system))
    rates, shapes = undamped_modes(system, count)
    rigid = rigid_motions(system)
    # Rigid motions that dampers resist are real poles.
    turning = rigid.shape[1] - unresisted_motions(system, elastic(system) | (system.damping != 0)).dimension
    vibrating = [group for group in equal_rates(rates) if rates[group[0]] > 0]
    if not _is_damped(system, rates):
        places = [place for group in vibrating for place in group]
        modes = [Mode(1j * rates[place], shapes[:, place].astype(complex)) for place in places]
        return rigid, Eigenpairs.of_modes(modes, system.n_coordinates), 0
    modes, lost = _followed(system, rates, shapes, vibrating)
    real = _real_poles(system, float(rates.max(initial=0)) or first_rate(system))
    if any(table.rows for _, table in system.dynamic):  # others are of modes that vibrate where tables are their own
        real = sorted(real, key=lambda mode: abs(mode.value))[: turning + 2 * lost]
    # An overdamped vibration becomes two real poles.
    overdamped = (len(real) - turning) // 2
    return rigid, Eigenpairs.of_modes([*modes, *real], system.n_coordinates), max(0, lost - overdamped)


def _is_damped(system: RowSystem, rates: FloatArray) -> bool:
    return bool(np.any(system.damping != 0)) or any(np.any(table.kappa(rates).imag) for _, table in system.dynamic)


def _followed(
    system: RowSystem, rates: FloatArray, shapes: FloatArray, vibrating: list[list[int]]
) -> tuple[list[Mode], int]:
    damped = DampedSystem(system)
    modes: list[Mode] = []
    lost = 0
    for place, group in enumerate(vibrating):
        beside = [rates[vibrating[other][0]] for other in (place - 1, place + 1) if 0 <= other < len(vibrating)]
        rate = float(np.mean(rates[group]))
        room = min([abs(rate - neighbour) for neighbour in beside] or [rate])
        for start, shape in _split_by_damping(damped, rate, shapes[:, group].astype(complex)):
            mode = _follow(damped, start, shape, room)
            if mode is None or (mode.value.imag <= ON_AXIS * abs(mode.value)):
                lost += 1
            else:
                modes.append(mode)
    return modes, lost + _without_repetitions(modes)


def _without_repetitions(modes: list[Mode]) -> int:
    """Number of modes that were found twice, after the repetitions are taken out of the list ``modes``."""
    kept: list[Mode] = []
    for mode in modes:
        same = [known.shape for known in kept if abs(known.value - mode.value) <= SAME_FREQUENCY * abs(mode.value)]
        basis = np.array([*same, mode.shape]).T
        sizes = np.linalg.svd(basis / np.linalg.norm(basis, axis=0), compute_uv=False)
        if not same or sizes[-1] > 1e-5:
            kept.append(mode)
    missing = len(modes) - len(kept)
    modes[:] = kept
    return missing


def _split_by_damping(damped: DampedSystem, rate: float, shapes: ComplexArray) -> list[tuple[complex, ComplexArray]]:
    """Starts (pole in rad/s, shape) from shapes of one frequency, combined so that damping separates them."""
    if shapes.shape[1] == 1:
        return [(1j * rate, shapes[:, 0])]
    # Equal frequencies part to first order, by Phi^T (D - D_free) Phi against Phi^T dD/ds Phi.
    (free, _, slope, _), (whole, *_) = damped.matrices(1j * rate, 0.0), damped.matrices(1j * rate, 1.0)
    reduced = np.linalg.solve(-1j * shapes.T @ slope @ shapes, shapes.T @ (whole - free) @ shapes)
    _, mixed = np.linalg.eig(reduced)
    return [(1j * rate, shapes @ mixed[:, place]) for place in range(shapes.shape[1])]


def _follow(damped: DampedSystem, start: complex, shape: ComplexArray, room: float) -> Mode | None:
    """Mode (pole in rad/s, shape) with full damping that an undamped one becomes, or None where lost.

    It is lost also on the real axis.
    """
    mode, share, step = Mode(start, shape), 0.0, 1.0
    # All the damping at once if that works, else in steps that halve and double.
    while share < 1:
        trial = damped.newton(mode.value, mode.shape, min(1.0, share + step))
        alike = abs(np.vdot(trial.shape, mode.shape)) ** 2
        alike /= np.linalg.norm(trial.shape) ** 2 * np.linalg.norm(mode.shape) ** 2
        near = abs(trial.value - mode.value) <= LARGEST_MOVE * min(room, abs(mode.value))
        if trial.converged and near and alike >= LEAST_MAC and trial.value.imag > 0:
            mode, share, step = trial, min(1.0, share + step), 2 * step
            continue
        step /= 2
        if step < SMALLEST_DAMPING_STEP:
            return None
    return mode


def _real_poles(system: RowSystem, rate: float) -> list[Mode]:
    """Modes (pole in rad/s, shape) on the negative real axis, with the stiffnesses that springs have at rest."""
    low, high = REAL_DECADES
    sizes = rate * np.logspace(low, high, REAL_GRID)
    counts = _negative_on_axis(system, sizes)
    modes: list[Mode] = []
    # Each real pole changes the number of negative pivots of the real D(s).
    for place in np.flatnonzero(np.diff(counts)):
        change = int(counts[place + 1] - counts[place])
        for number in range(abs(change)):
            wanted = counts[place] + (number + 1) * np.sign(change)
            size = _crossing(system, sizes[place], sizes[place + 1], wanted, rising=change > 0)
            shape = _real_vector(system, size).astype(complex)
            if _is_crossed(system, size, shape):
                modes.append(Mode(complex(-size), shape))
    return modes


def _is_crossed(system: RowSystem, size: float, shape: ComplexArray) -> bool:
    """Whether the dynamic stiffness changes sign at a real pole (its size in rad/s) by more than rounding.

    No pole is there where a damper absorbs all waves that arrive.
    """
    kappa, rate, _ = DampedSystem(system).stiffness(complex(-size), 1.0)
    twist = np.abs(system.rows @ shape) ** 2
    # Change of x^T D x by the size of the pole, over the terms that make it up.
    drag = system.damping * size
    changed = abs(rate @ (system.rows @ shape) ** 2) * size
    return bool(changed > LEAST_CHANGE * (np.abs(kappa) + np.abs(drag)) @ twist)


def _on_axis(system: RowSystem, sizes: FloatArray) -> FloatArray:
    kappa = system.stiffness[:, None] - system.damping[:, None] * sizes + system.inertia[:, None] * sizes**2
    for law, table in system.dynamic:
        kappa[law] += table.at(-sizes.astype(complex), np.zeros(len(sizes))).real
    return np.asarray(kappa)


def _negative_on_axis(system: RowSystem, sizes: FloatArray) -> FloatArray:
    return negative_pivots(system.sparse_rows, _on_axis(system, sizes), system.n_coordinates)


def _crossing(system: RowSystem, low: float, high: float, wanted: float, *, rising: bool) -> float:
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        count = _negative_on_axis(system, np.array([middle]))[0]
        beyond = count >= wanted if rising else count <= wanted
        low, high = (low, middle) if beyond else (middle, high)
        if high - low <= 2 * np.spacing(high):
            break
    return (low + high) / 2


def _real_vector(system: RowSystem, size: float) -> FloatArray:
    kappa, rows = _on_axis(system, np.array([size]))[:, 0], system.rows
    D = rows.T @ (kappa[:, None] * rows)
    # The null vector of D(s), found with rows and columns of one size.
    scale = 1 / np.sqrt(np.abs(rows.T**2 @ np.abs(kappa)) + 1e-300)
    values, vectors = np.linalg.eigh(scale[:, None] * D * scale)
    shape = scale * vectors[:, np.argmin(np.abs(values))]
    return np.asarray(shape / np.abs(shape).max())

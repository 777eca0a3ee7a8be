"""Modes of a drivetrain with continuous shafts and damping.

Each mode is followed from the one without damping, while the damping grows to its size, by Newton steps on D(s) q = 0
with the exact D(s). Real poles are where the number of negative pivots of the real D(s) changes along the negative real
axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.assembly.rows import ComplexArray, FloatArray, RowSystem
from torsionnet.solve.dynamic_stiffness.nullspace import unresisted
from torsionnet.solve.dynamic_stiffness.reduction import AnyArray, require_resistance, stiff_laws
from torsionnet.solve.modes.continuous import SAME, elastic, first_rate, groups, rigid_motions, undamped_modes
from torsionnet.solve.modes.frozen_stiffness import Found, Mode
from torsionnet.solve.modes.sturm import negative_pivots

NEWTON, STILL = 30, 1e-14
"""Newton steps, and the relative step at which they end."""
SMALLEST = 2.0**-12
"""Least part of the damping that is added at a time."""
ALIKE, NEAR = 0.5, 0.5
"""How alike shapes stay while damping is added, and how far a pole may move, over its distance to others."""
REAL_GRID, REAL_DECADES = 900, (-9, 3)
ON_AXIS = 1e-9
CROSSED = 1e-9
"""Least change of the torques of a motion at a real pole, over their size."""
BISECTIONS = 60


@dataclass(frozen=True)
class Damped:
    """D(s) with a share of the damping."""

    system: RowSystem

    def stiffness(self, s: complex, share: float) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Of every law, and its derivatives to Re s and to Im s: losses follow |Im s|, so that these are two."""
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
        """D, its derivatives to Re s and Im s, and a scale of the coordinates that makes its terms of one size."""
        rows = self.system.rows
        kappa, along, across = (part[:, None] for part in self.stiffness(s, share))
        scale = 1 / np.sqrt(rows.T**2 @ np.abs(kappa[:, 0]) + 1e-300)
        return rows.T @ (kappa * rows), rows.T @ (along * rows), rows.T @ (across * rows), np.asarray(scale)

    def refined(self, s: complex, shape: ComplexArray, share: float) -> Mode:
        """Newton steps from a pole and its shape nearby, with Re s and Im s as two unknowns that are real."""
        q, previous = shape / np.linalg.norm(shape), np.inf
        for iteration in range(1, NEWTON + 1):
            D, along, across, scale = self.matrices(s, share)
            D, along, across = (scale[:, None] * part * scale for part in (D, along, across))
            y = q / scale
            y = y / np.linalg.norm(y)
            size = max(float(np.linalg.norm(along @ y)), 1e-300)
            bordered = np.block([[D, (along @ y)[:, None] / size], [y.conj()[None, :], np.zeros((1, 1))]])
            right = np.array([[*np.zeros(len(y)), 1.0], [*(-across @ y / size), 0.0]]).T
            found, turned = np.linalg.lstsq(bordered, right, rcond=1e-15)[0].T
            further = -found[-1].imag / (turned[-1].imag or np.inf)  # along Im s, so that the step along Re s is real
            found = found + further * turned
            step = complex(found[-1].real, further) / size
            s, q = s + step, scale * found[:-1]
            moved = abs(step) / abs(s)
            if moved <= STILL or (moved <= 1e-11 and moved >= previous):
                return Mode(complex(s), q / np.abs(q).max(), float(moved), True, iteration)
            previous = moved
        return Mode(complex(s), q / np.abs(q).max(), float(moved), False, NEWTON)


def damped_modes(system: RowSystem, count: int) -> tuple[FloatArray, Found, int]:
    """Rigid motions, the other modes, and how many vibrations could not be followed.

    The lowest ``count`` of those without damping are followed; real poles up to their band are added.
    """
    require_resistance(system, (system.inertia > 0) | (system.damping != 0) | stiff_laws(system))
    rates, shapes = undamped_modes(system, count)
    rigid = rigid_motions(system)
    turning = rigid.shape[1] - unresisted(system, elastic(system) | (system.damping != 0)).dimension
    vibrating = [group for group in groups(rates) if rates[group[0]] > 0]
    if not _is_damped(system, rates):
        places = [place for group in vibrating for place in group]
        modes = [Mode(1j * rates[place], shapes[:, place].astype(complex)) for place in places]
        return rigid, _collected(modes, [], system.n_coordinates), 0
    modes, lost = _followed(system, rates, shapes, vibrating)
    real = _real_poles(system, float(rates.max(initial=0)) or first_rate(system))
    overdamped = (len(real) - turning) // 2
    return rigid, _collected(modes, real, system.n_coordinates), max(0, lost - overdamped)


def _is_damped(system: RowSystem, rates: FloatArray) -> bool:
    return bool(np.any(system.damping != 0)) or any(np.any(table.kappa(rates).imag) for _, table in system.dynamic)


def _followed(
    system: RowSystem, rates: FloatArray, shapes: FloatArray, groups: list[list[int]]
) -> tuple[list[Mode], int]:
    damped = Damped(system)
    found: list[Mode] = []
    lost = 0
    for place, group in enumerate(groups):
        beside = [rates[groups[other][0]] for other in (place - 1, place + 1) if 0 <= other < len(groups)]
        rate = float(np.mean(rates[group]))
        room = min([abs(rate - one) for one in beside] or [rate])
        for start, shape in _parted(damped, rate, shapes[:, group].astype(complex)):
            mode = _follow(damped, start, shape, room)
            if mode is None or (mode.value.imag <= ON_AXIS * abs(mode.value)):
                lost += 1
            else:
                found.append(mode)
    return found, lost + _repeated(found)


def _repeated(found: list[Mode]) -> int:
    """How many of the modes are another one once more; these are taken out."""
    kept: list[Mode] = []
    for mode in found:
        same = [one.shape for one in kept if abs(one.value - mode.value) <= SAME * abs(mode.value)]
        basis = np.array([*same, mode.shape]).T
        sizes = np.linalg.svd(basis / np.linalg.norm(basis, axis=0), compute_uv=False)
        if not same or sizes[-1] > 1e-5:
            kept.append(mode)
    missing = len(found) - len(kept)
    found[:] = kept
    return missing


def _parted(damped: Damped, rate: float, shapes: ComplexArray) -> list[tuple[complex, ComplexArray]]:
    """Shapes of one frequency, combined as the damping parts them."""
    if shapes.shape[1] == 1:
        return [(1j * rate, shapes[:, 0])]
    (free, _, slope, _), (whole, *_) = damped.matrices(1j * rate, 0.0), damped.matrices(1j * rate, 1.0)
    reduced = np.linalg.solve(-1j * shapes.T @ slope @ shapes, shapes.T @ (whole - free) @ shapes)
    _, mixed = np.linalg.eig(reduced)
    return [(1j * rate, shapes @ mixed[:, place]) for place in range(shapes.shape[1])]


def _follow(damped: Damped, start: complex, shape: ComplexArray, room: float) -> Mode | None:
    """The mode that a mode without damping becomes; None where it gets lost, as on the real axis."""
    mode, share, step = Mode(start, shape), 0.0, 1.0
    while share < 1:
        trial = damped.refined(mode.value, mode.shape, min(1.0, share + step))
        alike = abs(np.vdot(trial.shape, mode.shape)) ** 2
        alike /= np.linalg.norm(trial.shape) ** 2 * np.linalg.norm(mode.shape) ** 2
        near = abs(trial.value - mode.value) <= NEAR * min(room, abs(mode.value))
        if trial.converged and near and alike >= ALIKE and trial.value.imag > 0:
            mode, share, step = trial, min(1.0, share + step), 2 * step
            continue
        step /= 2
        if step < SMALLEST:
            return None
    return mode


def _real_poles(system: RowSystem, rate: float) -> list[Mode]:
    """Poles on the negative real axis, with what stiffness there is at rest."""
    low, high = REAL_DECADES
    sizes = rate * np.logspace(low, high, REAL_GRID)
    counts = _negative_on_axis(system, sizes)
    found: list[Mode] = []
    for place in np.flatnonzero(np.diff(counts)):
        change = int(counts[place + 1] - counts[place])
        for number in range(abs(change)):
            wanted = counts[place] + (number + 1) * np.sign(change)
            size = _crossing(system, sizes[place], sizes[place + 1], wanted, rising=change > 0)
            shape = _real_vector(system, size).astype(complex)
            if _is_crossed(system, size, shape):
                found.append(Mode(complex(-size), shape))
    return found


def _is_crossed(system: RowSystem, size: float, shape: ComplexArray) -> bool:
    """Whether D changes there by more than rounding, as it does not where a damper swallows all that arrives."""
    kappa, _, across = Damped(system).stiffness(complex(-size), 0.0)
    rate = -1j * across
    twist = np.abs(system.rows @ shape) ** 2
    drag = system.damping * size
    changed = abs((rate + system.damping) @ (system.rows @ shape) ** 2) * size
    return bool(changed > CROSSED * (np.abs(kappa) + np.abs(drag)) @ twist)


def _on_axis(system: RowSystem, sizes: FloatArray) -> FloatArray:
    kappa = system.stiffness[:, None] - system.damping[:, None] * sizes + system.inertia[:, None] * sizes**2
    for law, table in system.dynamic:
        kappa[law] += table.with_loss(0).at(-sizes.astype(complex), np.zeros(len(sizes))).real
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
    scale = 1 / np.sqrt(np.abs(rows.T**2 @ np.abs(kappa)) + 1e-300)
    values, vectors = np.linalg.eigh(scale[:, None] * D * scale)
    found = scale * vectors[:, np.argmin(np.abs(values))]
    return np.asarray(found / np.abs(found).max())


def _collected(vibrations: list[Mode], real: list[Mode], n_q: int) -> Found:
    every = [*vibrations, *real]
    shapes: AnyArray = np.array([mode.shape for mode in every], dtype=complex).reshape(len(every), n_q).T
    return Found(
        np.array([mode.value for mode in every], dtype=complex),
        np.asarray(shapes, dtype=complex),
        np.arange(len(every)) >= len(vibrations),
        np.array([mode.error for mode in every], dtype=float),
        np.array([mode.converged for mode in every], dtype=bool),
        np.array([mode.iterations for mode in every], dtype=int),
    )

"""Pairs of undamped and damped modes of a drivetrain with the most similar strain.

Strong dampers move frequencies so far that their order says nothing, and the mode of a damper may have most of the
motion. Shafts fail by strain: pairs are chosen for the most similar strain, by the modal assurance criterion weighted
with the stiffness. Undamped modes of one frequency count together, since any mixture of their shapes is a mode shape.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray, RowSystem
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.linear.modes.eigen import undamped_modes, unit_shapes
from torsionnet.linear.modes.modes import OSCILLATORY, Modes
from torsionnet.linear.modes.natural_modes import modes as damped_modes
from torsionnet.linear.modes.vibration_mode import VibrationMode

LEAST_SIMILARITY = 0.5
"""Similarity of strain, from 0 to 1, below which an undamped and a damped mode are no pair."""
REPEATED_FREQUENCY = 1e-6
"""Relative difference below which natural frequencies are one repeated frequency, whose shapes may be mixed in any
way."""


def vibration_modes(drivetrain: AssembledModel, modes: Modes) -> tuple[VibrationMode, ...]:
    """Vibration modes as pairs of undamped and damped modes, by undamped frequency, then modes with damping only.

    A pair has the number of its damped mode; undamped modes without a partner are numbered after all vibrations.
    """
    assembly = drivetrain.assembly
    rates, shapes = undamped_modes(assembly.system)
    rates, shapes = rates[rates > 0], shapes[:, rates > 0]
    places = [assembly.node_index[name] for name in assembly.kinematics.coordinates]
    vibrating = [number for number, kind in enumerate(modes.kinds) if kind == OSCILLATORY]
    similarities = _similarity(assembly.system, rates, shapes, np.asarray(modes.shapes[np.ix_(places, vibrating)]))
    partners = _in_order(dict(_assigned(similarities)), rates)
    behind = itertools.count(len(vibrating) + 1)
    at_nodes = unit_shapes(np.asarray(assembly.node_rows.dense @ shapes)).astype(complex)
    found: list[VibrationMode] = []
    for number, rate in enumerate(rates):
        damped = None if number not in partners else vibrating[partners[number]]
        similarity = math.nan if damped is None else float(similarities[number, partners[number]])
        place = next(behind) if damped is None else partners[number] + 1
        found.append(_mode(place, rate / (2 * np.pi), modes, damped, similarity, at_nodes[:, number]))
    for place, damped in enumerate(vibrating):
        if place not in partners.values():
            found.append(_mode(place + 1, math.nan, modes, damped, math.nan, modes.shapes[:, damped]))
    return tuple(found)


def undamped_place(drivetrain: AssembledModel, number: int) -> tuple[int, VibrationMode]:
    """Index among undamped vibrations, by rising frequency, of the mode with this number, and the mode itself.

    Raises
    ------
    UsageError
        There is no such mode, or the mode exists with damping only.
    """
    found = vibration_modes(drivetrain, damped_modes(drivetrain))
    for place, mode in enumerate(found):
        if mode.number == number:
            if math.isnan(mode.undamped_frequency):
                raise UsageError(
                    f"mode {number} ({mode.natural_frequency:.5g} Hz) exists with damping only; choose another mode"
                )
            return place, mode
    known = f"there are {len(found)}, counted from 1 without rigid bodies" if found else "nothing vibrates here"
    raise UsageError(f"there is no mode {number}; {known}")


def _in_order(partners: Mapping[int, int], rates: FloatArray) -> dict[int, int]:
    """Index of the damped partner by index of the undamped mode.

    Among undamped modes of one frequency partners are sorted.
    """
    found: dict[int, int] = {}
    for group in _groups(rates):
        paired = [place for place in group if place in partners]
        found |= dict(zip(paired, sorted(partners[place] for place in paired), strict=True))
    return found


def _mode(
    number: int, undamped: float, modes: Modes, damped: int | None, similarity: float, shape: ComplexArray
) -> VibrationMode:
    return VibrationMode(
        number=number,
        undamped_frequency=float(undamped),
        natural_frequency=math.nan if damped is None else float(modes.natural_frequencies[damped]),
        damped_frequency=math.nan if damped is None else float(modes.damped_frequencies[damped]),
        damping_ratio=math.nan if damped is None else float(modes.damping_ratios[damped]),
        similarity=similarity,
        shape=shape,
    )


def _similarity(system: RowSystem, rates: FloatArray, shapes: FloatArray, damped: ComplexArray) -> FloatArray:
    """Share (n_undamped, n_damped) of each damped mode's strain energy that lies in each undamped mode's shape."""
    found = np.zeros((len(rates), damped.shape[1]))
    rows = system.rows
    for group in _groups(rates):
        stiffness = system.stiffness.copy()
        for law, table in system.dynamic:
            stiffness[law] += max(table.energy(1j * float(rates[group[0]]))[1], 0.0)
        weight = np.sqrt(stiffness)[:, None]
        basis, strain = np.linalg.qr(weight * (rows @ shapes[:, group]))[0], weight * (rows @ damped)
        sizes = np.sum(np.abs(strain) ** 2, axis=0)
        common = np.sum(np.abs(basis.T @ strain) ** 2, axis=0)
        found[group] = np.divide(common, sizes, out=np.zeros_like(sizes), where=sizes > 0)
    return found


def _groups(rates: FloatArray) -> Iterator[list[int]]:
    """Yield groups of indices of rising natural frequencies that are equal within rounding."""
    group: list[int] = []
    for place, rate in enumerate(rates):
        if group and rate - rates[group[0]] > REPEATED_FREQUENCY * rate:
            yield group
            group = []
        group.append(place)
    if group:
        yield group


def _assigned(similarity: FloatArray) -> Iterator[tuple[int, int]]:
    """Yield index pairs (undamped, damped) of modes with the largest sum of strain similarities, similar ones only."""
    clear = np.where(similarity >= LEAST_SIMILARITY, similarity, 0)
    rows = np.flatnonzero(clear.any(axis=1))
    if not len(rows):
        return
    best = clear[rows].max(axis=1, initial=0.0)
    is_best = clear[rows] == best[:, None]
    if (is_best.sum(axis=1) == 1).all() and (is_best.sum(axis=0) <= 1).all():
        # Each row has one largest entry, all in columns of their own: no other choice reaches their sum.
        yield from zip(rows.tolist(), is_best.argmax(axis=1).tolist(), strict=True)
        return
    from scipy.optimize import linear_sum_assignment  # a quarter of a second of CPU, which few drivetrains need

    for row, column in zip(*linear_sum_assignment(-clear), strict=True):
        if clear[row, column]:
            yield int(row), int(column)

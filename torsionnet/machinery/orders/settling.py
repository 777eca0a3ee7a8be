"""Parameters that depend on the vibratory torque, as of rubber couplings, iterated until both agree."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import Rows
from torsionnet.base.units import RPM
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.machinery.orders.operating_groups import IteratedValues
from torsionnet.model.definition import Definition
from torsionnet.model.parameters import VIBRATORY_TORQUE

VALUE_TOLERANCE = 1e-8
"""Relative difference up to which a parameter agrees with its table at the vibratory torque that it causes.

A larger value saves iterations and moves responses by about as much.
"""
MOST_ITERATIONS = 100
"""Most iterations of a parameter at one speed, after which that speed counts as one without a solution."""
SLOW_CONVERGENCE = 0.7
"""Change of an iteration, over the change before, from which on steps are halved because the iteration swings."""


def values_by_vibration(
    definition: Definition, speeds: FloatArray, vibration: Callable[[Sequence[str], IteratedValues], FloatArray]
) -> IteratedValues:
    """Values (n_speeds,) in SI units by name of the parameters that depend on an element's vibratory torque.

    Every speed is iterated from the smallest vibration in the table, with shorter steps where it swings, until no value
    moves by more than :data:`VALUE_TOLERANCE`. Where several vibrations agree with their values, the result is the
    smallest that the iteration meets from there.

    Parameters
    ----------
    definition : Definition
    speeds : (n_speeds,) array
        rad/s, for messages.
    vibration : callable
        (elements, values) -> half ranges of their torques, shape (n_speeds, n_elements), N m.

    Raises
    ------
    UsageError
        A speed does not settle, or settles beyond the table.
    """
    tables = {name: one for name, one in definition.following.items() if one.by == VIBRATORY_TORQUE}
    if not tables:
        return {}
    elements = list(dict.fromkeys(one.of for one in tables.values()))
    columns = [elements.index(one.of) for one in tables.values()]
    values = np.array([np.full(len(speeds), float(one.table[0][1].value)) for one in tables.values()])
    length, before = np.ones(len(speeds)), np.full(len(speeds), np.inf)
    for _ in range(MOST_ITERATIONS):
        sizes = vibration(elements, dict(zip(tables, values, strict=True)))[:, columns].T
        wanted = np.array([_clamped(one.table, size) for one, size in zip(tables.values(), sizes, strict=True)])
        moved = (np.abs(wanted - values) / np.abs(wanted).max(axis=1, keepdims=True)).max(axis=0)
        if (moved <= VALUE_TOLERANCE).all():
            for (name, one), size in zip(tables.items(), sizes, strict=True):
                _require_inside(name, one.of, one.table, size, speeds)
            return dict(zip(tables, wanted, strict=True))
        length = np.where(moved > SLOW_CONVERGENCE * before, length / 2, length)
        before = moved
        values = values + length * (wanted - values)
    open_ = moved > VALUE_TOLERANCE
    first = speeds[open_][0] * RPM
    text = f"{' and '.join(tables)} and the vibration do not settle within {VALUE_TOLERANCE:g} of each other"
    advice = "give a smoother table over the vibratory torque"
    raise UsageError(f"{text} at {open_.sum()} of {len(speeds)} speeds, the first {first:.6g} rpm; {advice}")


def _clamped(table: Rows, sizes: FloatArray) -> FloatArray:
    keys, values = (np.array([float(row[side].value) for row in table]) for side in (0, 1))
    return np.asarray(np.interp(sizes, keys, values))


def _require_inside(name: str, element: str, table: Rows, sizes: FloatArray, speeds: FloatArray) -> None:
    low, high = (float(table[end][0].value) for end in (0, -1))
    outside = (sizes < low * (1 - VALUE_TOLERANCE)) | (sizes > high * (1 + VALUE_TOLERANCE))
    if outside.any():
        worst = int(np.argmax(np.where(outside, np.abs(sizes - low), -1)))
        ends = f"the table goes from {table[0][0]} to {table[-1][0]}"
        where = f"{sizes[worst]:.6g} N*m at {speeds[worst] * RPM:.6g} rpm"
        raise UsageError(f"{name}: the vibratory torque of {element} is {where}; {ends}, extend it")

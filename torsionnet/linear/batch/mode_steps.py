"""Matching of the modes of a variant to those of a neighbouring one, by eigenvalue and common energy.

Modes are followed along their eigenvalues: neighbours whose states have most of their energy in common are the same
mode. Where two modes have changed places in between and could have met, a shorter step says whether they did.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.batch.mode_states import common_energy
from torsionnet.linear.modes.mode_shapes import EQUAL_EIGENVALUES

SAME_MODE_ENERGY = 0.8
"""Energy in common, from 0 to 1, from which modes of neighbouring variants are the same mode, well above half."""
SUCCESSOR_ENERGY = 0.5
"""Energy in common, from 0 to 1, below which a mode has no successor, as less than half of it is the same motion."""
MISSING_MODE = -1
"""Column number that stands for a mode which a variant does not have."""

Columns = NDArray[np.intp]


class FollowedModes(NamedTuple):
    """Eigenvalues (n, m) in rad/s and energy vectors of modes, each in the column of the mode it continues."""

    values: ComplexArray
    states: ComplexArray

    def of(self, some: NDArray[np.generic]) -> FollowedModes:
        return FollowedModes(self.values[some], self.states[some])


def take_columns(array: NDArray[Any], columns: Columns) -> NDArray[Any]:
    """Values of an array at these columns of its last axis, NaN for columns marked as missing."""
    if not array.shape[-1]:
        return np.full((*array.shape[:-1], columns.shape[-1]), np.nan, dtype=array.dtype)
    found = np.take_along_axis(array, np.maximum(columns, 0), axis=-1)
    return np.asarray(np.where(columns == MISSING_MODE, np.nan, found))


class Successors(NamedTuple):
    """Columns (n, m) of the modes that continue each mode, and mask (n,) of unambiguous variants.

    Missing modes are marked.
    """

    columns: Columns
    clear: NDArray[np.bool_]


def successors(known: FollowedModes, found: FollowedModes) -> Successors:
    """Columns (n, m) of the modes that continue those of a neighbouring variant, where that is unambiguous.

    Parameters
    ----------
    known : Followed
        m modes that are followed.
    found : Followed
        All modes there are; NaN after the last one of a variant.
    """
    alike = common_energy(known.states, found.states)
    columns = _slower(known, found, alike)
    followed = ~np.isnan(known.values)
    best = np.take_along_axis(alike, columns[:, :, None], axis=2)[:, :, 0]
    twice = (columns[:, :, None] == columns[:, None, :]) & followed[:, :, None] & followed[:, None, :]
    values = np.take_along_axis(found.values, columns, axis=1)
    clear = ((best >= SAME_MODE_ENERGY) | ~followed).all(axis=1) & (twice.sum(axis=(1, 2)) == followed.sum(axis=1))
    clear &= ~_may_have_met(known.values, values).any(axis=(1, 2))
    return Successors(np.where(followed, columns, MISSING_MODE), clear)


def _slower(known: FollowedModes, found: FollowedModes, alike: FloatArray) -> Columns:
    """Column (n, m) of the mode whose energy is most like that of each known mode, per variant.

    Of two real poles into which an overdamped vibration falls it is the slower.
    """
    best = alike.max(axis=2, keepdims=True)
    real = _is_real(found.values)[:, None, :]
    chosen = np.argmax(alike, axis=2)
    falls = (known.values.imag > 0) & (np.take_along_axis(found.values, chosen, axis=1).imag == 0)
    slowest = np.argmax(real & (alike >= SAME_MODE_ENERGY * best), axis=2)
    return np.asarray(np.where(falls, slowest, chosen))


def _may_have_met(before: ComplexArray, after: ComplexArray) -> NDArray[np.bool_]:
    """Mask (n, m, m) of pairs of modes that have changed order and moved far enough to have met."""
    order = [_order(np.abs(values)) for values in (before, after)]
    kinds = [(values.imag > 0)[:, :, None] == (values.imag > 0)[:, None, :] for values in (before, after)]
    moved = np.abs(after - before)
    gap = np.maximum(np.abs(_differences(before)), np.abs(_differences(after)))
    met = moved[:, :, None] + moved[:, None, :] >= gap  # False for NaN
    return np.asarray((order[0] * order[1] < 0) & kinds[0] & kinds[1] & met)


def _order(sizes: FloatArray) -> FloatArray:
    """Sign (n, m, m) of the size difference of all pairs of modes, 1 or -1, and 0 for equal sizes."""
    apart = _differences(sizes)
    return np.where(np.abs(apart) > EQUAL_EIGENVALUES * sizes[:, :, None], np.sign(apart), 0.0)


def _differences(values: NDArray[Any]) -> NDArray[Any]:
    return np.asarray(values[:, :, None] - values[:, None, :])


def assign_modes(known: FollowedModes, found: FollowedModes) -> Columns:
    """Columns (1, m) that continue each mode of one ambiguous variant, with the most energy in common overall.

    Of two real poles that have become one vibration the slower one goes on.
    """
    from scipy.optimize import linear_sum_assignment

    alike = common_energy(known.states, found.states[:, :, ~np.isnan(found.values[0])])[0]
    alike[(alike < SUCCESSOR_ENERGY) | np.isnan(known.values[0])[:, None]] = 0.0
    columns = np.full(known.values.shape[1], MISSING_MODE)
    for mode, column in zip(*linear_sum_assignment(-alike), strict=True):
        if alike[mode, column] > 0:
            columns[mode] = column
    real = np.flatnonzero(_is_real(known.values[0]))
    for slower in real[columns[real] == MISSING_MODE]:
        for faster in real[columns[real] != MISSING_MODE]:
            column = columns[faster]
            sizes = np.abs(known.values[0, [slower, faster]])
            if found.values[0, column].imag > 0 and alike[slower, column] > 0 and sizes[0] < sizes[1]:
                columns[slower], columns[faster] = column, MISSING_MODE
                break
    return columns[None]


def _is_real(values: ComplexArray) -> NDArray[np.bool_]:
    return np.asarray((values.imag == 0) & (np.abs(values) > 0))

"""Matrices of whole steps of a motion in one contact state, and rows of what is read after each of many steps.

A step takes the state p to own p + first u + last u', with the torques u at its beginning and u' at its end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.motion.state_layout import Layout

BLOCK = 16
"""Number of steps looked at at once, a power of two: longer blocks save calls, shorter ones lose less at an event."""
LEVELS = round(math.log2(BLOCK)) + 1
"""Number of levels of 1, 2, 4 ... steps up to a block."""


@dataclass(frozen=True, eq=False)
class StepMatrices:
    """Matrices over p of 1, 2, 4 ... steps, shape (LEVELS, n_p, n_p), and of one step over u, each (n_p, n_u)."""

    powers: FloatArray
    first: FloatArray
    last: FloatArray

    def along(self, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Rows of p after 0 to BLOCK steps over p and over u at BLOCK + 2 grid points.

        The shapes are (BLOCK + 1, n_rows, n_p) and (BLOCK + 1, BLOCK + 2, n_rows, n_u).
        """
        ahead = rows[None]
        for power in self.powers:
            few = ahead[: BLOCK + 1 - len(ahead)]
            further = few.reshape(-1, rows.shape[1]) @ power
            ahead = np.concatenate([ahead, further.reshape(few.shape)])
        after, before = ahead @ self.first, ahead @ self.last
        pushed = np.zeros((BLOCK + 1, BLOCK + 2, *after.shape[1:]))
        for point in range(BLOCK):  # u acts through the step after a point, and as the end of the step before it
            pushed[point + 1 :, point] += after[: BLOCK - point]
            pushed[point + 1 :, point + 1] += before[: BLOCK - point]
        return ahead, pushed


def step_matrices(whole: FloatArray, at: Layout) -> StepMatrices:
    """Matrices of steps from that of one step for all of z, shape (N, N)."""
    last = whole[: at.n_p, at.slope]
    powers = [np.ascontiguousarray(whole[: at.n_p, : at.n_p])]
    while len(powers) < LEVELS:
        powers.append(powers[-1] @ powers[-1])
    return StepMatrices(np.array(powers), whole[: at.n_p, at.u] - last, np.ascontiguousarray(last))


def rows_along(rows: FloatArray, steps: StepMatrices, at: Layout) -> tuple[FloatArray, FloatArray]:
    """Rows of z after 0 to BLOCK - 1 steps over p and over u at BLOCK + 1 grid points.

    The shapes are (BLOCK, n_rows, n_p) and (BLOCK, n_rows, (BLOCK + 1) n_u); slopes are those after each point.
    """
    ahead, pushed = steps.along(rows[:, : at.n_p])
    point = np.arange(BLOCK)
    pushed[point, point] += rows[:, at.u] - rows[:, at.slope]
    pushed[point, point + 1] += rows[:, at.slope]
    return ahead[:BLOCK], _over_points(pushed[:BLOCK, : BLOCK + 1])


def rows_of_guards(rows: FloatArray, steps: StepMatrices, at: Layout) -> tuple[FloatArray, FloatArray]:
    """Rows of z after 0 to BLOCK steps over p and over u at BLOCK + 1 grid points.

    The shapes are (BLOCK + 1, n_rows, n_p) and (BLOCK + 1, n_rows, (BLOCK + 1) n_u); slopes are those before each
    point, but for the first one.
    """
    ahead, pushed = steps.along(rows[:, : at.n_p])
    point = np.arange(1, BLOCK + 1)
    pushed[point, point] += rows[:, at.u] + rows[:, at.slope]
    pushed[point, point - 1] -= rows[:, at.slope]
    pushed[0, 0] += rows[:, at.u] - rows[:, at.slope]
    pushed[0, 1] += rows[:, at.slope]
    return ahead, _over_points(pushed[:, : BLOCK + 1])


def _over_points(pushed: FloatArray) -> FloatArray:
    count, n_points, n_rows, n_u = pushed.shape
    return pushed.transpose(0, 2, 1, 3).reshape(count, n_rows, n_points * n_u)


def pushes_of(steps: StepMatrices) -> FloatArray:
    """Matrices of 1, 2, 4 ... steps over u at their grid points, flat one after another."""
    n_p, n_u = steps.first.shape
    pushes = [np.hstack([steps.first, steps.last])]
    for level in range(LEVELS - 1):
        push, size = pushes[-1], 1 << level
        twice = np.zeros((n_p, (2 * size + 1) * n_u))
        twice[:, : (size + 1) * n_u] = steps.powers[level] @ push
        twice[:, size * n_u :] += push
        pushes.append(twice)
    return np.concatenate([one.ravel() for one in pushes])


def push_offsets(n_p: int, n_u: int) -> NDArray[np.int64]:
    """Beginnings of the levels in the flat array of :func:`pushes_of`."""
    sizes = [n_p * ((1 << level) + 1) * n_u for level in range(LEVELS)]
    return np.cumsum([0, *sizes])[:-1]

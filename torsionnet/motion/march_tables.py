"""Tables of contact states for the march: matrices of steps, of guards at many grid points, and of parts of a step.

Matrices of whole steps of a motion in one contact state, and rows of what is read after each of many steps. A step
takes the state p to own p + first u + last u', with the torques u at its beginning and u' at its end.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.motion.contact_form import ContactForm
from torsionnet.motion.marching import DEGREE
from torsionnet.motion.motion_plant import LawPhases, Layout

# Matrices of whole steps of a motion in one contact state, and rows of what is read after each of many steps.

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
        # Rows after 0 to n - 1 steps times the matrix of n steps are those after n to 2 n - 1.
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
    # Within a step u + (u' - u) t: the column of the slope goes to u', and what is left of that of u to u.
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
        # The first half of the steps, carried on over the second, and the second half.
        twice = np.zeros((n_p, (2 * size + 1) * n_u))
        twice[:, : (size + 1) * n_u] = steps.powers[level] @ push
        twice[:, size * n_u :] += push
        pushes.append(twice)
    return np.concatenate([matrix.ravel() for matrix in pushes])


def push_offsets(n_p: int, n_u: int) -> NDArray[np.int64]:
    """Beginnings of the levels in the flat array of :func:`pushes_of`."""
    sizes = [n_p * ((1 << level) + 1) * n_u for level in range(LEVELS)]
    return np.cumsum([0, *sizes])[:-1]


GUARDS_PER_LAW = 3
"""Number of guards of a law: lower bound, upper bound, and sign of the torque of a contact, or of the rate of what
remembers."""
LOWER, UPPER, PUSH = 0, 1, 2
MOST_TURN = 0.25
"""Angle in rad that the fastest motion may turn between two points of the finer grid, see ``DEGREE``."""
HOLD_TOLERANCE = 1e-12
"""Share of the torque of a hold by which rounding may carry it over its limit. A row lets go at twice as much, so that
what has just come to stand at the limit, as friction behind a spring does, stays."""
MOST_BYTES = 300_000_000
"""Most memory in bytes of all tables, beyond which those of contact states left behind are made again."""


@dataclass(frozen=True, eq=False)
class MarchTable:
    """Tables of one contact state, with time in steps: see :func:`.marching.march` for the arrays in their order.

    Those over guards hold the guards that a motion changes, and zeros after them; ``numbers`` (1 + n_g,) are the count
    and the numbers of these guards.
    """

    ahead: FloatArray
    pushed: FloatArray
    powers: FloatArray
    pushes: FloatArray
    finer: FloatArray
    courses: FloatArray
    sizes: FloatArray
    halves: FloatArray
    taylor: FloatArray
    refresh: FloatArray
    numbers: NDArray[np.int64]

    @property
    def arrays(self) -> tuple[NDArray[Any], ...]:
        return tuple(getattr(self, field.name) for field in fields(self))


FIELDS = tuple(field.name for field in fields(MarchTable))
"""Names of the tables in the order in which the march takes them."""


def in_steps(at: Layout, h: float) -> FloatArray:
    """Units (N,) of the state z where time counts in steps of h seconds: rates are angles per step."""
    units = np.ones(at.size)
    units[at.v] = units[at.slope] = 1 / h
    return units


def guard_count(n_laws: int) -> int:
    """Number of guards of so many laws, at least one."""
    return max(1, GUARDS_PER_LAW * n_laws)


def guard_rows(form: ContactForm, laws: Sequence[LawPhases], contact: Sequence[int], at: Layout,
               scales: Sequence[int]) -> FloatArray:  # fmt: skip
    """Rows (n_g, N) over z in SI units that stay above zero as long as the contact state holds.

    A guard that a law has not is 1.
    """
    constant = np.eye(at.size)[at.constant]
    guards = np.tile(constant, (guard_count(len(laws)), 1))
    for number, (law, place) in enumerate(zip(laws, contact, strict=True)):
        phase = law.phases[place]
        own = guards[GUARDS_PER_LAW * number : GUARDS_PER_LAW * (number + 1)]
        if phase.kind == "hold":
            scale = constant if scales[number] < 0 else form.inputs[scales[number]]
            slack = 2 * HOLD_TOLERANCE * max(abs(phase.low), abs(phase.high))
            own[LOWER] = form.torques[number] - (phase.low - slack) * scale
            own[UPPER] = (phase.high + slack) * scale - form.torques[number]
            continue
        motion = form.rates[number] if law.over_rate else form.twists[number]
        if math.isfinite(phase.lower):
            own[LOWER] = motion - phase.lower * constant
        if math.isfinite(phase.upper):
            own[UPPER] = phase.upper * constant - motion
        if phase.sense:
            own[PUSH] = phase.sense * form.rates[number]
        elif phase.side and phase.damping:
            # k d + c d' of a contact, which pushes on its own side alone.
            line = phase.torque * constant + phase.stiffness * form.twists[number] + phase.damping * form.rates[number]
            own[PUSH] = line * (phase.side if phase.kind == "slope" else -phase.side)
    return guards


def march_table(form: ContactForm, guards: FloatArray, at: Layout, h: float, n_sub: int) -> MarchTable:
    """Tables of a contact state with guards (n_g, N) over z in SI units, for steps of h seconds."""
    units = in_steps(at, h)
    A = h * form.A * units / units[:, None]
    refresh = form.refresh * units / units[:, None]
    own_guards = changing_guards(guards, at)
    rows = guards[own_guards] * units
    finest = np.asarray(scipy.linalg.expm(A / n_sub))
    # Half a step, a quarter and so on: each is the square of the next one.
    parts = [finest]
    while len(parts) < round(math.log2(n_sub)):
        parts.insert(0, parts[0] @ parts[0])
    finer = [rows]
    for _ in range(n_sub):
        finer.append(finer[-1] @ finest)
    steps = step_matrices(parts[0] @ parts[0], at)
    ahead, pushed = rows_of_guards(rows, steps, at)
    taylor = taylor_rows(np.vstack([rows, np.eye(at.size)[at.n_q : at.constant]]), A)
    size, n_g = np.abs(A), len(guards)
    # Sizes of the terms of guards, and of what the motion changes in them in a step.
    changed = np.abs(rows) @ size
    return MarchTable(
        _padded(ahead.reshape(-1, at.n_p), (BLOCK + 1) * n_g),
        _padded(pushed.reshape(len(rows) * (BLOCK + 1), -1), (BLOCK + 1) * n_g),
        steps.powers,
        pushes_of(steps),
        _padded(np.concatenate(finer), (n_sub + 1) * n_g),
        _padded(taylor[:, : len(rows)].transpose(1, 0, 2).reshape(-1, at.size), (DEGREE + 1) * n_g),
        _padded(np.abs(rows) + changed + changed @ size / 2, n_g),
        np.array(parts),
        taylor[1:, len(rows) :].reshape(-1, at.size),
        np.ascontiguousarray(refresh[: at.n_p]),
        np.array([len(rows), *own_guards, *[0] * (n_g - len(rows))]),
    )


def table_steps(tables: Sequence[NDArray[Any]], number: int, at: Layout) -> StepMatrices:
    """Matrices of steps out of the stacked tables of contact states, of the one with a number."""
    powers, pushes = (tables[FIELDS.index(name)][number] for name in ("powers", "pushes"))
    first, last = np.split(pushes[: 2 * at.n_p * at.n_u].reshape(at.n_p, 2 * at.n_u), 2, axis=1)
    return StepMatrices(powers, first, last)


def changing_guards(guards: FloatArray, at: Layout) -> NDArray[np.int64]:
    """Numbers of the guards that a motion changes, at least one."""
    constant = np.eye(at.size)[at.constant]
    changing = np.flatnonzero((guards != constant).any(axis=1))
    return changing if len(changing) else np.zeros(1, dtype=np.int64)


def taylor_rows(rows: FloatArray, A: FloatArray) -> FloatArray:
    """Rows (DEGREE + 1, n_rows, N) of the Taylor coefficients of rows (n_rows, N) over z."""
    terms = [rows]
    for k in range(1, DEGREE + 1):
        terms.append(terms[-1] @ A / k)
    return np.array(terms)


def _padded(rows: FloatArray, count: int) -> FloatArray:
    """Rows with zeros below, ``count`` in all, so that the tables of all contact states are of one size."""
    padded = np.zeros((count, rows.shape[1]))
    padded[: len(rows)] = rows
    return padded

"""Tables of contact states for the march: matrices of steps, of guards at many grid points, and of parts of a step."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from torsionnet.assembly.rows import FloatArray
from torsionnet.solve.motion.contact_form import ContactForm, Layout
from torsionnet.solve.motion.marching import DEGREE
from torsionnet.solve.motion.phases import LawPhases

BLOCK = 16
"""Number of steps looked at at once, a power of two: longer blocks save calls, shorter ones lose less at an event."""
GUARDS_PER_LAW = 3
"""Number of guards of a law: lower bound, upper bound, and sign of the torque of a contact."""
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
    """Tables of one contact state, with time in steps: see :func:`.marching.march` for the arrays in their order."""

    guards: FloatArray
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

    @property
    def arrays(self) -> tuple[FloatArray, ...]:
        return tuple(getattr(self, one.name) for one in fields(self))


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
    one = np.eye(at.size)[at.one]
    found = np.tile(one, (guard_count(len(laws)), 1))
    for number, (law, place) in enumerate(zip(laws, contact, strict=True)):
        phase = law.phases[place]
        own = found[GUARDS_PER_LAW * number : GUARDS_PER_LAW * (number + 1)]
        if phase.kind == "hold":
            scale = one if scales[number] < 0 else form.inputs[scales[number]]
            slack = 2 * HOLD_TOLERANCE * max(abs(phase.low), abs(phase.high))
            own[LOWER] = form.torques[number] - (phase.low - slack) * scale
            own[UPPER] = (phase.high + slack) * scale - form.torques[number]
            continue
        motion = form.rates[number] if law.over_rate else form.twists[number]
        if math.isfinite(phase.lower):
            own[LOWER] = motion - phase.lower * one
        if math.isfinite(phase.upper):
            own[UPPER] = phase.upper * one - motion
        if phase.side and phase.damping:
            line = phase.torque * one + phase.stiffness * form.twists[number] + phase.damping * form.rates[number]
            own[PUSH] = line * (phase.side if phase.kind == "slope" else -phase.side)
    return found


def step_parts(whole: FloatArray, at: Layout) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Matrices of p, and of u at the beginning and at the end, which give p after a step, from that for all of z."""
    last = whole[: at.n_p, at.slope]
    return whole[: at.n_p, : at.n_p], whole[: at.n_p, at.u] - last, last


def past_rows(
    rows: FloatArray, own: FloatArray, first: FloatArray, last: FloatArray, count: int
) -> tuple[FloatArray, FloatArray]:
    """Rows of p after 1 to ``count`` steps over p and u at the beginning and at each step.

    The shapes are (count, n_rows, n_p) and (count, n_rows, (count + 1) n_u).
    """
    n_u = first.shape[1]
    ahead, pushed = np.zeros((count, *rows.shape)), np.zeros((count, len(rows), (count + 1) * n_u))
    for step in range(count):
        if step:
            pushed[step, :, n_u:] = pushed[step - 1, :, :-n_u]
        pushed[step, :, :n_u] += rows @ first
        pushed[step, :, n_u : 2 * n_u] += rows @ last
        rows = rows @ own
        ahead[step] = rows
    return ahead, pushed


def rows_along(rows: FloatArray, whole: FloatArray, at: Layout, count: int) -> tuple[FloatArray, FloatArray]:
    """Rows of z after 0 to ``count`` - 1 steps over p and over u at ``count`` + 1 grid points.

    The shapes are (count, n_rows, n_p) and (count, n_rows, (count + 1) n_u); slopes are those after each point.
    """
    n_u = at.n_u
    own, first, last = step_parts(whole, at)
    ahead, pushed = np.zeros((count, len(rows), at.n_p)), np.zeros((count, len(rows), (count + 1) * n_u))
    ahead[0] = rows[:, : at.n_p]
    if count > 1:
        ahead[1:], pushed[1:, :, : count * n_u] = past_rows(ahead[0], own, first, last, count - 1)
    direct, slope = rows[:, at.u], rows[:, at.slope]
    for step in range(count):
        pushed[step, :, step * n_u : (step + 1) * n_u] += direct - slope
        pushed[step, :, (step + 1) * n_u : (step + 2) * n_u] += slope
    return ahead, pushed


def march_table(form: ContactForm, guards: FloatArray, at: Layout, h: float, n_sub: int) -> MarchTable:
    """Tables of a contact state with guards (n_g, N) over z in SI units, for steps of h seconds."""
    units = in_steps(at, h)
    A = h * form.A * units / units[:, None]
    refresh = form.refresh * units / units[:, None]
    rows = guards * units
    finest = np.asarray(linalg.expm(A / n_sub))
    parts = [finest]
    while len(parts) < round(math.log2(n_sub)):
        parts.insert(0, parts[0] @ parts[0])
    whole = parts[0] @ parts[0]
    terms = [np.eye(at.size)]
    for k in range(1, DEGREE + 1):
        terms.append(terms[-1] @ A / k)
    taylor = np.array(terms)
    finer = [rows]
    for _ in range(n_sub):
        finer.append(finer[-1] @ finest)
    n_p, n_u, n_g = at.n_p, at.n_u, len(rows)
    own, first, last = step_parts(whole, at)
    ahead, pushed = past_rows(rows[:, :n_p], own, first, last, BLOCK)
    direct, slope = rows[:, at.u], rows[:, at.slope]
    for step in range(BLOCK):
        here, before = slice((step + 1) * n_u, (step + 2) * n_u), slice(step * n_u, (step + 1) * n_u)
        pushed[step, :, here] += direct + slope
        pushed[step, :, before] -= slope
    powers, pushes = [own], [np.hstack([first, last])]
    while len(powers) <= round(math.log2(BLOCK)):
        power, push = powers[-1], pushes[-1]
        size = len(push[0]) // n_u - 1
        twice = np.zeros((n_p, (2 * size + 1) * n_u))
        twice[:, : (size + 1) * n_u] = power @ push
        twice[:, size * n_u :] += push
        powers.append(power @ power)
        pushes.append(twice)
    return MarchTable(
        np.ascontiguousarray(rows),
        ahead.reshape(BLOCK * n_g, n_p),
        pushed.reshape(BLOCK * n_g, -1),
        np.array(powers),
        np.concatenate([push.ravel() for push in pushes]),
        np.concatenate(finer),
        np.einsum("gn,knm->gkm", rows, taylor).reshape(-1, at.size),
        np.abs(rows) @ (np.eye(at.size) + np.abs(A) + np.abs(A) @ np.abs(A) / 2),
        np.array(parts),
        taylor.reshape(-1, at.size),
        np.ascontiguousarray(refresh),
    )


def push_offsets(n_p: int, n_u: int) -> NDArray[np.int64]:
    """Beginnings of the levels in the flat array ``pushes`` of a table."""
    sizes = [n_p * ((1 << level) + 1) * n_u for level in range(round(math.log2(BLOCK)) + 1)]
    return np.cumsum([0, *sizes])[:-1]

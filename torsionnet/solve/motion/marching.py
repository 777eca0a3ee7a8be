"""March of a motion from grid point to grid point, with events located to rounding.

A motion in one contact state is linear, z(t + tau) = exp(A tau) z(t). Time counts in steps of the grid. Guards are
linear forms g z that stay above zero as long as the contact state holds; an event is where the first falls below zero.
Guards are evaluated at many grid points at once. A step is examined where a guard may fall below zero in it, even if it
does so between two grid points alone: at a turning point it lies below the smaller value at the ends by at most a
fraction of its second differences.

These functions are plain Python with few numpy calls a block; :mod:`.compiled_march` compiles them where numba is
installed. All arrays of contact states are stacked in :class:`.MarchTables`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

DEGREE = 12
"""Degree of the Taylor polynomials between the points of the finer grid, on which nothing turns by more than 0.25 rad:
what they leave out is below 0.25^13/13! = 2e-18."""
NEAR = 0.5
"""Share of its second differences by which a guard is taken to dip between two points. A parabola dips by 1/8."""
ROUNDING = 2e-15
"""Size, over the sizes of its terms and of what they change in a step, up to which a guard counts as zero, that is ten
roundings of 2.2e-16."""
MOST_NEWTON_STEPS = 60
"""Most steps of Newton's method with bisection: bisection alone reaches rounding in 53."""
LAST_STEP = 5e-17
"""Part of a step of the grid by which Newton's method may still move when it ends: a rounding of the finer grid."""
DONE, ASK, FULL, STORM = 0, 1, 2, 3
"""Reasons for which a march stops, at its end, at an event whose next contact state is not known, at full lists, or in
too many events within a window of time."""


def near_zero(values: Any, count: int) -> Any:
    """Mask (count,) of the steps between rows of guard values (count + 1, n_g) in which a guard may pass zero."""
    bend = np.empty_like(values)
    bend[1:-1] = np.abs(values[2:] - 2 * values[1:-1] + values[:-2])
    bend[0], bend[-1] = bend[1], bend[-2]
    lowest = np.minimum(values[1:], values[:-1])
    return (lowest < NEAR * np.maximum(bend[1:], bend[:-1]))[:count].any(axis=1)


def numbers_of(coefficients: Any) -> Any:
    """Coefficients of a polynomial as a list, which loops in Python read quicker than an array."""
    return coefficients.tolist()


def polynomial_at(coefficients: Any, at: float) -> float:
    """Value of a polynomial with ascending coefficients."""
    value = 0.0
    for k in range(DEGREE, -1, -1):
        value = value * at + coefficients[k]
    return value


def slope_at(coefficients: Any, at: float) -> float:
    """Derivative of a polynomial with ascending coefficients."""
    value = 0.0
    for k in range(DEGREE, 0, -1):
        value = value * at + k * coefficients[k]
    return value


def curvature_at(coefficients: Any, at: float) -> float:
    """Second derivative of a polynomial with ascending coefficients."""
    value = 0.0
    for k in range(DEGREE, 1, -1):
        value = value * at + k * (k - 1) * coefficients[k]
    return value


def root_between(coefficients: Any, above: float, below: float) -> float:
    """Place where a polynomial falls below zero, between one where it is positive and a later one where it is not."""
    at = 0.5 * (above + below)
    for _ in range(MOST_NEWTON_STEPS):
        value = polynomial_at(coefficients, at)
        if value > 0:
            above = at
        else:
            below = at
        slope = slope_at(coefficients, at)
        following = at - value / slope if slope != 0 else below
        if abs(following - at) <= LAST_STEP:
            break
        if not above < following < below:
            following = 0.5 * (above + below)
        at = following
    return at


def turning_point(coefficients: Any, first: float, last: float) -> float:
    """Place between two where the derivative of a polynomial changes its sign."""
    rising = slope_at(coefficients, last) > 0
    at = 0.5 * (first + last)
    for _ in range(MOST_NEWTON_STEPS):
        slope = slope_at(coefficients, at)
        if (slope > 0) == rising:
            last = at
        else:
            first = at
        bend = curvature_at(coefficients, at)
        following = at - slope / bend if bend != 0 else last
        if abs(following - at) <= LAST_STEP:
            break
        if not first < following < last:
            following = 0.5 * (first + last)
        at = following
    return at


def first_root(coefficients: Any, length: float, rounding: float) -> float:
    """First place from 0 to ``length`` where a guard falls below zero by more than rounding, or -1."""
    start, end = coefficients[0], polynomial_at(coefficients, length)
    if start < -rounding:
        return 0.0
    rising, rises = coefficients[1] > 0, slope_at(coefficients, length) > 0
    above, below = 0.0, length
    if end >= -rounding:
        if rising or not rises:
            return -1.0
        below = turning_point(coefficients, 0.0, length)
        if polynomial_at(coefficients, below) >= -rounding:
            return -1.0
    if start <= rounding:
        if not rising or rises:
            return 0.0
        above = turning_point(coefficients, 0.0, below)
        if polynomial_at(coefficients, above) <= rounding:
            return 0.0
    return root_between(coefficients, above, below)


def passed_points(z: Any, place: int, n_sub: int, halves: Any) -> Any:
    """State z at a point of the finer grid of a step, of which there are ``n_sub``."""
    if place == n_sub:
        return np.dot(halves[0], np.dot(halves[0], z))
    size = n_sub // 2
    for level in range(halves.shape[0]):
        if place >= size:
            z = np.dot(halves[level], z)
            place -= size
        size //= 2
    return z


def moved(z: Any, rest: float, taylor: Any) -> Any:
    """State z after less than the distance of two points of the finer grid."""
    powers = np.empty(DEGREE + 1)
    powers[0] = 1.0
    for k in range(1, DEGREE + 1):
        powers[k] = powers[k - 1] * rest
    return np.dot(powers, np.dot(taylor, z).reshape(DEGREE + 1, z.shape[0]))


def passed(z: Any, part: float, n_sub: int, halves: Any, taylor: Any) -> Any:
    """State z after a part of a step, from 0 to 1."""
    place = min(int(part * n_sub), n_sub)
    rest = part - place / n_sub
    z = passed_points(z, place, n_sub, halves)
    return moved(z, rest, taylor) if rest > 0 else z


def located(
    z: Any, length: float, n_sub: int, finer: Any, courses: Any, sizes: Any, halves: Any, taylor: Any
) -> tuple[float, int, Any]:
    """Time of the first event within a part of a step, the number of its guard, and z there; (-1, -1, z) without one.

    ``finer`` gives the guards at the points of the finer grid, ``courses`` their Taylor coefficients, ``sizes`` the
    sizes of their terms.
    """
    n_g = sizes.shape[0]
    values = np.dot(finer, z).reshape(n_sub + 1, n_g)
    close = near_zero(values, n_sub)
    for place in range(n_sub):
        start = place / n_sub
        if start >= length:
            break
        if not close[place]:
            continue
        here = passed_points(z, place, n_sub, halves)
        size = min(1.0 / n_sub, length - start)
        polynomials = np.dot(courses, here).reshape(n_g, DEGREE + 1)
        terms = np.dot(sizes, np.abs(here))
        found, which = -1.0, -1
        for guard in range(n_g):
            swing = abs(polynomials[guard, 1]) * size + abs(polynomials[guard, 2]) * size * size
            if min(values[place, guard], values[place + 1, guard]) > 2 * swing + ROUNDING * terms[guard]:
                continue
            root = first_root(numbers_of(polynomials[guard]), size, ROUNDING * terms[guard])
            if root >= 0 and (which < 0 or root < found):
                found, which = root, guard
        if which >= 0:
            return start + found, which, moved(here, found, taylor)
    return -1.0, -1, z


def jumped(p: Any, i: int, steps: int, n_u: int, drive: Any, offsets: Any, powers: Any, pushes: Any) -> Any:
    """State p after a number of whole steps from grid point i, under torques ``drive`` at the grid points."""
    n_p = p.shape[0]
    for level in range(powers.shape[0] - 1, -1, -1):
        size = 1 << level
        while steps >= size:
            width = (size + 1) * n_u
            push = pushes[offsets[level] : offsets[level] + n_p * width].reshape(n_p, width)
            p = np.dot(powers[level], p) + np.dot(push, drive[i * n_u : i * n_u + width])
            i += size
            steps -= size
    return p


def with_torques(p: Any, i: int, f: float, n_u: int, drive: Any) -> Any:
    """Whole state z = (p, u, slope) at the part f of the step from grid point i."""
    n_p = p.shape[0]
    z = np.empty(n_p + 2 * n_u)
    z[:n_p] = p
    for k in range(n_u):
        first, last = drive[i * n_u + k], drive[(i + 1) * n_u + k]
        z[n_p + k] = first + f * (last - first)
        z[n_p + n_u + k] = last - first
    return z


def march(
    state: Any, f: float, p: Any, drive: Any, n_u: int, n_sub: int, tables: Any, following: Any, offsets: Any,
    piece_numbers: Any, piece_times: Any, piece_states: Any, event_numbers: Any, event_times: Any, storm: Any,
) -> tuple[int, float, int]:  # fmt: skip
    """March in contact states until the end, an event that has to be asked about, or full lists.

    ``state`` holds the contact state, the grid point, the last grid point, and how many pieces and events are listed;
    ``f`` is the part of the step that has passed and ``p`` the state, which changes in place. Pieces are stretches of
    motion in one contact state (contact state, grid point, whole steps; part of the step at the beginning, part
    passed; state at the beginning), events (contact state, guard, grid point, next
    contact state or -1; part of the step). ``storm`` holds the
    length of a window of time, its beginning, and the most events and the events in it.

    Returns the reason for which the march stops, the part of the step there, and the number of the guard.
    """
    guards, ahead, pushed, powers, pushes, finer, courses, sizes, halves, taylors, refreshes = tables
    n_g = guards.shape[1]
    most = ahead.shape[1] // n_g
    c, i, last = state[0], state[1], state[2]
    n_pieces, n_events, reason, which = state[3], state[4], DONE, -1
    while i < last:
        if n_pieces + 2 > piece_numbers.shape[0] or n_events + 1 > event_numbers.shape[0]:
            reason = FULL
            break
        which = -1
        part, start = 0.0, f
        if f > 0:
            z = with_torques(p, i, f, n_u, drive)
            part, which, z = located(z, 1 - f, n_sub, finer[c], courses[c], sizes[c], halves[c], taylors[c])
            if which < 0:
                part = 1 - f
                z = passed(z, part, n_sub, halves[c], taylors[c])
        else:
            count = min(most, last - i)
            z = with_torques(p, i, 0.0, n_u, drive)
            values = np.empty((most + 1, n_g))
            values[0] = np.dot(guards[c], z)
            inputs = drive[i * n_u : (i + most + 1) * n_u]
            values[1:] = (np.dot(ahead[c], p) + np.dot(pushed[c], inputs)).reshape(most, n_g)
            close = near_zero(values, count)
            steps = count
            for step in range(count):
                if close[step]:
                    there = jumped(p, i, step, n_u, drive, offsets, powers[c], pushes[c])
                    z = with_torques(there, i + step, 0.0, n_u, drive)
                    part, which, z = located(z, 1.0, n_sub, finer[c], courses[c], sizes[c], halves[c], taylors[c])
                    if which >= 0:
                        steps = step
                        break
            if steps:
                piece_numbers[n_pieces, 0], piece_numbers[n_pieces, 1], piece_numbers[n_pieces, 2] = c, i, steps
                piece_times[n_pieces, 0], piece_times[n_pieces, 1] = 0.0, 0.0
                piece_states[n_pieces] = p
                n_pieces += 1
                p[:] = jumped(p, i, steps, n_u, drive, offsets, powers[c], pushes[c])
                i += steps
            if which < 0:
                continue
            start = 0.0
        if part > 0:
            piece_numbers[n_pieces, 0], piece_numbers[n_pieces, 1], piece_numbers[n_pieces, 2] = c, i, 0
            piece_times[n_pieces, 0], piece_times[n_pieces, 1] = start, part
            piece_states[n_pieces] = p
            n_pieces += 1
        if which < 0 or start + part >= 1.0:
            i += 1
            f = 0.0
        else:
            f = start + part
        p[:] = z[: p.shape[0]]
        if which < 0:
            continue
        event_numbers[n_events, 0], event_numbers[n_events, 1], event_numbers[n_events, 2] = c, which, i
        event_numbers[n_events, 3] = following[c, which]
        event_times[n_events] = f
        n_events += 1
        if i - storm[1] > storm[0]:
            storm[1], storm[3] = i, 0
        storm[3] += 1
        if storm[3] > storm[2]:
            reason = STORM
            break
        if following[c, which] < 0:
            reason = ASK
            break
        c = following[c, which]
        p[:] = np.dot(refreshes[c], with_torques(p, i, f, n_u, drive))[: p.shape[0]]
    state[0], state[1], state[3], state[4] = c, i, n_pieces, n_events
    return reason, f, which

"""March of a motion from grid point to grid point, with events located to rounding.

A motion in one contact state is linear, z(t + tau) = exp(A tau) z(t). Time counts in steps of the grid. Guards are
linear forms g z that stay above zero as long as the contact state holds; an event is where the first falls below zero.
Guards are evaluated at many grid points at once. A step is examined where a guard may fall below zero in it, even if it
does so between two grid points alone: at a turning point it lies below the smaller value at the ends by at most a
fraction of its second differences.

Polynomials of guards between two points of the finer grid say where one falls below zero for the first time. Steps of
the motion go over whole steps of the grid, to points within one, and in between.

These functions are plain Python with few numpy calls a block; :mod:`.compiled_march` compiles them where numba is
installed. All arrays of contact states are stacked in a :class:`.MarchTable`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

# Polynomials of guards between two points of the finer grid: where one falls below zero for the first time.

DEGREE = 12
"""Degree of the Taylor polynomials between the points of the finer grid, on which nothing turns by more than 0.25 rad:
what they leave out is below 0.25^13/13! = 2e-18."""
MOST_NEWTON_STEPS = 60
"""Most steps of Newton's method with bisection: bisection alone reaches rounding in 53."""
LAST_STEP = 5e-17
"""Part of a step of the grid by which Newton's method may still move when it ends: a rounding of the finer grid."""

ASTRAY = 1e3
"""Roundings by which a guard that has just come into force may lie below zero: states of motion are the rounded results
of many steps, and of terms larger than those of the guard."""
AT_ONCE = 1e-4
"""Part of a step of the grid after which such a guard lies above zero if it rises."""


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
        # Newton's step, or half the bracket where it would leave it.
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
    """First place from 0 to ``length`` where a guard falls below zero by more than rounding, or -1.

    One that begins a little below zero and rises above it at once, as a slip that has just begun, has not fallen.
    """
    begin, start = 0.0, coefficients[0]
    if start < -rounding:
        # Below zero from the start: it has to have risen a moment later.
        begin, below = AT_ONCE, start
        start = polynomial_at(coefficients, begin)
        if below < -ASTRAY * rounding or start <= 0:
            return 0.0
        if begin >= length:
            return -1.0
    end = polynomial_at(coefficients, length)
    rising, rises = slope_at(coefficients, begin) > 0, slope_at(coefficients, length) > 0
    above, below = begin, length
    if end >= -rounding:
        # Above zero at both ends: only a minimum between them can lie below.
        if rising or not rises:
            return -1.0
        below = turning_point(coefficients, begin, length)
        if polynomial_at(coefficients, below) >= -rounding:
            return -1.0
    if start <= rounding:
        # Zero at the start: if it rises first, it falls behind the maximum.
        if not rising or rises:
            return begin
        above = turning_point(coefficients, begin, below)
        if polynomial_at(coefficients, above) <= 0:
            return above
    return root_between(coefficients, above, below)


# Steps of a motion in one contact state: over whole steps of the grid, to points within one, and in between.

EXPONENTS = np.arange(1.0, DEGREE + 1)
"""Exponents of the Taylor polynomials of rates."""


def put(target: Any, values: Any) -> None:
    """Write values (n,) to the beginning of an array."""
    target[: values.shape[0]] = values


def product(matrix: Any, vector: Any) -> Any:
    """Product of a matrix and a vector."""
    return np.dot(matrix, vector)


def sum_of_products(matrix: Any, vector: Any, other: Any, torques: Any) -> Any:
    """Sum of the products of a matrix and a vector, and of another matrix and torques."""
    return np.dot(matrix, vector) + np.dot(other, torques)


def jumped(p: Any, i: int, steps: int, n_u: int, drive: Any, offsets: Any, powers: Any, pushes: Any) -> Any:
    """State p after a number of whole steps from grid point i, under torques ``drive`` at the grid points."""
    n_p = p.shape[0]
    # Steps by powers of two, the largest first.
    for level in range(powers.shape[0] - 1, -1, -1):
        size = 1 << level
        while steps >= size:
            width = (size + 1) * n_u
            push = pushes[offsets[level] : offsets[level] + n_p * width].reshape(n_p, width)
            p = sum_of_products(powers[level], p, push, drive[i * n_u : i * n_u + width])
            i += size
            steps -= size
    return p


def passed_points(z: Any, place: int, n_sub: int, halves: Any) -> Any:
    """State z at a point of the finer grid of a step, of which there are ``n_sub``."""
    if place == n_sub:
        return product(halves[0], product(halves[0], z))
    size = n_sub // 2
    for level in range(halves.shape[0]):
        if place >= size:
            z = product(halves[level], z)
            place -= size
        size //= 2
    return z


def moved(z: Any, rest: float, n_q: int, taylor: Any) -> Any:
    """State z after less than the distance of two points of the finer grid, with the torques from before.

    ``taylor`` gives the Taylor coefficients of all entries between the angles and the constant. Angles follow
    from their rates.
    """
    n_moving = taylor.shape[0] // DEGREE
    terms = np.dot(taylor, z).reshape(DEGREE, n_moving)
    powers = rest**EXPONENTS
    at = z.copy()
    # Angles from rates: a term of t^k becomes one of t^(k+1) / (k + 1).
    at[:n_q] += rest * (z[n_q : 2 * n_q] + np.dot(powers / (EXPONENTS + 1.0), terms)[:n_q])
    at[n_q : n_q + n_moving] += np.dot(powers, terms)
    return at


def passed(z: Any, part: float, n_sub: int, n_q: int, halves: Any, taylor: Any) -> Any:
    """State z after a part of a step, from 0 to 1, in which torques need not be those there."""
    place = min(int(part * n_sub), n_sub)
    rest = part - place / n_sub
    z = passed_points(z, place, n_sub, halves)
    return moved(z, rest, n_q, taylor) if rest > 0 else z


def with_torques(p: Any, i: int, f: float, n_u: int, drive: Any) -> Any:
    """Whole state z = (p, u, slope) at the part f of the step from grid point i."""
    n_p = p.shape[0]
    z = np.empty(n_p + 2 * n_u)
    put(z, p)
    for k in range(n_u):
        first, last = drive[i * n_u + k], drive[(i + 1) * n_u + k]
        z[n_p + k] = first + f * (last - first)
        z[n_p + n_u + k] = last - first
    return z


NEAR = 0.5
"""Share of its second differences by which a guard is taken to dip between two points. A parabola dips by 1/8."""
ROUNDING = 2e-15
"""Size, over the sizes of its terms and of what they change in a step, up to which a guard counts as zero, that is ten
roundings of 2.2e-16."""
DONE, ASK, FULL, STORM = 0, 1, 2, 3
"""Reasons for which a march stops, at its end, at an event whose next contact state is not known, at full lists, or in
too many events within a window of time."""


def near_zero(values: Any, count: int) -> Any:
    """Steps between rows of guard values (count + 1, n_g) in which guards may pass zero, and these guards, in pairs."""
    bend = np.empty_like(values)
    bend[1:-1] = np.abs(values[2:] - 2 * values[1:-1] + values[:-2])
    bend[0], bend[-1] = bend[1], bend[-2]
    lowest = np.minimum(values[1:], values[:-1])
    return np.nonzero((lowest < NEAR * np.maximum(bend[1:], bend[:-1]))[:count])


def size_of(sizes: Any, z: Any) -> float:
    """Size of the terms of a guard, whose sizes are over those of the entries of z."""
    return np.dot(sizes, np.abs(z))  # type: ignore[no-any-return]


def located(
    z: Any, length: float, n_sub: int, n_q: int, n_g: int, finer: Any, courses: Any, sizes: Any, halves: Any,
    taylor: Any,
) -> tuple[float, int, Any]:  # fmt: skip
    """Time of the first event within a part of a step, the place of its guard, and z there; (-1, -1, z) without one.

    The torques in z need not be those there.

    ``finer`` gives the guards at the points of the finer grid, ``courses`` their Taylor coefficients, ``sizes`` the
    sizes of their terms.
    """
    values = product(finer[: (n_sub + 1) * n_g], z).reshape(n_sub + 1, n_g)
    places, guards = near_zero(values, n_sub)
    here, place, which, first = z, -1, -1, 2.0
    for pair in range(places.shape[0]):
        start = places[pair] / n_sub
        # Pairs come in the order of time, so that no later point can have an earlier event.
        if start >= length or (which >= 0 and places[pair] != place):
            break
        if places[pair] != place:
            place = places[pair]
            here = passed_points(z, place, n_sub, halves)
        guard = guards[pair]
        course = product(courses[guard * (DEGREE + 1) : (guard + 1) * (DEGREE + 1)], here)
        rounding = ROUNDING * size_of(sizes[guard], here)
        root = first_root(numbers_of(course), min(1.0 / n_sub, length - start), rounding)
        if 0 <= root < first:
            first, which = root, guard
    if which >= 0:
        return place / n_sub + first, which, moved(here, first, n_q, taylor)
    return -1.0, -1, z


def noted(pieces: Any, n: int, c: int, i: int, steps: int, start: float, part: float, p: Any) -> int:
    """Number of the stretches of motion listed after one more."""
    numbers, times, states = pieces
    numbers[n, 0], numbers[n, 1], numbers[n, 2] = c, i, steps
    times[n, 0], times[n, 1] = start, part
    put(states[n], p)
    return n + 1


def march(
    state: Any, f: float, p: Any, drive: Any, n_u: int, n_sub: int, n_q: int, tables: Any, guards: Any, following: Any,
    offsets: Any, pieces: Any, event_numbers: Any, event_times: Any, storm: Any,
) -> tuple[int, float, int]:  # fmt: skip
    """March in contact states until the end, an event that has to be asked about, or full lists.

    ``state`` holds the contact state, the grid point, the last grid point, and how many pieces and events are listed;
    ``f`` is the part of the step that has passed and ``p`` the state, which changes in place. ``guards`` are the count
    and the numbers of the guards of each contact state that change. Pieces are stretches of motion in one contact state
    (contact state, grid point, whole steps; part of the step at the beginning, part passed; state at the beginning),
    events (contact state, guard, grid point, next contact state or -1; part of the step). ``storm`` holds the length of
    a window of time, its beginning, and the most events and the events in it.

    Returns the reason for which the march stops, the part of the step there, and the number of the guard.
    """
    ahead, pushed, powers, pushes, finer, courses, sizes, halves, taylors, refreshes = tables
    most = ahead.shape[1] // sizes.shape[1] - 1
    c, i, last = state[0], state[1], state[2]
    n_pieces, n_events, reason, which = state[3], state[4], DONE, -1
    while i < last:
        if n_pieces + 2 > pieces[0].shape[0] or n_events + 1 > event_numbers.shape[0]:
            reason = FULL
            break
        which, part, start, n_g = -1, 0.0, f, guards[c, 0]
        if f > 0:
            # The rest of a step, after an event within it.
            z = with_torques(p, i, f, n_u, drive)
            part, which, z = located(z, 1 - f, n_sub, n_q, n_g, finer[c], courses[c], sizes[c], halves[c], taylors[c])
            if which < 0:
                part = 1 - f
                z = passed(z, part, n_sub, n_q, halves[c], taylors[c])
        else:
            # From a grid point on: the guards at all points of a block by one product.
            count, rows = min(most, last - i), (most + 1) * n_g
            values = sum_of_products(ahead[c, :rows], p, pushed[c, :rows], drive[i * n_u : (i + most + 1) * n_u])
            there, steps, looked, z = p, 0, -1, p
            for step in near_zero(values.reshape(most + 1, n_g), count)[0]:
                if step == looked:
                    continue
                there = jumped(there, i + steps, step - steps, n_u, drive, offsets, powers[c], pushes[c])
                steps = looked = step
                z = with_torques(there, i + step, 0.0, n_u, drive)
                part, which, z = located(z, 1.0, n_sub, n_q, n_g, finer[c], courses[c], sizes[c], halves[c], taylors[c])
                if which >= 0:
                    break
            if which < 0:
                there = jumped(there, i + steps, count - steps, n_u, drive, offsets, powers[c], pushes[c])
                steps = count
            if steps:
                n_pieces = noted(pieces, n_pieces, c, i, steps, 0.0, 0.0, p)
                put(p, there)
                i += steps
            if which < 0:
                continue
            start = 0.0
        if part > 0:
            n_pieces = noted(pieces, n_pieces, c, i, 0, start, part, p)
        if which < 0 or start + part >= 1.0:
            i += 1
            f = 0.0
        else:
            f = start + part
        put(p, z[: p.shape[0]])
        if which < 0:
            continue
        which = guards[c, 1 + which]
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
        # z meets the conditions before the event but for the rounding of many steps: a slip begins at zero
        for contact in (c, following[c, which]):
            put(p, product(refreshes[contact], with_torques(p, i, f, n_u, drive)))
        c = following[c, which]
    state[0], state[1], state[3], state[4] = c, i, n_pieces, n_events
    return reason, f, which

"""Steps of a motion in one contact state: over whole steps of the grid, to points within one, and in between.

Time counts in steps of the grid. These functions are plain Python with few numpy calls; :mod:`.compiled_march` compiles
them where numba is installed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from torsionnet.motion.guard_polynomials import DEGREE

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
    found = z.copy()
    found[:n_q] += rest * (z[n_q : 2 * n_q] + np.dot(powers / (EXPONENTS + 1.0), terms)[:n_q])
    found[n_q : n_q + n_moving] += np.dot(powers, terms)
    return found


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

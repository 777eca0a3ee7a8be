"""March of a motion in loops that numba compiles when they are first used and keeps on disk.

The functions are those of :mod:`.marching`; this module makes compiled twins of them that call each other.
"""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np

from torsionnet.base.errors import MissingExtraError
from torsionnet.motion import marching
from torsionnet.motion.marching import DEGREE, NEAR

try:
    import numba
except ModuleNotFoundError as error:
    raise MissingExtraError('the compiled march needs numba: pip install "torsionnet[fast]"') from error
except ImportError as error:
    raise MissingExtraError(f"the compiled march needs a numba that works with this numpy: {error}") from error


def near_zero(values: Any, count: int) -> Any:
    """Steps in which guards may pass zero, and these guards, see :func:`.marching.near_zero`."""
    steps, guards = np.empty(count * values.shape[1], dtype=np.int64), np.empty(count * values.shape[1], dtype=np.int64)
    pairs, last = 0, values.shape[0] - 1
    for step in range(count):
        for guard in range(values.shape[1]):
            here, there = values[step, guard], values[step + 1, guard]
            bend = 0.0
            # Second differences on both sides bound how far a guard may dip between two points.
            for place in (max(step, 1), min(step + 1, last - 1)):
                bent = abs(values[place + 1, guard] - 2 * values[place, guard] + values[place - 1, guard])
                bend = max(bend, bent)
            if min(here, there) < NEAR * bend:
                steps[pairs], guards[pairs] = step, guard
                pairs += 1
    return steps[:pairs], guards[:pairs]


def put(target: Any, values: Any) -> None:
    """Write values to the beginning of an array."""
    for k in range(values.shape[0]):
        target[k] = values[k]


def sum_of_products(matrix: Any, vector: Any, other: Any, torques: Any) -> Any:
    """Sum of two products of matrices and vectors."""
    total, further = np.dot(matrix, vector), np.dot(other, torques)
    for k in range(total.shape[0]):
        total[k] += further[k]
    return total


def size_of(sizes: Any, z: Any) -> float:
    """Size of the terms of a guard."""
    size = 0.0
    for k in range(z.shape[0]):
        size += sizes[k] * abs(z[k])
    return size


def moved(z: Any, rest: float, n_q: int, taylor: Any) -> Any:
    """State z at a place between two points of the finer grid, see :func:`.marching.moved`."""
    n_moving = taylor.shape[0] // DEGREE
    terms, at, power = np.dot(taylor, z), z.copy(), 1.0
    for k in range(n_q):
        at[k] += rest * z[n_q + k]
    # Taylor: rate v + sum of r^(d+1) terms, angle q + r v + sum of r^(d+2)/(d + 2) terms
    for degree in range(DEGREE):
        power *= rest
        first, risen = degree * n_moving, power * rest / (degree + 2)
        for k in range(n_q):
            at[k] += risen * terms[first + k]
        for k in range(n_moving):
            at[n_q + k] += power * terms[first + k]
    return at


def numbers_of(coefficients: Any) -> Any:
    """Coefficients of a polynomial as they are."""
    return coefficients


COMPILED = (
    near_zero,
    put,
    sum_of_products,
    size_of,
    moved,
    numbers_of,
    marching.polynomial_at,
    marching.slope_at,
    marching.curvature_at,
    marching.root_between,
    marching.turning_point,
    marching.first_root,
    marching.product,
    marching.jumped,
    marching.passed_points,
    marching.passed,
    marching.with_torques,
    marching.located,
    marching.noted,
    marching.march,
)
"""Functions to compile, each after those that it calls."""


def _compiled() -> Callable[..., tuple[int, float, int]]:
    files = [Path(str(marching.__file__)), Path(__file__)]
    # numba keeps a function on disk until its own file changes, whatever the functions that it calls
    version = hashlib.sha256(b"".join(source.read_bytes() for source in files)).hexdigest()[:12]
    names: dict[str, Any] = {}
    for function in COMPILED:
        twin = FunctionType(function.__code__, {**function.__globals__, **names}, function.__name__)
        twin.__qualname__ = f"{function.__name__}_{version}"
        names[function.__name__] = numba.njit(cache=True, error_model="numpy")(twin)
    return names["march"]  # type: ignore[no-any-return]


_compiled_march = _compiled()


def march(*arguments: Any) -> tuple[int, float, int]:
    """March of a motion by the compiled twin of :func:`.marching.march`, or by itself where numba cannot compile it."""
    with contextlib.suppress(numba.core.errors.NumbaError):  # before anything is changed
        return _compiled_march(*arguments)
    return marching.march(*arguments)

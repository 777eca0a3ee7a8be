"""March of a motion in loops that numba compiles when they are first used and keeps on disk.

The functions are those of :mod:`.marching`, of which this module makes compiled twins that call each other.
"""

from __future__ import annotations

from collections.abc import Callable
from types import FunctionType
from typing import Any

import numpy as np

from torsionnet.core.errors import MissingExtraError
from torsionnet.solve.motion import marching
from torsionnet.solve.motion.marching import NEAR

try:
    import numba
except ModuleNotFoundError as error:
    raise MissingExtraError('the compiled march needs numba: pip install "torsionnet[fast]"') from error
except ImportError as error:
    raise MissingExtraError(f"the compiled march needs a numba that works with this numpy: {error}") from error


def near_zero(values: Any, count: int) -> Any:
    """Mask (count,) of the steps in which a guard may pass zero, see :func:`.marching.near_zero`."""
    found = np.zeros(count, dtype=np.bool_)
    last = values.shape[0] - 1
    for step in range(count):
        for guard in range(values.shape[1]):
            here, there = values[step, guard], values[step + 1, guard]
            bend = 0.0
            for place in (max(step, 1), min(step + 1, last - 1)):
                bent = abs(values[place + 1, guard] - 2 * values[place, guard] + values[place - 1, guard])
                bend = max(bend, bent)
            if min(here, there) < NEAR * bend:
                found[step] = True
                break
    return found


def numbers_of(coefficients: Any) -> Any:
    """Coefficients of a polynomial as they are."""
    return coefficients


COMPILED = (
    near_zero,
    numbers_of,
    marching.polynomial_at,
    marching.slope_at,
    marching.curvature_at,
    marching.root_between,
    marching.turning_point,
    marching.first_root,
    marching.passed_points,
    marching.moved,
    marching.passed,
    marching.located,
    marching.jumped,
    marching.with_torques,
    marching.march,
)
"""Functions to compile, each after those that it calls."""


def _compiled() -> Callable[..., tuple[int, float, int]]:
    names: dict[str, Any] = {}
    for function in COMPILED:
        space = {**vars(marching), **names}
        twin = FunctionType(function.__code__, space, function.__name__)
        names[function.__name__] = numba.njit(cache=True, error_model="numpy")(twin)
    return names["march"]  # type: ignore[no-any-return]


march = _compiled()
"""Compiled twin of :func:`.marching.march`."""

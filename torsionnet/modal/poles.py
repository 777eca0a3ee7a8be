"""Poles: one of each conjugate pair, in the order of their size."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.core.errors import UsageError
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray
from torsionnet.response.modes import OSCILLATORY, REAL

ROUND_OFF = 1e-9


def natural_frequencies(poles: ArrayLike) -> FloatArray:
    """``|lambda| / 2 pi`` in Hz."""
    return np.asarray(np.abs(poles) / (2 * np.pi))


def damping_ratios(poles: ArrayLike) -> FloatArray:
    """``-Re lambda / |lambda|``; 1 for a stable real pole."""
    values = np.asarray(poles, dtype=complex)
    return np.asarray(-values.real / np.abs(values))


def kinds(poles: ComplexArray) -> tuple[str, ...]:
    return tuple(REAL if value.imag == 0 else OSCILLATORY for value in poles)


def upper_half(roots: ComplexArray) -> NDArray[np.int_]:
    """Places of one root of each pair and of the real ones, by size."""
    kept = np.flatnonzero(roots.imag >= -ROUND_OFF * np.abs(roots))
    return np.asarray(kept[np.argsort(np.abs(roots[kept]), kind="stable")])


def cleaned(roots: ComplexArray) -> ComplexArray:
    """Roots with an imaginary part of round-off set to zero."""
    return np.where(np.abs(roots.imag) <= ROUND_OFF * np.abs(roots), roots.real, roots)


def as_poles(given: ArrayLike) -> ComplexArray:
    """Poles in rad/s as somebody gives them: one of each pair or both.

    >>> as_poles([-1 + 10j, -1 - 10j, -3]).tolist()
    [(-3+0j), (-1+10j)]
    """
    values = cleaned(np.atleast_1d(np.asarray(given, dtype=complex)))
    if values.ndim != 1 or not len(values) or not np.isfinite(values).all() or not values.all():
        raise UsageError("poles are a list of finite numbers in rad/s other than 0")
    return np.asarray(values[upper_half(values)])

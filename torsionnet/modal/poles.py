"""Natural frequencies, damping ratios and kinds of poles, and one pole of each conjugate pair."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.errors import UsageError
from torsionnet.linear.modes.modes import OSCILLATORY, REAL
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray

ROUND_OFF = 1e-9
"""Imaginary part of a pole over its size up to which the pole counts as real, being rounding of the eigenvalues."""


def natural_frequencies(poles: ArrayLike) -> FloatArray:
    """Natural frequencies ``|lambda| / 2 pi`` in Hz of poles lambda in rad/s, same shape."""
    return np.asarray(np.abs(poles) / (2 * np.pi))


def damping_ratios(poles: ArrayLike) -> FloatArray:
    """Damping ratios ``-Re lambda / |lambda|`` of poles lambda in rad/s, same shape, 1 for a stable real pole."""
    values = np.asarray(poles, dtype=complex)
    return np.asarray(-values.real / np.abs(values))


def kinds(poles: ComplexArray) -> tuple[str, ...]:
    """Kind of each pole, ``"oscillatory"`` or ``"real pole"``, in the order of the poles."""
    return tuple(REAL if value.imag == 0 else OSCILLATORY for value in poles)


def upper_half(roots: ComplexArray) -> NDArray[np.int_]:
    """Indices of the real roots and of one root of each conjugate pair, sorted by magnitude, among all roots."""
    kept = np.flatnonzero(roots.imag >= -ROUND_OFF * np.abs(roots))
    return np.asarray(kept[np.argsort(np.abs(roots[kept]), kind="stable")])


def without_rounding(roots: ComplexArray) -> ComplexArray:
    """Copy of complex roots in which an imaginary part of rounding size is zero, same shape."""
    return np.where(np.abs(roots.imag) <= ROUND_OFF * np.abs(roots), roots.real, roots)


def as_poles(given: ArrayLike) -> ComplexArray:
    """Poles in rad/s (n,), one of each conjugate pair, sorted by size, from a list that may hold both of a pair.

    >>> as_poles([-1 + 10j, -1 - 10j, -3]).tolist()
    [(-3+0j), (-1+10j)]
    """
    values = without_rounding(np.atleast_1d(np.asarray(given, dtype=complex)))
    if values.ndim != 1 or not len(values) or not np.isfinite(values).all() or not values.all():
        raise UsageError(
            "poles are a list of finite numbers in rad/s other than 0; give one or both of each conjugate pair"
        )
    return np.asarray(values[upper_half(values)])

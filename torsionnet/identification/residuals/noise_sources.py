"""Split of the noise of a record between the sensors of output and input."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import scipy

from torsionnet.linear.assembly.rows import FloatArray

REWEIGHTING_ROUNDS = 5
"""Repetitions of the least squares for noise powers, whose weights depend on their result; a few suffice."""
COMPATIBLE_STANDARD_ERRORS = 4.0
"""Standard errors by which two estimates of one noise power may differ and still be averaged, as noise that comes with
the excitation shows only in the lines that it drives."""
LEAST_POWER = np.finfo(float).tiny ** 0.25
"""Noise power that counts as none, whose inverse has a square in the range of numbers."""


def sensor_noise_powers(
    level: FloatArray,
    gain: FloatArray,
    rest: FloatArray,
    repeated: float = 1.0,
    seen: tuple[float, float] | None = None,
) -> tuple[float, float]:
    """Noise powers of output sensor and input sensor (as variances) that fit the noise left in all lines best.

    One number each for all lines: the level of a single line rests on the few windows in which the sweep passes it,
    and weights made of that alone would favour lines that happen to agree. Neither is below 0; one that is found within
    its own uncertainty of 0 is taken as the mean of all it may be, as no sensor is free of noise by chance.

    Parameters
    ----------
    level, gain, rest : (n,) array
        Noise left of every line, the squared magnitude of the response there, and what is known of the noise.
    repeated : float, optional
        Number of lines that share one independent value.
    seen : tuple of float, optional
        Noise power of the input as it was found elsewhere, and the standard error of that.

    Examples
    --------
    >>> [round(share, 2) for share in sensor_noise_powers(np.array([1.0, 3.0, 5.0]), np.arange(3.0), np.zeros(3))]
    [1.0, 2.0]
    """
    both = np.column_stack([np.ones_like(gain), gain])
    shares, spread = _shares(level, both, rest, repeated)
    if seen is None or abs(seen[0] - shares[1]) > COMPATIBLE_STANDARD_ERRORS * np.hypot(seen[1], spread[1]):
        made_up = rest + both @ shares
        shares = shares * np.mean(level / np.maximum(made_up, LEAST_POWER))
        return _above_zero(float(shares[0]), float(shares[1]))
    found = weighted_mean([seen, (float(shares[1]), float(spread[1]))])
    assert found is not None
    on_output, _ = _shares(level, both[:, :1], rest + found[0] * gain, repeated)
    return _above_zero(float(on_output[0]), found[0])


def weighted_mean(found: Iterable[tuple[float, float] | None]) -> tuple[float, float] | None:
    """Mean of values weighted by their standard errors, and its own standard error, or None without values.

    >>> weighted_mean([(1.0, 1.0), None, (2.0, 1.0)])
    (1.5, 0.7071067811865476)
    """
    known = [(value, max(error, np.finfo(float).tiny ** 0.25)) for value, error in filter(None, found)]
    if not known:
        return None
    total = sum(error**-2 for _, error in known)
    return sum(value * error**-2 for value, error in known) / total, float(total**-0.5)


def _shares(level: FloatArray, columns: FloatArray, rest: FloatArray, repeated: float) -> tuple[FloatArray, FloatArray]:
    """Powers of noise sources whose sum with a known rest fits a measured noise level, and their standard errors."""
    found, shares = np.maximum(level, LEAST_POWER), np.zeros(columns.shape[1])
    for _ in range(REWEIGHTING_ROUNDS):
        rows = columns / found[:, None]
        scale = np.maximum(rows.max(axis=0), LEAST_POWER)
        shares = scipy.optimize.nnls(rows / scale, (level - rest) / found)[0] / scale
        found = np.maximum(rest + columns @ shares, LEAST_POWER)
    return _probable(level - rest, columns, found, repeated)


def _probable(
    level: FloatArray, columns: FloatArray, found: FloatArray, repeated: float
) -> tuple[FloatArray, FloatArray]:
    """Means of noise powers under a normal distribution cut off at 0, and their standard deviations, (n_sources,)."""
    rows = columns / found[:, None]
    scale = np.maximum(np.linalg.norm(rows, axis=0), np.finfo(float).tiny)
    inverse = np.linalg.pinv(rows / scale)
    best = inverse @ (level / found)
    misfit = level / found - rows @ (best / scale)
    spread = np.sqrt(repeated * np.mean(misfit**2) * (inverse**2).sum(axis=1))
    far = best / np.maximum(spread, max(1e-12 * float(np.abs(best).max()), LEAST_POWER))
    shares = np.maximum(best + spread * np.exp(scipy.stats.norm.logpdf(far) - scipy.stats.norm.logcdf(far)), 0.0)
    return shares / scale, spread / scale


def _above_zero(on_output: float, on_input: float) -> tuple[float, float]:
    return max(on_output, 0.0 if on_input else np.finfo(float).tiny), on_input

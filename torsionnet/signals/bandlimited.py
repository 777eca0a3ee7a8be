"""Band-limited interpolation of the angle between the pulses of an encoder.

A pulse says exactly where the shaft is, at a time that the motion decides: the samples of the motion are not evenly
spaced in time. Over the mean rotation u, a smooth course through every few pulses, they nearly are. What the shaft does
beyond it, f(u), is known at u_k, just beside the whole numbers k; its values c_k there follow from

    sum over m of c_m K(u_k - m) = f(u_k),

where K is the sinc of Shannon's sampling theorem under a Gaussian, which makes its error fall exponentially with its
length: Qian, On the regularized Whittaker-Kotel'nikov-Shannon sampling formula, Proc. AMS 131 (2003) 1169. Orders up to
half the pulses of a turn can be found in this way, and are up to 5/6 of that. Teeth that stand beyond their places give
f at other places next to the whole numbers, which is all the same to the sum.

Between two whole numbers every K(r - m) is a polynomial in r but for rounding, so that a value is a product of the 81
samples around it with the coefficients of these polynomials: C. W. Farrow, A continuously variable digital delay
element, Proc. ISCAS (1988) 2641.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from torsionnet.core.errors import SolveError
from torsionnet.response.recording import FloatArray
from torsionnet.signals.rotation.gap_filling import Gaps, gaps_of
from torsionnet.signals.sample_counts import check_count

KERNEL_HALF_LENGTH = 40
"""Number of pulses on either side from which a value between encoder pulses is interpolated, as the error falls
exponentially with it."""
KEPT_BAND = 5 / 6
"""Share of half the pulses of a turn up to which orders are kept and their images are not."""
KERNEL_VARIANCE = KERNEL_HALF_LENGTH / (np.pi * (1 - KEPT_BAND))
"""Variance of the kernel's Gaussian in squared encoder steps, which sets how much of the band is kept."""
POINTS_PER_TURN = 8
"""Number of points per turn of the mean rotation, which therefore holds orders up to half as many."""
SPLINE_DEGREE = 7
"""Degree of the splines of the mean rotation, so smooth that their knots leave nothing in high orders."""
CONVERGED_STEPS, LEAST_REDUCTION = 1e-10, 0.97
"""Error in encoder steps below which the interpolation has converged, and the factor by which each iteration must
reduce it, as otherwise it would never converge."""
VALUES_PER_CHUNK = 2**13
"""Number of values that are interpolated together, as their windows of 81 samples then stay in the cache."""
POLYNOMIAL_DEGREE = 15
"""Degree of the polynomials of the kernel between two samples, whose error pi^16/(2^31 16!) is that of rounding."""


class Rotation:
    """Rotation of a shaft over time in encoder steps, interpolated through all pulses of the encoder.

    Parameters
    ----------
    times : (n,) array
        Time of every pulse kept, s.
    numbers : (n,) int array
        Steps since the first pulse; missing pulses are filled in first.
    steps_per_revolution : float
    offsets : (n,) array, optional
        Steps by which each pulse stands beyond its number, less than half a step.
    """

    kept_band = KEPT_BAND

    def __init__(
        self,
        times: FloatArray,
        numbers: NDArray[np.intp],
        steps_per_revolution: float,
        offsets: FloatArray | None = None,
    ) -> None:
        check_count(
            float(numbers[-1]),
            len(numbers),
            f"{len(numbers)} pulses from {times[0]:.6g} to {times[-1]:.6g} s",
            "most would be missing ones: cut the record at its gaps",
        )
        standing = np.arange(numbers[-1] + 1, dtype=float)
        if offsets is not None:
            standing[numbers] += offsets
        stamps = times if len(times) == len(standing) else _spline(standing[numbers], times)(standing)
        stamps[numbers] = times
        every = max(2, round(steps_per_revolution / POINTS_PER_TURN))
        points = numbers[
            np.unique(np.r_[np.searchsorted(numbers, np.arange(0, len(standing), every)), len(numbers) - 1])
        ]
        self.mean_rotation = _spline(stamps[points], standing[points])
        places = self.mean_rotation(stamps)
        self.deviation: FloatArray = _values_at_whole_numbers(places, standing - places, stamps, gaps_of(numbers))

    def at(self, times: FloatArray) -> FloatArray:
        """Rotation in encoder steps since the first pulse at times in s between first and last pulse, shape (n,)."""
        places = np.asarray(self.mean_rotation(times), dtype=float)
        return places + _between(self.deviation, places)

    def rate(self, times: FloatArray) -> FloatArray:
        """Speed in encoder steps a second at times in s between first and last pulse, shape (n,)."""
        places = np.asarray(self.mean_rotation(times), dtype=float)
        along = np.asarray(self.mean_rotation(times, 1), dtype=float)
        return along * (1 + _between(self.deviation, places, slope=True))


def _spline(x: FloatArray, y: FloatArray):  # type: ignore[no-untyped-def]  # noqa: ANN202
    from scipy.interpolate import make_interp_spline

    degree = min(SPLINE_DEGREE, len(x) - 1)
    return make_interp_spline(x, y, k=degree - (degree % 2 == 0 and degree > 1))


def _values_at_whole_numbers(
    places: FloatArray, values: FloatArray, times: FloatArray, gaps: Sequence[Gaps]
) -> FloatArray:
    """Values (n,) of a motion at whole encoder steps, by iteration from its values at positions next to them.

    In gaps they follow from the values around.
    """
    found, before = values.copy(), np.inf
    while True:
        left = values - _between(found, places)
        for gap in gaps:
            left[gap.within] = gap.filled(found + left) - found[gap.within]
        found += left
        worst = int(np.abs(left).argmax())
        size = float(np.abs(left[worst]))
        if size < CONVERGED_STEPS:
            return found
        if size > LEAST_REDUCTION * before:
            raise SolveError(
                f"the speed changes too fast around {times[worst]:.6g} s to interpolate the angle between pulses; "
                "cut the record there"
            )
        before = size


def _between(values: FloatArray, places: FloatArray, *, slope: bool = False) -> FloatArray:
    """Sampled motion interpolated at fractional sample numbers, (n,), in its unit; beyond its ends it is reflected.

    With ``slope`` its derivative to the sample number.
    """
    wide = np.pad(values, KERNEL_HALF_LENGTH, mode="reflect", reflect_type="odd")
    around = np.lib.stride_tricks.sliding_window_view(wide, 2 * KERNEL_HALF_LENGTH + 1)
    result = np.empty(len(places))
    for part in _chunks(len(places)):
        result[part] = _sum(around, places[part], _polynomials(slope))
    return result


def _sum(around: NDArray[np.float64], places: FloatArray, polynomials: FloatArray) -> FloatArray:
    whole = np.clip(np.rint(places).astype(np.intp), 0, len(around) - 1)
    rest = 2 * (places - whole)
    first, last = int(whole.min()), int(whole.max()) + 1
    if last - first < len(whole):  # several values between two samples share their window
        coefficients = (around[first:last] @ polynomials)[whole - first]
    else:
        coefficients = around[whole] @ polynomials
    total = coefficients[:, -1]
    for column in coefficients.T[-2::-1]:
        total = total * rest + column
    return total


@cache
def _polynomials(slope: bool) -> FloatArray:
    """Coefficients of the kernel of each sample around a place, of powers of twice the distance to the nearest one."""
    nodes = np.cos(np.pi * (np.arange(POLYNOMIAL_DEGREE + 1) + 0.5) / (POLYNOMIAL_DEGREE + 1))
    offset = nodes[:, None] / 2 - np.arange(-KERNEL_HALF_LENGTH, KERNEL_HALF_LENGTH + 1)
    kernel = np.sinc(offset) * np.exp(-(offset**2) / (2 * KERNEL_VARIANCE))
    found = np.polynomial.polynomial.polyfit(nodes, kernel, POLYNOMIAL_DEGREE)
    if slope:
        found = 2 * np.polynomial.polynomial.polyder(found)
    return np.ascontiguousarray(found.T)


def _chunks(count: int) -> Iterator[slice]:
    yield from (slice(begin, begin + VALUES_PER_CHUNK) for begin in range(0, count, VALUES_PER_CHUNK))

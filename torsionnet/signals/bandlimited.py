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
SPLINE_POINTS, SPLINE_MARGIN = 2**17, 64
"""Number of pulses through which a spline is laid together, whose equations take 23 MB, and of those shared with the
next: the influence of an end falls by 0.54 a pulse."""
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
        count = int(numbers[-1]) + 1
        stamps, beyond = times, offsets
        if len(times) < count:
            stamps = _filled(times, numbers, offsets)
            if offsets is not None:
                beyond = np.zeros(count)
                beyond[numbers] = offsets
        every = max(2, round(steps_per_revolution / POINTS_PER_TURN))
        points = np.unique(np.r_[np.searchsorted(numbers, np.arange(0, count, every)), len(numbers) - 1])
        standing = numbers[points] + (0.0 if offsets is None else offsets[points])
        self.mean_rotation = _spline(times[points], standing)
        places = self.mean_rotation(stamps)
        self._wide = _values_at_whole_numbers(places, beyond, stamps, gaps_of(numbers))

    def at(self, times: FloatArray) -> FloatArray:
        """Rotation in encoder steps since the first pulse at times in s between first and last pulse, shape (n,)."""
        places = np.asarray(self.mean_rotation(times), dtype=float)
        return places + _between(self._wide, places)

    def rate(self, times: FloatArray) -> FloatArray:
        """Speed in encoder steps a second at times in s between first and last pulse, shape (n,)."""
        places = np.asarray(self.mean_rotation(times), dtype=float)
        along = np.asarray(self.mean_rotation(times, 1), dtype=float)
        return along * (1 + _between(self._wide, places, slope=True))


def _filled(times: FloatArray, numbers: NDArray[np.intp], offsets: FloatArray | None) -> FloatArray:
    """Times in s at all whole numbers, (numbers[-1] + 1,), those of missing pulses by splines through the others."""
    stamps = np.empty(int(numbers[-1]) + 1)
    stamps[numbers] = times
    for begin in range(0, len(times) - 1, SPLINE_POINTS):
        end = min(begin + SPLINE_POINTS, len(times) - 1)
        missing = np.setdiff1d(np.arange(numbers[begin], numbers[end]), numbers[begin:end], assume_unique=True)
        if len(missing):
            part = slice(max(begin - SPLINE_MARGIN, 0), end + SPLINE_MARGIN)
            standing = numbers[part].astype(np.float64)
            if offsets is not None:
                standing += offsets[part]
            stamps[missing] = _spline(standing, times[part])(missing)
    return stamps


def _spline(x: FloatArray, y: FloatArray):  # type: ignore[no-untyped-def]  # noqa: ANN202
    from scipy.interpolate import make_interp_spline

    degree = min(SPLINE_DEGREE, len(x) - 1)
    return make_interp_spline(x, y, k=degree - (degree % 2 == 0 and degree > 1))


def _values_at_whole_numbers(
    places: FloatArray, beyond: FloatArray | None, times: FloatArray, gaps: Sequence[Gaps]
) -> FloatArray:
    """Values of a motion at whole encoder steps, by iteration from its values at places next to them.

    At a place it is what the pulse's number, and what its tooth stands beyond it, differ from the place. In gaps the
    values follow from those around. On either side they go on reflected, shape (n + 2 KERNEL_HALF_LENGTH,).
    """
    wide, left, before = np.empty(len(places) + 2 * KERNEL_HALF_LENGTH), np.empty(len(places)), np.inf
    found = wide[KERNEL_HALF_LENGTH:-KERNEL_HALF_LENGTH]
    for part in _chunks(len(places)):
        found[part] = _read_at(places, beyond, part)
    while True:
        _reflect(wide)
        for part in _chunks(len(places)):
            left[part] = _read_at(places, beyond, part) - _between(wide, places[part])
        for gap in gaps:
            gap.fill(found, left)
        found += left
        lowest, highest = int(left.argmin()), int(left.argmax())
        worst = lowest if -left[lowest] > left[highest] else highest
        size = float(np.abs(left[worst]))
        if size < CONVERGED_STEPS:
            _reflect(wide)
            return wide
        if size > LEAST_REDUCTION * before:
            raise SolveError(
                f"the speed changes too fast around {times[worst]:.6g} s to interpolate the angle between pulses; "
                "cut the record there"
            )
        before = size


def _read_at(places: FloatArray, beyond: FloatArray | None, part: slice) -> FloatArray:
    standing = np.arange(part.start, min(part.stop, len(places)), dtype=float)
    return (standing if beyond is None else standing + beyond[part]) - places[part]


def _reflect(wide: FloatArray) -> None:
    """Continue values beyond their ends by KERNEL_HALF_LENGTH points on either side, reflected there."""
    inside = wide[KERNEL_HALF_LENGTH:-KERNEL_HALF_LENGTH]
    if len(inside) <= KERNEL_HALF_LENGTH:
        wide[:] = np.pad(inside, KERNEL_HALF_LENGTH, mode="reflect", reflect_type="odd")
        return
    wide[:KERNEL_HALF_LENGTH] = 2 * inside[0] - inside[KERNEL_HALF_LENGTH:0:-1]
    wide[-KERNEL_HALF_LENGTH:] = 2 * inside[-1] - inside[-2 : -KERNEL_HALF_LENGTH - 2 : -1]


def _between(wide: FloatArray, places: FloatArray, *, slope: bool = False) -> FloatArray:
    """Motion interpolated at fractional sample numbers, (n,), in its unit, from samples that go on beyond their ends.

    With ``slope`` its derivative to the sample number.
    """
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

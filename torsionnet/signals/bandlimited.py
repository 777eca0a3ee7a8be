"""Band-limited interpolation of the angle between the pulses of an encoder.

A pulse says exactly where the shaft is, at a time that the motion decides: the samples of the motion are not evenly
spaced in time. Over the mean rotation u, the smooth course of least squares through all pulses, they nearly are. What
the shaft does beyond it, f(u), is known at u_k, just beside the whole numbers k; its values c_k there follow from

    sum over m of c_m K(u_k - m) = f(u_k),

where K is the sinc of Shannon's sampling theorem under a Gaussian, which makes its error fall exponentially with its
length: Qian, On the regularized Whittaker-Kotel'nikov-Shannon sampling formula, Proc. AMS 131 (2003) 1169. Orders up to
half the pulses of a turn can be found in this way, and are up to 5/6 of that. Where a u_k stands
further from k than LARGEST_DISTANCES, the mean rotation gets more knots and follows the vibration. Elsewhere it has
few, as an order over a u that vibrates itself has harmonics beyond the band. Teeth that stand beyond their places give
f at other places next to the whole numbers, which is all the same to the sum.

Between two whole numbers every K(r - m) is a polynomial in r but for rounding, so that a value is a product of the 81
samples around it with the coefficients of these polynomials: C. W. Farrow, A continuously variable digital delay
element, Proc. ISCAS (1988) 2641.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.resampling import check_count

# Values of a band-limited motion at pulses that are missing, from those around them.

FILLED_BAND, FILLED_BAND_WIDTH = 2 / 3, 4 / 3
"""Largest share of half the pulses of a turn up to which orders are filled into a gap, and its product with the number
of pulses that the gap lacks: with more, noise of the pulses around grows more than fourfold in the gap."""
FILLED_NOISE = 1e-5
"""Power of noise per pulse over that of the motion with which values are filled in, so that wide gaps stay bounded."""
HALVED_BANDS = 4
"""Number of bands, each half as wide as the last, whose power is ten times as large: amplitudes of angles fall with the
order."""
NEIGHBOURS = 24
"""Number of pulses on either side of a gap from which it is filled; more change the values by less than the noise."""
WIDEST_GAP = 8
"""Most pulses in a gap that those around it tell anything about; a wider one keeps the spline through it."""
GAPS_PER_CHUNK = 2**13
"""Number of gaps that are filled together, which limits the memory."""


@dataclass(frozen=True, eq=False)
class Gaps:
    """Gaps of one width between the pulses of an encoder, with the weights of the pulses around them.

    Attributes
    ----------
    first : (n_gaps,) int array
        Number of the first missing pulse of each gap.
    around : (2 * NEIGHBOURS,) int array
        Steps from there to the pulses around it.
    weights : (width, 2 * NEIGHBOURS) array
    """

    first: NDArray[np.intp]
    around: NDArray[np.intp]
    weights: FloatArray

    def fill(self, values: FloatArray, left: FloatArray) -> None:
        """Set what is ``left`` between a motion and its values ``values`` at the missing pulses, each (n,) in its unit.

        The motion there follows from its values around each gap.
        """
        missing = np.arange(len(self.weights))
        for begin in range(0, len(self.first), GAPS_PER_CHUNK):
            first = self.first[begin : begin + GAPS_PER_CHUNK, None]
            around = first + self.around
            within = first + missing
            left[within] = (values[around] + left[around]) @ self.weights.T - values[within]


def gaps_of(numbers: NDArray[np.intp]) -> tuple[Gaps, ...]:
    """Gaps between the numbers of an encoder's pulses by width, those too wide or too near the ends left out."""
    widths = np.diff(numbers) - 1
    gaps = []
    for width in (int(width) for width in np.unique(widths[widths > 0]) if width <= WIDEST_GAP):
        first = numbers[:-1][widths == width] + 1
        first = first[(first >= NEIGHBOURS) & (first + width + NEIGHBOURS <= numbers[-1] + 1)]
        around = np.r_[np.arange(-NEIGHBOURS, 0), np.arange(width, width + NEIGHBOURS)]
        gaps.append(Gaps(first, around, _weights(width, around)))
    return tuple(gaps)


def filled_band(width: int) -> float:
    """Share of half the pulses of a turn up to which orders are filled into a gap of so many missing pulses."""
    return min(FILLED_BAND, FILLED_BAND_WIDTH / width) if width else 1.0


def _weights(width: int, places: NDArray[np.intp]) -> FloatArray:
    """Weights (width, n) of the values at ``places`` for those from 0 to ``width``, of the least mean square error.

    The motion is taken to have the same power at all orders up to the band filled, and ten times as much in each half
    of a band (N. Wiener, Extrapolation, Interpolation and Smoothing of Stationary Time Series, 1949).
    """
    own = _covariance(places[:, None] - places, filled_band(width)) + FILLED_NOISE * np.eye(len(places))
    across = _covariance(np.arange(width)[:, None] - places, filled_band(width))
    return np.asarray(np.linalg.solve(own, across.T).T)


def _covariance(distances: NDArray[np.intp], band: float) -> FloatArray:
    """Covariance of a motion at pulses so many steps apart, over its power at orders in the upper half of the band."""
    halves = 2.0 ** np.arange(HALVED_BANDS)
    return np.asarray(sum(10 ** np.log2(n) * np.sinc(band / n * distances) for n in halves))


KERNEL_HALF_LENGTH = 40
"""Number of pulses on either side from which a value between encoder pulses is interpolated, as the error falls
exponentially with it."""
KEPT_BAND = 5 / 6
"""Share of half the pulses of a turn up to which orders are kept and their images are not."""
KERNEL_VARIANCE = KERNEL_HALF_LENGTH / (np.pi * (1 - KEPT_BAND))
"""Variance of the kernel's Gaussian in squared encoder steps, which sets how much of the band is kept."""
KNOTS_PER_TURN, FEWEST_STEPS = 2, 2
"""Number of knots per turn of the mean rotation where it need not follow the vibration, and least number of encoder
steps from knot to knot where it has to: least squares of fewer pulses a knot would put images of an order beside it."""
LARGEST_DISTANCES = (0.8, 0.25 / KEPT_BAND)
"""Largest distances in steps of a pulse from its number on the mean rotation, of which the first serves by which the
interpolation converges: it does up to a quarter of a Nyquist interval of the band (M. I. Kadec, The exact value of the
Paley-Wiener constant, 1964), and further where high orders are small."""
END_PULSES = 20
"""Number of pulses from either end of the record on which the rotation depends on what comes beyond it by up to 15 % of
an order's amplitude at the end, and by 0.02 % behind them."""
SPLINE_DEGREE = 7
"""Degree of the splines of the mean rotation, so smooth that their knots leave nothing in high orders."""
CONVERGED_STEPS, LEAST_REDUCTION, REDUCED_OVER = 1e-10, 0.75, 10
"""Error in encoder steps below which the interpolation has converged, and the factor by which so many iterations must
reduce it, as otherwise it would never converge; from one to the next it may rise, as at gaps and ends."""
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
    end_pulses = END_PULSES

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
        standing = numbers if offsets is None else numbers + offsets
        for distance in LARGEST_DISTANCES:
            apart = round(steps_per_revolution / KNOTS_PER_TURN)
            self.mean_rotation = smooth_course(times, standing, numbers, apart, distance)
            self._wide, doubtful = _values_at_whole_numbers(
                self.mean_rotation(stamps), beyond, stamps, gaps_of(numbers)
            )
            if doubtful is None:
                doubtful = self._first_turned_back(times)
            if doubtful is None:
                return
        raise SolveError(
            f"the speed changes too fast around {doubtful:.6g} s to interpolate the angle between pulses; "
            "cut the record there",
            kind="lost-pulses",
        )

    def _first_turned_back(self, times: FloatArray) -> float | None:
        """First time in s half-way between pulses, away from the ends, at which the shaft does not turn forwards."""
        last = len(times) - 1 - END_PULSES
        for begin in range(END_PULSES, last, SPLINE_POINTS):
            end = min(begin + SPLINE_POINTS, last)
            middle = (times[begin + 1 : end + 1] + times[begin:end]) / 2
            back = np.flatnonzero(self.rate(middle) <= 0)
            if len(back):
                return float(middle[back[0]])
        return None

    @property
    def beyond_band(self) -> float:
        """RMS in encoder steps of what lies beyond the band kept, as pulses with wrong numbers make it."""
        steps = np.diff(self._wide[KERNEL_HALF_LENGTH:-KERNEL_HALF_LENGTH])
        lines = np.fft.rfft(steps * np.hanning(len(steps)))
        return float(np.linalg.norm(lines[int(KEPT_BAND * len(lines)) :]) * np.sqrt(2) / len(steps))

    @property
    def alternation(self) -> float:
        """Encoder steps by which every second pulse stands beside the middle of its neighbours, over the record."""
        values = self._wide[KERNEL_HALF_LENGTH:-KERNEL_HALF_LENGTH]
        pairs = values[: len(values) // 2 * 2].reshape(-1, 2)
        return abs(float(np.diff(pairs[1:-1].mean(axis=0))[0])) if len(pairs) > 2 else 0.0

    def at(self, times: FloatArray) -> FloatArray:
        """Rotation in encoder steps since the first pulse at times in s between first and last pulse, shape (n,)."""
        places = np.asarray(self.mean_rotation(times), dtype=float)
        return places + _between(self._wide, places)

    def rate(self, times: FloatArray) -> FloatArray:
        """Speed in encoder steps a second at times in s between first and last pulse, shape (n,)."""
        places = np.asarray(self.mean_rotation(times), dtype=float)
        # d(u + f(u))/dt = (1 + f'(u)) du/dt, in place: an hour of pulses is 43 MB.
        speeds = _between(self._wide, places, slope=True)
        speeds += 1
        speeds *= self.mean_rotation(times, 1)
        return speeds


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

    return make_interp_spline(x, y, k=_degree(len(x)))


def _degree(count: int) -> int:
    """Odd degree of a spline through so many points."""
    degree = min(SPLINE_DEGREE, count - 1)
    return degree - (degree % 2 == 0 and degree > 1)


def smooth_course(
    times: FloatArray,
    standing: FloatArray | NDArray[np.intp],
    numbers: NDArray[np.intp],
    apart: int,
    distance: float = np.inf,
) -> Any:
    """Spline of least squares in encoder steps over time in s, its knots ``apart`` steps, or nearer.

    They are nearer where pulses would stand further than ``distance`` steps from it.
    """
    from scipy.ndimage import maximum_filter1d

    degree = _degree(len(times))
    inner, ends = slice(degree, -degree - 1), degree + 1
    near, passed = np.ones(len(times), dtype=bool), np.empty(len(times), dtype=bool)
    knots = np.empty(0)
    while True:
        apart = max(apart, FEWEST_STEPS)
        # A knot at the first pulse of every ``apart`` steps, told without copies of an hour of pulses.
        spans = numbers // apart
        passed[0], passed[1:] = spans[0] > 0, spans[1:] > spans[:-1]
        del spans
        knots = np.union1d(knots, times[inner][(passed & near)[inner]])
        spline = _least_squares(times, standing, np.r_[[times[0]] * ends, knots, [times[-1]] * ends], degree)
        if apart == FEWEST_STEPS or distance == np.inf:
            return spline
        far = np.abs(standing - spline(times)) > distance
        if not far.any():
            return spline
        # Knots change a spline some knots to either side.
        near = maximum_filter1d(far, 2 * SPLINE_DEGREE * min(apart, len(times)) + 1)
        apart //= 2


def _least_squares(x: FloatArray, y: FloatArray | NDArray[np.intp], knots: FloatArray, degree: int):  # type: ignore[no-untyped-def]  # noqa: ANN202
    """Spline of least squares by its banded normal equations; make_lsq_spline takes time with the square of points."""
    from scipy.interpolate import BSpline
    from scipy.linalg import solveh_banded

    count, order = len(knots) - degree - 1, degree + 1
    # By columns, as LAPACK factors it in place then: over an hour of pulses the band is as large as they are.
    band, right = np.zeros((order, count), order="F"), np.zeros(count)
    for begin in range(0, len(x), SPLINE_POINTS):
        part = slice(begin, begin + SPLINE_POINTS)
        design = BSpline.design_matrix(x[part], knots, degree)
        first, values = design.indices[::order], design.data.reshape(-1, order).T
        # Points follow one another, and so do the splines that are not 0 there: only theirs are added to.
        lowest, splines = int(first[0]), int(first[-1] - first[0]) + 1
        first = first - lowest
        for row in range(order):
            at = slice(lowest + row, lowest + row + splines)
            right[at] += np.bincount(first, values[row] * y[part], splines)
            for below in range(order - row):
                band[below, at] += np.bincount(first, values[row] * values[row + below], splines)
    return BSpline(knots, solveh_banded(band, right, overwrite_ab=True, overwrite_b=True, lower=True), degree)


def _values_at_whole_numbers(
    places: FloatArray, beyond: FloatArray | None, times: FloatArray, gaps: Sequence[Gaps]
) -> tuple[FloatArray, float | None]:
    """Values of a motion at whole encoder steps, by iteration from its values at places next to them.

    At a place it is what the pulse's number, and what its tooth stands beyond it, differ from the place. In gaps the
    values follow from those around. On either side they go on reflected, shape (n + 2 KERNEL_HALF_LENGTH,). With the
    time in s around which they do not converge, None if they do.
    """
    wide, left = np.empty(len(places) + 2 * KERNEL_HALF_LENGTH), np.empty(len(places))
    before: deque[float] = deque([np.inf], maxlen=REDUCED_OVER)
    values = wide[KERNEL_HALF_LENGTH:-KERNEL_HALF_LENGTH]
    for part in _chunks(len(places)):
        values[part] = _read_at(places, beyond, part)
    # Values at whole numbers, corrected by what they miss where the pulses stand, which is next to them.
    while True:
        _reflect(wide)
        for part in _chunks(len(places)):
            left[part] = _read_at(places, beyond, part) - _between(wide, places[part])
        for gap in gaps:
            gap.fill(values, left)
        values += left
        lowest, highest = int(left.argmin()), int(left.argmax())
        worst = lowest if -left[lowest] > left[highest] else highest
        size = float(np.abs(left[worst]))
        if size < CONVERGED_STEPS:
            _reflect(wide)
            return wide, None
        # Corrections that hardly shrink are vibration beyond what the pulses tell.
        if size > max(before) * (LEAST_REDUCTION if len(before) == REDUCED_OVER else 1):
            return wide, float(times[worst])
        before.append(size)


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
    # Horner's scheme, from the highest power on.
    total = coefficients[:, -1]
    for column in coefficients.T[-2::-1]:
        total = total * rest + column
    return total


@cache
def _polynomials(slope: bool) -> FloatArray:
    """Coefficients of the kernel of each sample around a place, of powers of twice the distance to the nearest one."""
    # Chebyshev's nodes: the error of the polynomials is about even over the interval.
    nodes = np.cos(np.pi * (np.arange(POLYNOMIAL_DEGREE + 1) + 0.5) / (POLYNOMIAL_DEGREE + 1))
    offset = nodes[:, None] / 2 - np.arange(-KERNEL_HALF_LENGTH, KERNEL_HALF_LENGTH + 1)
    kernel = np.sinc(offset) * np.exp(-(offset**2) / (2 * KERNEL_VARIANCE))
    coefficients = np.polynomial.polynomial.polyfit(nodes, kernel, POLYNOMIAL_DEGREE)
    if slope:
        # Twice, as the powers are of twice the distance.
        coefficients = 2 * np.polynomial.polynomial.polyder(coefficients)
    return np.ascontiguousarray(coefficients.T)


def _chunks(count: int) -> Iterator[slice]:
    yield from (slice(begin, begin + VALUES_PER_CHUNK) for begin in range(0, count, VALUES_PER_CHUNK))

"""Band-limited interpolation of the angle between the pulses of an encoder.

A pulse says exactly where the shaft is, at a time that the motion decides: the samples of the motion are not evenly
spaced in time. Over the mean rotation u, a smooth course through every few pulses, they nearly are. What the shaft does
beyond it, f(u), is known at u_k, just beside the whole numbers k; its values c_k there follow from

    sum over m of c_m K(u_k - m) = f(u_k),

where K is the sinc of Shannon's sampling theorem under a Gaussian, which makes its error fall exponentially with its
length: Qian, On the regularized Whittaker-Kotel'nikov-Shannon sampling formula, Proc. AMS 131 (2003) 1169. Orders up to
half the pulses of a turn can be found in this way, and are up to 5/6 of that.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from torsionnet.core.errors import SolveError
from torsionnet.response.recording import FloatArray
from torsionnet.signals.sample_counts import check_count

KERNEL_HALF_LENGTH = 40
"""Number of pulses on either side from which a value between encoder pulses is interpolated, as the error falls
exponentially with it."""
KERNEL_VARIANCE = KERNEL_HALF_LENGTH / (np.pi * (1 - 5 / 6))
"""Variance of the kernel's Gaussian in squared encoder steps, so that orders up to 5/6 of half the pulses are kept and
their images are not."""
POINTS_PER_TURN = 8
"""Number of points per turn of the mean rotation, which therefore holds orders up to half as many."""
SPLINE_DEGREE = 7
"""Degree of the splines of the mean rotation, so smooth that their knots leave nothing in high orders."""
CONVERGED_STEPS, LEAST_REDUCTION = 1e-10, 0.97
"""Error in encoder steps below which the interpolation has converged, and the factor by which each iteration must
reduce it, as otherwise it would never converge."""
VALUES_PER_CHUNK = 2**15
"""Number of values that are interpolated together, which limits the memory."""


class Rotation:
    """Rotation of a shaft over time in encoder steps, interpolated through all pulses of the encoder.

    Parameters
    ----------
    times : (n,) array
        Time of every pulse kept, s.
    numbers : (n,) int array
        Steps since the first pulse; missing pulses are filled in first.
    steps_per_revolution : float
    """

    def __init__(self, times: FloatArray, numbers: NDArray[np.intp], steps_per_revolution: float) -> None:
        check_count(
            float(numbers[-1]),
            len(numbers),
            f"{len(numbers)} pulses from {times[0]:.6g} to {times[-1]:.6g} s",
            "most would be missing ones: cut the record at its gaps",
        )
        whole = np.arange(numbers[-1] + 1, dtype=float)
        stamps = times if len(times) == len(whole) else _spline(numbers.astype(float), times)(whole)
        stamps[numbers] = times
        every = max(2, round(steps_per_revolution / POINTS_PER_TURN))
        points = np.unique(np.concatenate([np.arange(0, len(whole), every), [len(whole) - 1]]))
        self.mean_rotation = _spline(stamps[points], whole[points])
        places = self.mean_rotation(stamps)
        self.deviation: FloatArray = _values_at_whole_numbers(places, whole - places, stamps)

    def at(self, times: FloatArray) -> FloatArray:
        """Rotation in encoder steps since the first pulse at times in s between first and last pulse, shape (n,)."""
        places = np.asarray(self.mean_rotation(times), dtype=float)
        return places + _between(self.deviation, places)


def _spline(x: FloatArray, y: FloatArray):  # type: ignore[no-untyped-def]  # noqa: ANN202
    from scipy.interpolate import make_interp_spline

    degree = min(SPLINE_DEGREE, len(x) - 1)
    return make_interp_spline(x, y, k=degree - (degree % 2 == 0 and degree > 1))


def _values_at_whole_numbers(places: FloatArray, values: FloatArray, times: FloatArray) -> FloatArray:
    """Values (n,) of a motion at whole encoder steps, by iteration from its values at positions next to them."""
    found, before = values.copy(), np.inf
    while True:
        left = values - _between(found, places)
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


def _between(values: FloatArray, places: FloatArray) -> FloatArray:
    """Sampled motion interpolated at fractional sample numbers, (n,), in its unit; beyond its ends it is reflected."""
    wide = np.pad(values, KERNEL_HALF_LENGTH, mode="reflect", reflect_type="odd")
    result = np.empty(len(places))
    for part in _chunks(len(places)):
        result[part] = _sum(wide, places[part])
    return result


def _sum(wide: FloatArray, places: FloatArray) -> FloatArray:
    whole = np.clip(np.rint(places).astype(np.intp), 0, len(wide) - 2 * KERNEL_HALF_LENGTH - 1)
    rest = places - whole
    on = np.abs(rest) < CONVERGED_STEPS
    rest = np.where(on, 0.5, rest)
    total = np.zeros(len(places))
    for shift in range(-KERNEL_HALF_LENGTH, KERNEL_HALF_LENGTH + 1):
        offset = rest - shift
        term = wide[whole + (KERNEL_HALF_LENGTH + shift)] * np.exp(-(offset**2) / (2 * KERNEL_VARIANCE)) / offset
        total += term if shift % 2 == 0 else -term
    return np.where(on, wide[whole + KERNEL_HALF_LENGTH], np.sin(np.pi * rest) / np.pi * total)


def _chunks(count: int) -> Iterator[slice]:
    yield from (slice(begin, begin + VALUES_PER_CHUNK) for begin in range(0, count, VALUES_PER_CHUNK))

"""The angle between the pulses of an encoder, from all of them around it.

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

HALF_LENGTH = 40
"""Pulses on either side that a value between pulses rests on."""
SPREAD = HALF_LENGTH / (np.pi * (1 - 5 / 6))
"""Square of the width of the Gaussian: orders up to 5/6 of half the pulses are kept, their images are not."""
COURSE = 8
"""Points in a turn through which the mean rotation runs; orders up to half of that are in it."""
DEGREE = 7
SETTLED, SHRINKS = 1e-10, 0.97
CHUNK = 2**15


class Rotation:
    """Rotation in steps of the encoder over time, through all its pulses.

    Parameters
    ----------
    times : (n,) array
        Time of every pulse kept, s.
    numbers : (n,) int array
        Steps since the first one; where some are left out, they are filled in first.
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
        every = max(2, round(steps_per_revolution / COURSE))
        points = np.unique(np.concatenate([np.arange(0, len(whole), every), [len(whole) - 1]]))
        self.course = _spline(stamps[points], whole[points])
        places = self.course(stamps)
        self.beyond: FloatArray = _solved(places, whole - places, stamps)

    def at(self, times: FloatArray) -> FloatArray:
        """Steps since the first pulse, at times between the first and the last one."""
        places = np.asarray(self.course(times), dtype=float)
        return places + _between(self.beyond, places)


def _spline(x: FloatArray, y: FloatArray):  # type: ignore[no-untyped-def]  # noqa: ANN202
    from scipy.interpolate import make_interp_spline

    degree = min(DEGREE, len(x) - 1)
    return make_interp_spline(x, y, k=degree - (degree % 2 == 0 and degree > 1))


def _solved(places: FloatArray, values: FloatArray, times: FloatArray) -> FloatArray:
    """What a motion is at whole numbers, of which values at places beside them are known."""
    found, before = values.copy(), np.inf
    while True:
        left = values - _between(found, places)
        found += left
        worst = int(np.abs(left).argmax())
        size = float(np.abs(left[worst]))
        if size < SETTLED:
            return found
        if size > SHRINKS * before:
            raise SolveError(
                f"the speed changes too fast around {times[worst]:.6g} s for the angle between pulses to be found"
            )
        before = size


def _between(values: FloatArray, places: FloatArray) -> FloatArray:
    """Values at places between whole numbers; beyond its ends a motion is turned about them."""
    wide = np.pad(values, HALF_LENGTH, mode="reflect", reflect_type="odd")
    result = np.empty(len(places))
    for part in _chunks(len(places)):
        result[part] = _sum(wide, places[part])
    return result


def _sum(wide: FloatArray, places: FloatArray) -> FloatArray:
    whole = np.clip(np.rint(places).astype(np.intp), 0, len(wide) - 2 * HALF_LENGTH - 1)
    rest = places - whole
    on = np.abs(rest) < SETTLED
    rest = np.where(on, 0.5, rest)
    total = np.zeros(len(places))
    for shift in range(-HALF_LENGTH, HALF_LENGTH + 1):
        apart = rest - shift
        term = wide[whole + (HALF_LENGTH + shift)] * np.exp(-(apart**2) / (2 * SPREAD)) / apart
        total += term if shift % 2 == 0 else -term
    return np.where(on, wide[whole + HALF_LENGTH], np.sin(np.pi * rest) / np.pi * total)


def _chunks(count: int) -> Iterator[slice]:
    yield from (slice(begin, begin + CHUNK) for begin in range(0, count, CHUNK))

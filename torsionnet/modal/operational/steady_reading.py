"""Peak and half-power width of a resonance curve, as they are read from steady responses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.modal.spectral_lines import FloatArray


@dataclass(frozen=True)
class SteadyReading:
    """Peak of a resonance curve, its frequency in Hz, and the damping ratio that half power gives (NaN: no such)."""

    frequency: float
    peak: float
    damping_ratio: float


def steady_reading(frequencies: FloatArray, amplitude: FloatArray) -> SteadyReading:
    """Peak, its frequency in Hz, and the damping ratio from the half-power width of a resonance curve, (n,) arrays.

    Of a swept response these are wrong: late, low and wide.

    Examples
    --------
    >>> f = np.linspace(15, 25, 20001)
    >>> read = steady_reading(f, 1 / np.abs(1 - (f / 20) ** 2 + 2j * 0.02 * f / 20))
    >>> print(read.frequency, round(read.peak, 3), round(read.damping_ratio, 4))
    19.992 25.005 0.02
    """
    rising = np.argsort(frequencies, kind="stable")
    f, size = frequencies[rising], amplitude[rising]
    top = int(size.argmax())
    level = size[top] / np.sqrt(2)
    below, above = np.flatnonzero(size[:top] < level), np.flatnonzero(size[top:] < level)
    if not len(below) or not len(above):
        return SteadyReading(float(f[top]), float(size[top]), float("nan"))
    low = np.interp(level, size[[below[-1], below[-1] + 1]], f[[below[-1], below[-1] + 1]])
    last = top + above[0]
    high = np.interp(level, size[[last, last - 1]], f[[last, last - 1]])
    return SteadyReading(float(f[top]), float(size[top]), float((high - low) / (2 * f[top])))

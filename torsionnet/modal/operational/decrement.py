"""Logarithmic decrement of a free decay by regression over its cycles, and how it depends on amplitude."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.number_text import screen_text
from torsionnet.modal.operational.operational_modes import NORMAL_95
from torsionnet.modal.spectral_lines import FloatArray

CYCLES_OVER_NOISE = 4.0
"""Amplitude over its standard error down to which the regression takes it: smaller ones are lifted by noise."""
ROUNDING = 1e-9
"""Amplitude over the largest below which it is rounding."""
FEWEST_AMPLITUDES, FEWEST_SAMPLES = 4, 4
"""Cycles below which a regression says nothing on how the decrement changes, and samples that a cycle needs."""
CLEAR_CHANGE, LEAST_CHANGE = 3.0, 0.1
"""Change of the decrement over its standard error, and over the decrement, from which it depends on amplitude."""


@dataclass(frozen=True, eq=False)
class Decrement:
    """Logarithmic decrement of one mode per cycle, from a regression of the logarithms of its amplitudes.

    Attributes
    ----------
    times, amplitudes : (n,) arrays
        Middle of each cycle, s, and the amplitude there, SI.
    decrement, half_width : float
        Logarithm of the ratio of successive amplitudes, per cycle, with its 95 % interval.
    at_large, at_small : float
        Decrement at the largest and at the smallest amplitude, of a parabola through the logarithms.
    change_error : float
        Standard error of their difference.
    """

    times: FloatArray
    amplitudes: FloatArray
    decrement: float
    half_width: float
    at_large: float
    at_small: float
    change_error: float

    @property
    def damping_ratio(self) -> float:
        """Damping ratio that a logarithmic decrement gives."""
        return _ratio(self.decrement)

    @property
    def depends_on_amplitude(self) -> bool:
        """Whether the decrement changes clearly while the amplitude falls."""
        change = abs(self.at_small - self.at_large)
        return change > CLEAR_CHANGE * self.change_error and change > LEAST_CHANGE * self.decrement

    @property
    def words(self) -> str:
        """Decrement in words, such as ``logarithmic decrement 0.126 +- 0.001 over 30 cycles``."""
        text = f"logarithmic decrement {screen_text(self.decrement, 3)} +- {screen_text(self.half_width, 2)} over "
        return f"{text}{len(self.times)} cycles, damping ratio {screen_text(self.damping_ratio, 3)}"

    def change(self, unit: str) -> str:
        """Damping ratios at the largest and at the smallest amplitude, in words."""
        return (
            f"{screen_text(_ratio(self.at_large), 3)} at {screen_text(float(self.amplitudes[0]), 3)} {unit}, "
            f"{screen_text(_ratio(self.at_small), 3)} at {screen_text(float(self.amplitudes[-1]), 3)} {unit}"
        )


def _ratio(decrement: float) -> float:
    return float(decrement / np.hypot(2 * np.pi, decrement))


def logarithmic_decrement(times: FloatArray, values: FloatArray, pole: complex, noise: float) -> Decrement | None:
    """Logarithmic decrement of one decaying vibration per cycle, None where its cycles are too few.

    The amplitude of each cycle is that of the damped vibration which fits it best: less noisy than its extremes.

    Parameters
    ----------
    times, values : (n,) arrays
        s, and the vibration about zero.
    pole : complex
        Its pole in rad/s, which gives the length of a cycle.
    noise : float
        RMS of the noise.
    """
    middle, size, error = _cycle_amplitudes(times, values, pole, noise)
    low = np.flatnonzero(size < np.maximum(CYCLES_OVER_NOISE * error, ROUNDING * size.max()) if len(size) else size)
    middle, size = (middle[: low[0]], size[: low[0]]) if len(low) else (middle, size)
    if len(size) < FEWEST_AMPLITUDES:
        return None
    cycles = (middle - middle[0]) * pole.imag / (2 * np.pi)
    weights = size / size.max()  # an error of an amplitude is one of its logarithm over its size
    line, covariance = _regression(cycles, np.log(size), weights, 1)
    bow, spread = _regression(cycles, np.log(size), weights, 2)
    return Decrement(
        middle, size, float(-line[1]), float(NORMAL_95 * np.sqrt(covariance[1, 1])), float(-bow[1]),
        float(-bow[1] - 2 * bow[2] * cycles[-1]), float(2 * cycles[-1] * np.sqrt(spread[2, 2])),
    )  # fmt: skip


def _cycle_amplitudes(
    times: FloatArray, values: FloatArray, pole: complex, noise: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Middles in s, amplitudes there, and their standard errors, of each whole cycle, (n_cycles,)."""
    period = 2 * np.pi / pole.imag
    edges = times[0] + period * np.arange(int((times[-1] - times[0]) / period) + 1)
    found = []
    for begin in edges[:-1]:
        first, last = np.searchsorted(times, [begin, begin + period])
        if last - first < FEWEST_SAMPLES:
            continue
        wave = np.exp(pole * (times[first:last] - begin - period / 2))
        parts = np.linalg.lstsq(np.stack([wave.real, -wave.imag], axis=1), values[first:last], rcond=None)[0]
        found.append((begin + period / 2, float(np.hypot(*parts)), noise * np.sqrt(2 / (last - first))))
    middle, size, error = np.array(found).reshape(-1, 3).T
    return middle, size, error


def _regression(x: FloatArray, y: FloatArray, weights: FloatArray, degree: int) -> tuple[FloatArray, FloatArray]:
    """Coefficients of a polynomial, lowest power first, and their covariance."""
    columns = np.vander(x, degree + 1, increasing=True) * weights[:, None]
    found = np.linalg.lstsq(columns, y * weights, rcond=None)[0]
    left = y * weights - columns @ found
    variance = float(left @ left) / max(len(x) - degree - 1, 1)
    return np.asarray(found), np.asarray(np.linalg.inv(columns.T @ columns) * variance)

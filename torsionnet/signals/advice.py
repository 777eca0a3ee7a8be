"""Warnings about unreliable peaks of an estimated response, and the frequency up to which a sensor resolves motion."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError, comma_list
from torsionnet.base.notes import Note, warning
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.signals.recording import FloatArray

LEAST_BINS = 3
"""Number of bins that the half-power bandwidth of a peak must span, as the window widens a narrower peak."""
LEAST_COHERENCE = 0.8
"""Coherence at a peak below which a warning is given, and of a line below which test and model are not compared, as
noise is too large."""
COHERENT_SHARE = 0.5
"""Share of an output's power due to the inputs below which the output is taken for noise, being less than half."""
PEAK_PROMINENCE = 3.0
"""Height in dB by which a peak must stand out from its surroundings to be examined, more than noise makes."""
PEAK_RANGE = 20.0
"""Range in dB below the highest peak in which peaks are examined, as lower ones matter little."""
MOST_LISTED_PEAKS = 5
"""Number of peaks that a warning lists at most, so that it stays short."""


def significant_peaks(magnitude: FloatArray) -> list[int]:
    """Indices of the peaks of a magnitude that stand out by 3 dB and are at most 20 dB below the highest."""
    from scipy.signal import find_peaks

    if not magnitude.size:
        return []
    with np.errstate(divide="ignore", invalid="ignore"):
        level = 20 * np.log10(np.nan_to_num(magnitude))
    level = np.maximum(level, level.max() - 200)
    found, _ = find_peaks(level, height=level.max() - PEAK_RANGE, prominence=PEAK_PROMINENCE)
    return [int(place) for place in found]


def is_coherent(response: FrequencyResponse, output: int, least: float = LEAST_COHERENCE) -> NDArray[np.bool_]:
    """Mask (n_f,) of the lines where the coherences of an output with all inputs add up to at least ``least``."""
    if response.coherence is None:
        return np.zeros(len(response.frequencies), dtype=bool)
    return np.asarray(response.coherence[:, output].sum(axis=1) >= least)


def above_noise_up_to(response: FrequencyResponse, output: int) -> float:
    """Frequency in Hz up to which an output is more than noise, as the response states or by the last coherent line.

    Infinite if neither is known, or no line is coherent.
    """
    if response.usable_up_to is not None:
        return response.usable_up_to
    lines = response.frequencies[is_coherent(response, output, COHERENT_SHARE)]
    return float(lines.max()) if lines.size else np.inf


def half_power_bandwidth(frequencies: FloatArray, magnitude: FloatArray, peak: int) -> float:
    """Width in Hz of a peak where its magnitude has fallen by 3 dB; NaN if it does not fall so far on both sides.

    >>> frequencies = np.linspace(9, 11, 2001)
    >>> magnitude = 1 / abs(1 - (frequencies / 10) ** 2 + 2j * 0.01 * frequencies / 10)
    >>> round(half_power_bandwidth(frequencies, magnitude, int(magnitude.argmax())), 3)
    0.2
    """
    level = magnitude[peak] / np.sqrt(2)
    below = np.flatnonzero(magnitude < level)
    left, right = below[below < peak], below[below > peak]
    if not len(left) or not len(right):
        return float("nan")
    edges = [
        np.interp(level, magnitude[[low, high]], frequencies[[low, high]])
        for low, high in ((left[-1], left[-1] + 1), (right[0], right[0] - 1))
    ]
    return float(edges[1] - edges[0])


def peak_warnings(response: FrequencyResponse, bin_width: float, *, judge_coherence: bool = True) -> tuple[Note, ...]:
    """Warnings about the peaks of a response estimated with bins that are ``bin_width`` Hz wide, one sentence each.

    A peak narrower than three bins is widened by the window, which reads as too much damping. With several
    inputs, ordinary coherence is low for reasons other than noise: set ``judge_coherence`` to False. Peaks above the
    frequency up to which the response can be used or is more than noise are ignored.
    """
    found: list[Note] = []
    for o, output in enumerate(response.outputs):
        meant = response.between(0, above_noise_up_to(response, o))
        for i, into in enumerate(response.inputs):
            coherence = meant.coherence[:, o, i] if meant.coherence is not None and judge_coherence else None
            magnitude = meant.magnitude[:, o, i]
            found += (
                warning(f"{output.name}/{into.name} {text}")
                for text in _peak_remarks(meant.frequencies, magnitude, coherence, bin_width)
            )
    return tuple(found)


def _peak_remarks(
    frequencies: FloatArray, magnitude: FloatArray, coherence: FloatArray | None, bin_width: float
) -> Iterator[str]:
    narrow, incoherent = [], []
    for peak in significant_peaks(magnitude):
        width = half_power_bandwidth(frequencies, magnitude, peak)
        if coherence is not None and coherence[peak] < LEAST_COHERENCE:
            incoherent.append(f"{frequencies[peak]:g} Hz ({coherence[peak]:.2f})")
        elif width < LEAST_BINS * bin_width:
            narrow.append(f"{frequencies[peak]:g} Hz ({width:.3g} Hz)")
    if narrow:
        yield (
            f"half-power bandwidth under {LEAST_BINS} bins of {bin_width:g} Hz at "
            f"{comma_list(narrow, MOST_LISTED_PEAKS)}: the height reads low and the damping high; use longer segments"
        )
    if incoherent:
        yield f"coherence under {LEAST_COHERENCE:g} at the peak at {comma_list(incoherent, MOST_LISTED_PEAKS)}"


def resolution_limit(frequencies: FloatArray, amplitude: FloatArray, step: float, steps: float = 4.0) -> float:
    """Frequency in Hz up to which an angle's amplitude is at least ``steps`` steps of the encoder.

    Parameters
    ----------
    frequencies : (n_f,) array
        Hz, increasing.
    amplitude : (n_f,) array
        Peak amplitude of the angle, rad.
    step : float
        Resolution, rad: a turn by lines per turn, and by four in quadrature.
    steps : float, optional
        At four the quantiser's error is a few percent; at half a step the response is lost.

    Returns
    -------
    float
        Where the amplitude first falls below that many steps; the last frequency if it never does, 0 if it is never
        as large.

    Examples
    --------
    >>> frequencies = np.linspace(1, 50, 50)
    >>> round(resolution_limit(frequencies, 1 / frequencies**2, step=2 * np.pi / 4096), 1)
    12.8
    """
    if not step > 0:
        raise UsageError(f"an encoder's step must be a positive angle, got {step}")
    level = step * steps
    enough = amplitude >= level
    if not enough.any():
        return 0.0
    lost = np.flatnonzero(~enough & np.maximum.accumulate(enough))
    if not len(lost):
        return float(frequencies[-1])
    around = [lost[0], lost[0] - 1]
    return float(np.interp(level, amplitude[around], frequencies[around]))

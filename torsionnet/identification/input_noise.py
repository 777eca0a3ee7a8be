"""Noise of the sensor on the input, by what a prediction from the measured input carries of it.

Where the excitation is elsewhere, the measured input is all but its own noise, and so is what a model predicts from it:
their product has the power of that noise as its mean, over windows and lines by the thousand. The lines that a fit
compares are few in which this noise weighs as much as that of the output, and the fit has bent itself to them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import uniform_filter

from torsionnet.assembly.rows import ComplexArray
from torsionnet.identification.operator import WindowedEstimate

WINDOW = "blackmanharris"
"""Side lobes of 92 dB, so that a sweep elsewhere does not cover noise."""
WINDOWS_PER_LENGTH = 4
AROUND = 15
"""Windows and lines over which the power of the input is smoothed: a weight made of a cell's own noise would favour
cells that happen to have little."""


def noise_of_input(windowed: WindowedEstimate, G: ComplexArray, output_noise: float) -> tuple[float, float] | None:
    """Power of white noise on the input (variance of its samples), and standard error of that.

    Parameters
    ----------
    windowed : WindowedEstimate
    G : (n_f,) complex array
        Of the model.
    output_noise : float
        The same of the output, for the weights.

    Returns
    -------
    tuple of float or None
        None where the record has too few windows, or the output no noise.
    """
    own = windowed.rows.segments
    settings = replace(own.settings, window=WINDOW, overlap=1 - 1 / WINDOWS_PER_LENGTH)
    segments = replace(own, settings=settings)
    rest, _ = windowed.apart(G)
    left, into = segments.lines(rest), segments.lines(windowed.input_from_rest)
    if len(left) < AROUND or not output_noise:
        return None
    at = windowed.frequencies
    gain = np.interp(at, windowed.fine, G.real) + 1j * np.interp(at, windowed.fine, G.imag)
    unit = (np.abs(segments.pieces()) ** 2).sum(axis=1)
    moment, squared = -(left * (into * gain).conj()).real / unit, np.abs(gain) ** 2
    power = uniform_filter(np.abs(into) ** 2 / unit, AROUND)
    on_output, level, total = 1.0, 0.0, 0.0
    for _ in range(2):
        weights = 1 / (power * (on_output + level * squared))
        total = float((weights * squared).sum())
        level = max(float((weights * moment).sum()) / total, 0.0)
        on_output = output_noise
    # Of a complex product the real part has half the variance, and overlapping windows repeat what they share.
    return level, float(np.sqrt(WINDOWS_PER_LENGTH / 2 / total))

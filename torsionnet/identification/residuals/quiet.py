"""What sensors show in windows in which the excitation is elsewhere.

There the measured input is all but its own noise, and so is what a model predicts from it: their product has the power
of that noise as its mean, over windows and lines by the thousand. The lines that a fit compares are few in which this
noise weighs as much as that of the output, and the fit has bent itself to them. What a wrong model leaves follows the
excitation, and that is elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.identification.residuals.operator import WindowedEstimate

WINDOW = "blackmanharris"
"""Side lobes of 92 dB, so that a sweep elsewhere does not cover noise."""
PER_LENGTH = 4
"""Windows begun while one lasts."""
NEAR = 5
"""Windows and lines over which the power of the input says whether it is excited there."""
QUIET = 0.03
"""Share of the highest power of a line below which windows are not."""
LEAST_QUIET = 0.3
"""Share of windows that are, below which it is by chance, as lines of a stationary input come and go."""
FEWEST = 100
"""Values that a mean is worth taking of."""
FEWEST_WINDOWS = 2
"""Windows apart from each other that a median is worth taking of."""
AROUND = 15
"""Windows and lines over which the power of the input is smoothed: a weight made of a cell's own noise would favour
cells that happen to have little."""


@dataclass(frozen=True, eq=False)
class QuietWindows:
    """Windows (n_s) and lines (n_b) of a record, those marked that are not excited.

    Attributes
    ----------
    quiet : (n_s, n_b) bool array
    moment : (n_s, n_b) array
        Of what a model leaves and what it predicts, as variance of white noise of the input times ``squared``.
    power : (n_s, n_b) array
        Of the input, as variance of white noise that would have it; smoothed.
    left : (n_s, n_b) array
        The same of what the model leaves of the output.
    squared : (n_b,) array
        Squared magnitude of the response.
    """

    quiet: NDArray[np.bool_]
    moment: FloatArray
    power: FloatArray
    left: FloatArray
    squared: FloatArray

    def input_noise(self, output_noise: float) -> tuple[float, float] | None:
        """Power of white noise on the input (variance of its samples), and standard error of that.

        None where too few windows are free of excitation. The noise of the output is needed for the weights.
        """
        if np.count_nonzero(self.quiet) < FEWEST * PER_LENGTH:
            return None
        on_output, level, total = 1.0, 0.0, 0.0
        for _ in range(2):
            weights = self.quiet / (self.power * (on_output + level * self.squared))
            total = float((weights * self.squared).sum())
            level = max(float((weights * self.moment).sum()) / total, 0.0)
            on_output = output_noise
        # Of a complex product the real part has half the variance, and overlapping windows repeat what they share.
        return level, float(np.sqrt(PER_LENGTH / 2 / total))

    def floor(self) -> FloatArray:
        """Power of white noise that half of the quiet windows stay below, (n_b,), infinite where there are too few.

        Not the mean: what rings on after the sweep, and a wrong model has not, is in some windows only.
        """
        found = np.full(self.quiet.shape[1], np.inf)
        for line in np.flatnonzero(self.quiet.sum(axis=0) >= FEWEST_WINDOWS * PER_LENGTH):
            found[line] = np.median(self.left[self.quiet[:, line], line]) / np.log(2)
        return found


def quiet_windows(windowed: WindowedEstimate, G: ComplexArray) -> QuietWindows:
    """Of a record, against what a transfer function (n_f,) predicts."""
    own = windowed.rows.segments
    segments = replace(own, settings=replace(own.settings, window=WINDOW, overlap=1 - 1 / PER_LENGTH))
    rest, _ = windowed.apart(G)
    left, into = segments.lines(rest), segments.lines(windowed.input_from_rest)
    at = windowed.frequencies
    gain = np.interp(at, windowed.fine, G.real) + 1j * np.interp(at, windowed.fine, G.imag)
    unit = (np.abs(segments.pieces()) ** 2).sum(axis=1)
    power, moment = np.abs(into) ** 2 / unit, -(left * (into * gain).conj()).real / unit
    near = uniform_filter(power, NEAR)
    quiet = near < QUIET * near.max(axis=0)
    quiet &= quiet.mean(axis=0) > LEAST_QUIET
    smooth = uniform_filter(power, AROUND)
    return QuietWindows(quiet, moment, smooth, np.abs(left) ** 2 / unit, np.abs(gain) ** 2)

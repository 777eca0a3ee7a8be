"""Errors of a measured response by the steps (resolution) of the output's sensor.

The motion that a model predicts is rounded to steps as by the sensor, from several rest positions within a step. The
position is unknown, but the same for a whole test of a rig that is held: its errors are common to all lines, and no
averaging reduces them. A sine of A steps comes out up to 0.2 / A^1.5 too large or too small.

Noise of a record's input sensor, from windows in which a line is not excited. There the measured input is almost only
noise, and so is the output that a model predicts from it: the mean of their product over thousands of windows and lines
is the power of that noise. Among the lines that a fit compares, few have an input noise as large as that of the output,
and the fit has adapted to them. The error of a wrong model follows the excitation, which is absent from these windows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.identification.residuals.windowed_estimate import SegmentRows, WindowedEstimate
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.signals.decimation import FILTER_HALF_LENGTH, anti_alias_taps
from torsionnet.signals.recording import Recording
from torsionnet.signals.uncertainty import step_of, sweep_amplitudes

REST_POSITIONS = 16
"""Number of rest positions within a step of a sensor for which errors are calculated, as the true one is unknown."""


@dataclass(frozen=True)
class SensorSteps:
    """Step size of a sensor in SI, and the decimation factor of its samples.

    Attributes
    ----------
    size : float
        Size of a step, SI; 0 if the sensor has none.
    decimation : int
        Samples of the sensor for each sample of the record.
    """

    size: float = 0.0
    decimation: int = 1

    def errors(self, motion: FloatArray, rows: SegmentRows) -> ComplexArray:
        """Errors (REST_POSITIONS, n_b) of an estimate's lines by the sensor's steps, for a motion (n,) in SI.

        The motion has the sampling rate of the record.
        """
        if not self.size:
            return np.zeros((REST_POSITIONS, len(rows.segments.bins)), dtype=complex)
        # Steps act before decimation; where in a step the rest lies is open, so places are tried evenly.
        fine = _finer(motion, self.decimation)
        places = (np.arange(REST_POSITIONS) + 0.5) / REST_POSITIONS * self.size
        return np.array([rows.apply(self._error(fine + place, len(motion))) for place in places])

    def _error(self, motion: FloatArray, count: int) -> FloatArray:
        error = self.size * np.rint(motion / self.size) - motion
        if self.decimation == 1:
            return error
        # Through the filter of the decimation, as the record went.
        return scipy.signal.upfirdn(anti_alias_taps(self.decimation), error, 1, self.decimation)[
            FILTER_HALF_LENGTH : FILTER_HALF_LENGTH + count
        ]


def find_sensor_steps(record: Recording, output: str, input: str, decimation: int) -> SensorSteps:
    """Steps of the output's sensor before decimation, of size 0 where the input is not a swept sine.

    Under other inputs, and in rigs that turn, readings fall on all positions within a step: errors are noise.
    """
    is_swept = len(sweep_amplitudes(record, output, input)[0]) > 1
    return SensorSteps(step_of(record[output].values) if is_swept else 0.0, decimation)


def _finer(motion: FloatArray, factor: int) -> FloatArray:
    """Motion of a sensor at ``factor`` times the sampling rate, (n * factor,), interpolated without new frequencies."""
    if factor == 1:
        return motion
    count = 2 * len(motion)
    return np.asarray(np.fft.irfft(factor * np.fft.rfft(motion, count), factor * count)[: factor * len(motion)])


# Noise of a record's input sensor, from windows in which a line is not excited.

NOISE_WINDOW = "blackmanharris"
"""Window for the search of noise, with side lobes of -92 dB, so that a sweep at other lines does not cover the
noise."""
WINDOWS_PER_LENGTH = 4
"""Number of windows that start within the length of one window in the search of noise (overlap of 3/4)."""
EXCITATION_CELLS = 5
"""Number of windows and of lines over which the power of the input is averaged to decide whether a line is excited."""
UNEXCITED_POWER_SHARE = 0.03
"""Share of a line's highest input power over all windows below which a window does not excite the line."""
LEAST_UNEXCITED_WINDOWS = 0.3
"""Least share of unexcited windows of a line, as fewer are chance, because lines of a stationary input come and go."""
FEWEST_VALUES = 100
"""Fewest independent values in unexcited windows whose mean gives the noise power of the input, as few scatter
widely."""
FEWEST_WINDOWS = 2
"""Fewest separate unexcited windows of a line whose median gives the noise of the output there, as one alone may hold
ringing."""
SMOOTHING_CELLS = 15
"""Number of windows and of lines over which the power of the input is smoothed for weights, as weights from the noise
of a single cell would favour cells that have little by chance."""


@dataclass(frozen=True, eq=False)
class UnexcitedWindows:
    """Powers of a record's input and residual by window (n_s) and line (n_b), with a mask of what is not excited.

    Attributes
    ----------
    unexcited : (n_s, n_b) bool array
        Whether a line is not excited in a window.
    moment : (n_s, n_b) array
        Product of the residual and the prediction of the model, as variance of white input noise times ``squared``.
    power : (n_s, n_b) array
        Power of the input as the variance of white noise with that power; smoothed.
    left : (n_s, n_b) array
        Power of the residual of the output as the variance of white noise.
    squared : (n_b,) array
        Squared magnitude of the response.
    """

    unexcited: NDArray[np.bool_]
    moment: FloatArray
    power: FloatArray
    left: FloatArray
    squared: FloatArray

    def input_noise(self, output_noise: float) -> tuple[float, float] | None:
        """Noise power of the input sensor (variance of its samples) and its standard error.

        None where too few windows are free of excitation. The noise power of the output is needed for the weights.
        """
        if np.count_nonzero(self.unexcited) < FEWEST_VALUES * WINDOWS_PER_LENGTH:
            return None
        on_output, level, total = 1.0, 0.0, 0.0
        for _ in range(2):
            # Least squares of moment = P_in |G|^2, by weights that hold P_in themselves, hence twice.
            weights = self.unexcited / (self.power * (on_output + level * self.squared))
            total = float((weights * self.squared).sum())
            level = max(float((weights * self.moment).sum()) / total, 0.0)
            on_output = output_noise
        # Of a complex product the real part has half the variance, and overlapping windows repeat what they share.
        return level, float(np.sqrt(WINDOWS_PER_LENGTH / 2 / total))

    def floor(self) -> FloatArray:
        """Noise power of the output at each line, (n_b,), the median over unexcited windows; infinite with too few.

        Not the mean: ringing after the sweep, which a wrong model lacks, is in some windows only.
        """
        floor = np.full(self.unexcited.shape[1], np.inf)
        for line in np.flatnonzero(self.unexcited.sum(axis=0) >= FEWEST_WINDOWS * WINDOWS_PER_LENGTH):
            floor[line] = np.median(self.left[self.unexcited[:, line], line]) / np.log(2)
        return floor


def unexcited_windows(windowed: WindowedEstimate, G: ComplexArray) -> UnexcitedWindows:
    """Windows of a record in which lines are not excited, with the residuals of a transfer function G (n_f,)."""
    own = windowed.rows.segments
    segments = replace(own, settings=replace(own.settings, window=NOISE_WINDOW, overlap=1 - 1 / WINDOWS_PER_LENGTH))
    rest, _ = windowed.residual_and_prediction(G)
    left, into = segments.lines(rest), segments.lines(windowed.input_from_rest)
    at = windowed.frequencies
    gain = np.interp(at, windowed.fine, G.real) + 1j * np.interp(at, windowed.fine, G.imag)
    unit = (np.abs(segments.pieces()) ** 2).sum(axis=1)
    # In Y - G X noise N of the input's sensor is -G N, which correlates with G times the input read.
    power, moment = np.abs(into) ** 2 / unit, -(left * (into * gain).conj()).real / unit
    near = scipy.ndimage.uniform_filter(power, EXCITATION_CELLS)
    unexcited = near < UNEXCITED_POWER_SHARE * near.max(axis=0)
    unexcited &= unexcited.mean(axis=0) > LEAST_UNEXCITED_WINDOWS
    smooth = scipy.ndimage.uniform_filter(power, SMOOTHING_CELLS)
    return UnexcitedWindows(unexcited, moment, smooth, np.abs(left) ** 2 / unit, np.abs(gain) ** 2)

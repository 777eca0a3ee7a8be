"""Errors of a measured response by the steps (resolution) of the output's sensor.

The motion that a model predicts is rounded to steps as by the sensor, from several rest positions within a step. The
position is unknown, but the same for a whole test of a rig that is held: its errors are common to all lines, and no
averaging reduces them. A sine of A steps comes out up to 0.2 / A^1.5 too large or too small.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from torsionnet.identification.residuals.segments import SegmentRows
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.signals.decimation import FILTER_HALF_LENGTH, anti_alias_taps
from torsionnet.signals.recording import Recording
from torsionnet.signals.sensor_resolution import step_of, sweep_amplitudes

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
        fine = _finer(motion, self.decimation)
        places = (np.arange(REST_POSITIONS) + 0.5) / REST_POSITIONS * self.size
        return np.array([rows.apply(self._error(fine + place, len(motion))) for place in places])

    def _error(self, motion: FloatArray, count: int) -> FloatArray:
        error = self.size * np.rint(motion / self.size) - motion
        if self.decimation == 1:
            return error
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

"""What the steps of a sensor do to a measured response, beyond noise.

The motion that a model predicts is read in steps as the sensor does, from several places of rest within a step. Nobody
knows the place, but it is one for a whole test of a rig that is held: the errors go with it from line to line, and no
averaging reduces them. A sine of A steps comes out up to 0.2 / A^1.5 too large or too small.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import upfirdn

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.identification.residuals.segments import SegmentRows
from torsionnet.response.recording import Recording
from torsionnet.signals.decimation import HALF_LENGTH, anti_alias_taps
from torsionnet.signals.resolution import step_of, swept

PLACES = 16


@dataclass(frozen=True)
class SensorSteps:
    """How a sensor reads.

    Attributes
    ----------
    size : float
        Of a step, SI; 0 if it has none.
    decimation : int
        Samples taken by the sensor for one of the record.
    """

    size: float = 0.0
    decimation: int = 1

    def errors(self, motion: FloatArray, rows: SegmentRows) -> ComplexArray:
        """What they do to a response (places, n_b) = rows @ output, n_b of them, with a motion (n,) at its rate."""
        if not self.size:
            return np.zeros((PLACES, len(rows.segments.bins)), dtype=complex)
        fine = _finer(motion, self.decimation)
        places = (np.arange(PLACES) + 0.5) / PLACES * self.size
        return np.array([rows.apply(self._error(fine + place, len(motion))) for place in places])

    def _error(self, motion: FloatArray, count: int) -> FloatArray:
        error = self.size * np.rint(motion / self.size) - motion
        if self.decimation == 1:
            return error
        return upfirdn(anti_alias_taps(self.decimation), error, 1, self.decimation)[HALF_LENGTH : HALF_LENGTH + count]


def steps_in(record: Recording, output: str, input: str, decimation: int) -> SensorSteps:
    """Those of a sensor, before decimation; none where the input is no sine that is swept.

    Under other inputs, and in rigs that turn, a reading falls on all places of a step: its errors are noise.
    """
    is_swept = len(swept(record, output, input)[0]) > 1
    return SensorSteps(step_of(record[output].values) if is_swept else 0.0, decimation)


def _finer(motion: FloatArray, factor: int) -> FloatArray:
    """The same with so many samples for one, without what is above the half rate; zeros follow after it."""
    if factor == 1:
        return motion
    count = 2 * len(motion)
    return np.asarray(np.fft.irfft(factor * np.fft.rfft(motion, count), factor * count)[: factor * len(motion)])

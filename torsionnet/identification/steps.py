"""What the steps of a sensor do to a measured response, beyond noise.

A sine of A steps whose middle lies o steps from the middle of a step comes out larger by the relative gain

    sum over k of 2 (-1)^k J_1(2 pi k A) / (pi k A) cos(2 pi k o),

the describing function of a quantiser: about 0.2 / A^1.5. Nobody knows o, but it is one number for a whole test of a
rig that is held: all lines share it, and no averaging reduces what it does.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import hilbert
from scipy.special import j1

from torsionnet.assembly.rows import FloatArray
from torsionnet.identification.segments import SegmentRows
from torsionnet.signals.recording import Recording
from torsionnet.signals.resolution import step_of, swept

TERMS = 4
LEAST = 0.5
"""Steps of amplitude; what moves less is not described by this."""


def gain_errors(amplitude: FloatArray) -> FloatArray:
    """Relative gain errors (terms, n) of sines with amplitudes (n,) in steps; cos(2 pi k o) multiplies row k - 1.

    >>> A, o = 4.3, 0.1
    >>> sine = np.sin(2 * np.pi * np.arange(10_000) / 10_000)
    >>> exact = 2 * np.mean(np.round(A * sine + o) * sine) / A - 1
    >>> terms = gain_errors(np.array([A]))[:, 0] @ np.cos(2 * np.pi * o * np.arange(1, TERMS + 1))
    >>> abs(terms - exact) < 0.2 * abs(exact)
    np.True_
    """
    k = np.arange(1, TERMS + 1)[:, None]
    return np.asarray(2 * (-1.0) ** k * j1(2 * np.pi * k * amplitude) / (np.pi * k * amplitude))


def steps_covariance(record: Recording, output: str, input: str, coarse: Recording, rows: SegmentRows) -> FloatArray:
    """Covariance of real and imaginary parts of a response (2 n_b, 2 n_b) over all places of the steps.

    Parameters
    ----------
    record : Recording
        With the sensor's steps in it.
    output, input : str
    coarse : Recording
        The same after decimation, n samples.
    rows : SegmentRows
        Response = rows @ output, n_b of them.

    Returns
    -------
    (2 n_b, 2 n_b) array
        Zero where the sensor has no steps, or the input is no sine that is swept.
    """
    is_swept = len(swept(record, output, input)[0]) > 1
    return covariance_of_steps(step_of(record[output].values) if is_swept else 0.0, coarse, output, rows)


def covariance_of_steps(step: float, coarse: Recording, output: str, rows: SegmentRows) -> FloatArray:
    """The same where the step is known; 0 if there is none."""
    if not step:
        return np.zeros((2 * len(rows.segments.bins),) * 2)
    motion = coarse[output].values - coarse[output].values.mean()
    amplitude = np.abs(hilbert(motion)) / step
    errors = np.where(amplitude > LEAST, gain_errors(np.maximum(amplitude, LEAST)), 0.0) * motion
    lines = np.array([rows.apply(error) for error in errors])
    parts = np.concatenate([lines.real, lines.imag], axis=1)
    return np.asarray(0.5 * parts.T @ parts)

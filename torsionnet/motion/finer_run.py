"""Agreement of a motion over time with the same motion in steps half as long."""

from __future__ import annotations

import numpy as np

from torsionnet.linear.assembly.rows import FloatArray

AGREE = 1e-6
"""Share of the largest value of a reading up to which two runs agree: far below what a picture shows, far above what
steps of either length miss before a motion becomes chaotic."""


def agreement_note(values: FloatArray, finer: FloatArray, rate: float) -> str:
    """Note until when readings (n_out, n) agree with those in steps half as long, sampled at ``rate`` Hz.

    >>> agreement_note(np.array([[0.0, 1.0, 2.0]]), np.array([[0.0, 1.0, 2.1]]), 10.0)
    'in steps half as long the first 0.1 s agree to 1e-06 of the largest value, after that contacts make other choices'
    """
    apart = np.abs(values - finer)
    largest = np.abs(finer).max(axis=1, initial=0.0)[:, None]
    beyond = np.flatnonzero((apart > AGREE * largest).any(axis=0))
    if not len(beyond):
        share = float(np.max(apart / np.where(largest > 0, largest, 1.0), initial=0.0))
        return f"in steps half as long all samples agree to {max(share, 1e-15):.1g} of the largest value"
    until = max(int(beyond[0]) - 1, 0) / rate
    text = f"in steps half as long the first {until:.6g} s agree to {AGREE:g} of the largest value"
    return f"{text}, after that contacts make other choices"

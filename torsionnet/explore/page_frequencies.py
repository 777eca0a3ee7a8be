"""The frequencies of a page: enough for every peak, and none where an undamped one has no height."""

from __future__ import annotations

import numpy as np

from torsionnet.response import Modes
from torsionnet.response.frequency_response import FloatArray
from torsionnet.solve.responses.grid import Adaptive

POINTS, PER_PEAK, LEAST_PER_PEAK = 300, 41, 9
MOST_AT_PEAKS = 1600
"""Of many modes each gets fewer points: a screen has no more columns."""
UNDAMPED = 1e-7
"""Damping ratio below which a peak is as high as one cares to look closely."""
NEAREST = 2e-4
"""Share of its frequency to which an undamped peak is approached: it is drawn some thousand times its flanks."""
APPROACH = 4.0 ** np.arange(1, 5) / 2


def lines(band: tuple[float, float], *modes: Modes) -> FloatArray:
    """Frequencies in Hz for the modes of a response, ascending.

    Examples
    --------
    >>> import torsionnet as tn
    >>> f = lines((0.5, 200.0), tn.load("dmf_rig").modes())
    >>> float(f[0]), float(f[-1]), 300 < len(f) < 400
    (0.5, 200.0, True)
    """
    vibrations = sum(int(np.sum(mode.damped_frequencies > 0)) for mode in modes)
    per_peak = min(PER_PEAK, max(LEAST_PER_PEAK, MOST_AT_PEAKS // max(1, vibrations)))
    f = Adaptive(*band, points=POINTS, per_peak=per_peak).frequencies(*modes)
    for pole in undamped(*modes):
        f = f[np.abs(f - pole) > NEAREST * pole]
        f = np.union1d(f, np.outer(pole, 1 + np.outer((-1, 1), NEAREST * APPROACH)))
    return f[(f >= band[0]) & (f <= band[1])]


def undamped(*modes: Modes) -> FloatArray:
    """Frequencies in Hz of vibrations without damping; several at one frequency count once."""
    found = [
        mode.damped_frequencies[(mode.damped_frequencies > 0) & (mode.damping_ratios < UNDAMPED)] for mode in modes
    ]
    every = np.sort(np.concatenate([np.empty(0), *found]))
    return every[np.diff(every, prepend=0.0) > NEAREST * every]

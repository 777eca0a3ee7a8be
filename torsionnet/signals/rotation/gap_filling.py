"""Values of a band-limited motion at pulses that are missing, from those around them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.signals.recording import FloatArray

FILLED_BAND, FILLED_BAND_WIDTH = 2 / 3, 4 / 3
"""Largest share of half the pulses of a turn up to which orders are filled into a gap, and its product with the number
of pulses that the gap lacks: with more, noise of the pulses around grows more than fourfold in the gap."""
FILLED_NOISE = 1e-5
"""Power of noise per pulse over that of the motion with which values are filled in, so that wide gaps stay bounded."""
HALVED_BANDS = 4
"""Number of bands, each half as wide as the last, whose power is ten times as large: amplitudes of angles fall with the
order."""
NEIGHBOURS = 24
"""Number of pulses on either side of a gap from which it is filled; more change the values by less than the noise."""
WIDEST_GAP = 8
"""Most pulses in a gap that those around it tell anything about; a wider one keeps the spline through it."""
GAPS_PER_CHUNK = 2**13
"""Number of gaps that are filled together, which limits the memory."""


@dataclass(frozen=True, eq=False)
class Gaps:
    """Gaps of one width between the pulses of an encoder, with the weights of the pulses around them.

    Attributes
    ----------
    first : (n_gaps,) int array
        Number of the first missing pulse of each gap.
    around : (2 * NEIGHBOURS,) int array
        Steps from there to the pulses around it.
    weights : (width, 2 * NEIGHBOURS) array
    """

    first: NDArray[np.intp]
    around: NDArray[np.intp]
    weights: FloatArray

    def fill(self, found: FloatArray, left: FloatArray) -> None:
        """Set what is ``left`` between a motion and its values ``found`` at the missing pulses, each (n,) in its unit.

        The motion there follows from its values around each gap.
        """
        missing = np.arange(len(self.weights))
        for begin in range(0, len(self.first), GAPS_PER_CHUNK):
            first = self.first[begin : begin + GAPS_PER_CHUNK, None]
            around = first + self.around
            within = first + missing
            left[within] = (found[around] + left[around]) @ self.weights.T - found[within]


def gaps_of(numbers: NDArray[np.intp]) -> tuple[Gaps, ...]:
    """Gaps between the numbers of an encoder's pulses by width, those too wide or too near the ends left out."""
    widths = np.diff(numbers) - 1
    found = []
    for width in (int(one) for one in np.unique(widths[widths > 0]) if one <= WIDEST_GAP):
        first = numbers[:-1][widths == width] + 1
        first = first[(first >= NEIGHBOURS) & (first + width + NEIGHBOURS <= numbers[-1] + 1)]
        around = np.r_[np.arange(-NEIGHBOURS, 0), np.arange(width, width + NEIGHBOURS)]
        found.append(Gaps(first, around, _weights(width, around)))
    return tuple(found)


def filled_band(width: int) -> float:
    """Share of half the pulses of a turn up to which orders are filled into a gap of so many missing pulses."""
    return min(FILLED_BAND, FILLED_BAND_WIDTH / width) if width else 1.0


def _weights(width: int, places: NDArray[np.intp]) -> FloatArray:
    """Weights (width, n) of the values at ``places`` for those from 0 to ``width``, of the least mean square error.

    The motion is taken to have the same power at all orders up to the band filled, and ten times as much in each half
    of a band (N. Wiener, Extrapolation, Interpolation and Smoothing of Stationary Time Series, 1949).
    """
    own = _covariance(places[:, None] - places, filled_band(width)) + FILLED_NOISE * np.eye(len(places))
    across = _covariance(np.arange(width)[:, None] - places, filled_band(width))
    return np.asarray(np.linalg.solve(own, across.T).T)


def _covariance(distances: NDArray[np.intp], band: float) -> FloatArray:
    """Covariance of a motion at pulses so many steps apart, over its power at orders in the upper half of the band."""
    halves = 2.0 ** np.arange(HALVED_BANDS)
    return np.asarray(sum(10 ** np.log2(n) * np.sinc(band / n * distances) for n in halves))

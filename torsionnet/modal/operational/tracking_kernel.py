"""Weights with which an order tracking takes the mean of the amplitude over time, as far as its notes say."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.core.errors import UsageError
from torsionnet.modal.spectral_lines import FloatArray

_FILTER = re.compile(r"Vold-Kalman filter of (\d) poles, bandwidth ([\d.e+-]+) (Hz|% of the order's frequency)")
_BLOCKS = re.compile(r"average over blocks of (\d+) cycles of (\d+) turns")
VOLD_KALMAN_POLES = 2
"""Poles of a Vold-Kalman filter of which only the bandwidth is given."""
REACH = 3.0
"""Reach of a Vold-Kalman filter over its inverse bandwidth: the weights further out are under 0.1 % of the largest."""
INDEPENDENT = 0.6
"""Distance of values over the inverse bandwidth from which their noise is nearly independent."""
FINEST, HIGHEST = 2000, 40.0
"""Points and end of the frequencies over bandwidth by which the weights of a filter are calculated."""


@dataclass(frozen=True)
class TrackingKernel:
    """Weights of an order tracking: a Vold-Kalman filter of a bandwidth, or blocks of revolutions; else none known.

    Attributes
    ----------
    bandwidth : float
        Width between the -3 dB points, Hz, 0 where it is none or a share.
    share : float
        Instead: bandwidth over the frequency of the order.
    poles : int
    revolutions : float
        Length of a block, 0 where there are none.
    taper : float
        Revolutions over which its weights rise at one end and fall at the other, as half a Hann window.
    """

    bandwidth: float = 0.0
    share: float = 0.0
    poles: int = VOLD_KALMAN_POLES
    revolutions: float = 0.0
    taper: float = 0.0

    @property
    def known(self) -> bool:
        """Whether it is known how the order was tracked."""
        return bool(self.bandwidth or self.share or self.revolutions)

    def reach(self, speed: float, order: float) -> float:
        """Time in s on either side of a value over which it is a mean, at a speed in rad/s; 0: not known."""
        if self.revolutions:
            return self.revolutions * np.pi / speed
        return REACH / self._width(speed, order) if self.known else 0.0

    def distance(self, speed: float, order: float) -> float:
        """Time in s between values whose noise is nearly independent, at a speed in rad/s; 0: not known."""
        if self.revolutions:
            return (self.revolutions - self.taper) * 2 * np.pi / speed
        return INDEPENDENT / self._width(speed, order) if self.known else 0.0

    def weights(self, times: FloatArray, speed: float, order: float) -> FloatArray:
        """Relative weights at times in s from a value, shape (n,), at a speed in rad/s."""
        if self.revolutions:
            inside = (self.revolutions / 2 - np.abs(times) * speed / (2 * np.pi)) / self.taper
            return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.clip(inside, 0, 1)))
        at, heights = _filter_weights(self.poles)
        return np.interp(np.abs(times) * self._width(speed, order), at, heights)

    def _width(self, speed: float, order: float) -> float:
        return self.bandwidth or self.share * order * speed / (2 * np.pi)


def tracking_kernel(notes: Sequence[str], revolutions: float | None, bandwidth: float | None) -> TrackingKernel:
    """Weights of an order tracking by what is given, or else by the notes of the tracked orders.

    Raises
    ------
    UsageError
        Revolutions and bandwidth are both given.

    Examples
    --------
    >>> said = "Vold-Kalman filter of 2 poles, bandwidth 4 Hz between the -3 dB points"
    >>> tracking_kernel([said], None, None).bandwidth
    4.0
    """
    if revolutions is not None and bandwidth is not None:
        raise UsageError("an order is tracked in windows of revolutions or with a bandwidth: give one of them")
    if revolutions is not None:
        return TrackingKernel(revolutions=revolutions, taper=revolutions / 2)
    if bandwidth is not None:
        return TrackingKernel(bandwidth=bandwidth)
    for note in notes:
        if found := _FILTER.search(note):
            poles, width, unit = int(found[1]), float(found[2]), found[3]
            return TrackingKernel(width if unit == "Hz" else 0.0, 0.0 if unit == "Hz" else width / 100, poles)
        if found := _BLOCKS.search(note):
            cycles, turns = int(found[1]), int(found[2])
            return TrackingKernel(revolutions=float(cycles * turns), taper=float(turns))
    return TrackingKernel()


def _filter_weights(poles: int) -> tuple[FloatArray, FloatArray]:
    """Times over the inverse bandwidth, and weights of the filter 1/(1 + (sqrt 2 - 1) (2 f/bandwidth)^(2 poles))."""
    f = np.linspace(0, HIGHEST, FINEST * 4)
    transmitted = 1 / (1 + (np.sqrt(2) - 1) * (2 * f) ** (2 * poles))
    at = np.linspace(0, REACH, FINEST // 10)
    return at, np.asarray(np.trapezoid(transmitted * np.cos(2 * np.pi * np.outer(at, f)), f, axis=1))

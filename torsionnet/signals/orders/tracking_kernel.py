"""Weights with which an order tracking takes the mean of the amplitude over time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.linear.frequency_response import FloatArray

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


UNKNOWN_TRACKING = TrackingKernel()
"""Weights of which nothing is known."""


def _filter_weights(poles: int) -> tuple[FloatArray, FloatArray]:
    """Times over the inverse bandwidth, and weights of the filter 1/(1 + (sqrt 2 - 1) (2 f/bandwidth)^(2 poles))."""
    f = np.linspace(0, HIGHEST, FINEST * 4)
    transmitted = 1 / (1 + (np.sqrt(2) - 1) * (2 * f) ** (2 * poles))
    at = np.linspace(0, REACH, FINEST // 10)
    return at, np.asarray(np.trapezoid(transmitted * np.cos(2 * np.pi * np.outer(at, f)), f, axis=1))

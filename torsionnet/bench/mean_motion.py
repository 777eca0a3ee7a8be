"""Mean rotation of the reference shaft of a bench: its angle, speed and acceleration over time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsionnet.signals.recording import FloatArray


@dataclass(frozen=True, eq=False)
class MeanMotion:
    """Mean rotation of a shaft whose speed runs straight between points.

    Attributes
    ----------
    times : (n,) array
        s, from 0.
    speeds : (n,) array
        rad/s at these times.
    start_angle : float
        Angle at time 0, rad.

    Examples
    --------
    >>> run = MeanMotion(np.array([0.0, 2.0]), np.array([10.0, 20.0]))
    >>> run.angle(np.array([0.0, 1.0, 2.0])).tolist(), run.speed(np.array([1.0])).tolist()
    ([0.0, 12.5, 30.0], [15.0])
    """

    times: FloatArray
    speeds: FloatArray
    start_angle: float = 0.0

    @property
    def length(self) -> float:
        """Time from the first to the last point, s."""
        return float(self.times[-1])

    @cached_property
    def _angles(self) -> FloatArray:
        turned = np.diff(self.times) * (self.speeds[1:] + self.speeds[:-1]) / 2
        return np.concatenate([[self.start_angle], self.start_angle + np.cumsum(turned)])

    def angle(self, times: FloatArray) -> FloatArray:
        """Angles in rad at times in s between first and last point, shape (n,)."""
        place = self._place(times)
        since = times - self.times[place]
        return np.asarray(self._angles[place] + since * (self.speeds[place] + self.acceleration(times) * since / 2))

    def speed(self, times: FloatArray) -> FloatArray:
        """Speeds in rad/s at times in s, shape (n,)."""
        return np.interp(times, self.times, self.speeds)

    def acceleration(self, times: FloatArray) -> FloatArray:
        """Accelerations in rad/s^2 at times in s, shape (n,); where two stretches meet, that of the later one."""
        return np.asarray((np.diff(self.speeds) / np.diff(self.times))[self._place(times)])

    def _place(self, times: FloatArray) -> FloatArray:
        return np.asarray(np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, len(self.times) - 2))

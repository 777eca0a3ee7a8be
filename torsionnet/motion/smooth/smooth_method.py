"""Runge-Kutta method for a smooth motion: explicit, or implicit where the motion is stiff."""

from __future__ import annotations

from typing import Any

import numpy as np

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.motion.contact_states import Contact
from torsionnet.motion.driving import Stretch
from torsionnet.motion.smooth.smooth_contact import SmoothContact
from torsionnet.motion.smooth.smooth_plant import SmoothPlant

RELATIVE, ABSOLUTE = 1e-11, 1e-13
"""Tolerances of the Runge-Kutta method in a step, relative and in rad and rad/s: its twists are differences of angles
that grow, of which the eleventh digit still counts."""
STIFF = 300.0
"""Ratio of the quickest decay to the fastest vibration from which an implicit method is cheaper. The explicit one takes
a step per 6 time constants of the decay, the implicit one about 50 in a radian at these tolerances."""
STEPS_BETWEEN_LOOKS = 200
"""Steps after which the poles of the motion are looked at again, which cost as much as two or three."""
ROUNDING = 2.3e-14
"""Least relative tolerance that the methods take."""


class SmoothMethod:
    """Choice of the method for each part of a motion, by the poles of the motion where it has got to.

    ``turning`` is the largest circular frequency in rad/s seen so far.
    """

    def __init__(self, plant: SmoothPlant, refinement: int) -> None:
        self.plant = plant
        tighter = float(refinement) ** 5
        self.tolerances = {"rtol": max(RELATIVE / tighter, ROUNDING), "atol": ABSOLUTE / tighter}
        self.turning = 1 / max(plant.driving.duration, 1e-300)
        self.stiff = False
        self._stiff_in: dict[Contact, bool] = {}
        self.steps, self.looked = 0, -STEPS_BETWEEN_LOOKS
        self.size: float | None = None

    def entered(self, now: SmoothContact) -> None:
        """Take the method of a contact state that is known, and look at the motion in a new one."""
        self.turning = max(self.turning, now.turning)
        if now.contact in self._stiff_in:
            self.stiff = self._stiff_in[now.contact]
        else:
            self.looked = self.steps - STEPS_BETWEEN_LOOKS

    def solver(self, now: SmoothContact, stretch: Stretch, time: float, y: FloatArray) -> Any:
        """Solver from a time in s and states y to the end of a stretch."""
        from scipy.integrate import DOP853, Radau

        right = self.plant.right_side(now, stretch)
        if self.steps - self.looked >= STEPS_BETWEEN_LOOKS:
            self._look(now, right, time, y)
        first = None if self.size is None else min(self.size, stretch.end - time)
        method = Radau if self.stiff else DOP853
        return method(right, time, y, stretch.end, first_step=first, **self.tolerances)

    def passed(self, now: SmoothContact, stretch: Stretch, start: float, solver: Any) -> bool:
        """Whether the method changes after a step that began at a time in s."""
        self.steps += 1
        self.size = max(solver.t - start, 1e-12 * solver.t)
        if self.steps - self.looked < STEPS_BETWEEN_LOOKS or solver.status != "running":
            return False
        before = self.stiff
        self._look(now, self.plant.right_side(now, stretch), solver.t, solver.y)
        return before != self.stiff

    def _look(self, now: SmoothContact, right: Any, time: float, y: FloatArray) -> None:
        self.looked = self.steps
        slopes = slopes_of(right, time, y)
        poles = np.linalg.eigvals(slopes) if len(y) and np.isfinite(slopes).all() else np.zeros(0)
        self.turning = max(self.turning, float(np.abs(poles.imag).max(initial=0.0)))
        self.stiff = float(np.abs(poles.real).max(initial=0.0)) > STIFF * self.turning
        self._stiff_in[now.contact] = self.stiff


def slopes_of(right: Any, time: float, y: FloatArray) -> FloatArray:
    """Slopes (n, n) of rates of change over states y (n,), by differences.

    >>> slopes_of(lambda t, y: np.array([y[1], -4 * y[0]]), 0.0, np.array([1.0, 0.0])).round(6) + 0.0
    array([[ 0.,  1.],
           [-4.,  0.]])
    """
    base = right(time, y)
    found = np.zeros((len(y), len(y)))
    step = np.sqrt(np.finfo(float).eps) * np.maximum(np.abs(y), 1e-3 * np.abs(y).max(initial=0.0) + 1e-9)
    for number, size in enumerate(step.tolist()):
        moved = y.copy()
        moved[number] += size
        found[:, number] = (right(time, moved) - base) / size
    return found

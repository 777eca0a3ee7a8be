"""Axis of speeds, with room around a steady speed, whose small changes would fill the panel else."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from torsionnet.linear.assembly.rows import FloatArray

STEADY_SHARE = 1e-3
"""Span of speeds over the largest up to which they count as one: a governor leaves so much, a run-up far more."""
ROOM = 0.01
"""Share of a steady speed that its axis shows on either side, wide enough for ticks of whole numbers."""
MOST_STEPS = 4
"""Most steps between ticks of the axis of a steady speed, as panels side by side are narrow."""


def is_steady(speeds: FloatArray) -> bool:
    """Whether speeds are one speed but for what a governor leaves, so that a line through them would not be seen.

    Examples
    --------
    >>> is_steady(np.array([929.9999, 930.0001])), is_steady(np.array([870.0, 990.0]))
    (True, False)
    """
    return bool(np.ptp(speeds) <= STEADY_SHARE * np.abs(speeds).max())


def curve_mark(speeds: FloatArray) -> dict[str, Any]:
    """Marks of matplotlib for a curve over speed: dashes where all its points lie at one speed, else none."""
    return {"marker": "_", "markersize": 24, "markeredgewidth": 1.3} if is_steady(speeds) else {}


def fit_speeds(axes: Axes, rpm: FloatArray) -> None:
    """Show speeds in rpm as plain numbers, and a steady one in the middle of its axis."""
    axes.ticklabel_format(axis="x", useOffset=False)
    if is_steady(rpm):
        middle = float(np.mean(rpm))
        axes.set_xlim(middle - ROOM * abs(middle), middle + ROOM * abs(middle))
        axes.xaxis.set_major_locator(MaxNLocator(MOST_STEPS))

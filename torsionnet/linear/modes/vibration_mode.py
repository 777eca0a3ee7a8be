"""Mode of vibration with its frequencies in Hz with and without damping."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from torsionnet.base.result_rows import Out
from torsionnet.linear.frequency_response import ComplexArray

SHIFTED_SHARE = 0.01
"""Relative difference of natural and undamped frequency above which a mode counts as shifted by damping."""


@dataclass(frozen=True, eq=False)
class VibrationMode:
    """Undamped mode paired with the damped mode of the most similar strain, frequencies in Hz; either may be missing.

    Attributes
    ----------
    number : int
        Number of the damped mode, from 1 by rising ``|lambda|``, as in every table of modes; undamped modes that are
        overdamped follow after them.
    undamped_frequency : float
        Frequency in Hz from M and K alone; nan where a mode exists only with damping.
    natural_frequency, damped_frequency : float
        ``|lambda|/2pi`` and ``Im lambda/2pi`` in Hz; nan for an overdamped mode.
    damping_ratio : float
    similarity : float
        Modal assurance criterion of the two shapes, weighted with the stiffness; nan where one is missing.
    shape : (n_nodes,) complex array
        Angles, 1 at the node that moves most; the undamped shape if there is one.
    """

    number: Annotated[int, Out("mode", json="mode")]
    undamped_frequency: Annotated[float, Out("undamped", "Hz", "undamped_natural_frequency_Hz")]
    natural_frequency: Annotated[float, Out("|lambda|/2pi", "Hz", "natural_frequency_Hz")]
    damped_frequency: Annotated[float, Out("damped Im lambda/2pi", "Hz", "damped_frequency_Hz")]
    damping_ratio: Annotated[float, Out("damping ratio", "1", digits=4)]
    similarity: float
    shape: Annotated[ComplexArray, Out(json=None)]

    @property
    def amplification(self) -> Annotated[float, Out("amplification", digits=4, after="damping_ratio")]:
        """Amplification of a mode at resonance, ``1/(2 zeta)``; nan without a damped mode, infinite without damping."""
        if math.isnan(self.damping_ratio):
            return math.nan
        return 1 / (2 * self.damping_ratio) if self.damping_ratio > 0 else math.inf

    @property
    def is_shifted(self) -> bool:
        """Whether damping shifts the natural frequency of a mode by more than 1 %."""
        return abs(self.natural_frequency - self.undamped_frequency) > SHIFTED_SHARE * self.undamped_frequency

    @property
    def remark(self) -> Annotated[str, Out("remark", json=None, after="shape")]:
        """Text on why a frequency of a mode is missing (overdamped, or only with damping); empty if none is."""
        if math.isnan(self.natural_frequency):
            return "overdamped: none with damping"
        return "exists with damping only" if math.isnan(self.undamped_frequency) else ""


def amplification(frequency_ratio: float, damping_ratio: float) -> float:
    """Magnification ``1/|1 - r^2 + 2 j zeta r|`` of one degree of freedom at r = excitation over natural frequency.

    >>> round(amplification(0.9, 0.01), 2)
    5.24
    """
    size = abs(complex(1 - frequency_ratio**2, 2 * damping_ratio * frequency_ratio))
    return 1 / size if size else math.inf

"""Pressure trace over one cycle of an engine: harmonics and mean indicated pressure."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from torsionnet.base.errors import Position
from torsionnet.machinery.excitations.order_excitation import ComplexArray, FloatArray
from torsionnet.machinery.excitations.slider_crank import harmonics, piston_rate

LOWEST_PEAK, HIGHEST_PEAK = 1e3, 1e9
"""Smallest and largest possible peak pressure of a cylinder in Pa, as one in bar without its unit lies below."""
CLOSING_RTOL = 0.02
"""Share of the peak by which the two ends of a pressure trace may differ, for measuring noise and drift."""
LEAST_SAMPLES = 24
"""Smallest number of pressures in a cycle, as fewer cannot give the orders of a gas torque."""
WHOLE_CYCLE = "a cycle is 720 deg of a four-stroke engine, 360 deg of a two-stroke engine"
"""Hint for messages on pressure traces that cover another angle than a whole cycle."""


@dataclass(frozen=True)
class PressureTrace:
    """Pressures at even steps over one cycle, without its second end.

    Attributes
    ----------
    values : tuple of float
        Pa.
    start : float
        Crank angle of the first pressure, rad.
    revolutions : int, optional
        Revolutions that a file covers; a list covers the cycle of the engine.
    file : str
        Name of the file.
    place : Position, optional
        Position of the heading in that file.
    note : str
        Remark for the author, as on interpolation.
    """

    values: tuple[float, ...]
    start: float = 0.0
    revolutions: int | None = field(default=None, compare=False)
    file: str = field(default="", compare=False)
    place: Position | None = field(default=None, compare=False)
    note: str = field(default="", compare=False)

    def __str__(self) -> str:
        low, high = min(self.values) / 1e5, max(self.values) / 1e5
        source = f" of {self.file}" if self.file else ""
        return f"{len(self.values)} pressures{source}, {low:.4g} to {high:.4g} bar"

    @property
    def origin(self) -> str:
        """Text with which messages on the trace begin: its file, or nothing."""
        return f"{self.file}: " if self.file else ""

    def tangential(self, ratio: float, revolutions: int, zero: float, below: float) -> tuple[FloatArray, FloatArray]:
        """Angles in rad after firing top dead centre and tangential pressures in Pa, each of shape (n_samples,).

        ``zero`` is the angle of the trace at firing top dead centre, ``below`` the pressure under the piston.
        """
        angles = self.start - zero + 2 * np.pi * revolutions * np.arange(len(self.values)) / len(self.values)
        return angles, (np.array(self.values) - below) * piston_rate(angles, ratio)

    def harmonics(
        self, ratio: float, revolutions: int, orders: FloatArray, zero: float = 0.0, below: float = 0.0
    ) -> ComplexArray:
        """Complex tangential pressure in Pa by order, shape (n_orders,), from the samples without smoothing."""
        angles, tangential = self.tangential(ratio, revolutions, zero, below)
        return np.asarray(harmonics(tangential, revolutions, orders) * np.exp(-1j * orders * angles[0]))

    def mean_indicated_pressure(self, ratio: float, revolutions: int, zero: float = 0.0) -> float:
        """Mean indicated pressure of the trace in Pa, the work of a cycle over the swept volume."""
        _, tangential = self.tangential(ratio, revolutions, zero, 0.0)
        return float(np.mean(tangential) * np.pi * revolutions)


def peak_pressure_fault(trace: PressureTrace) -> str:
    """Message if the peak pressure of a trace is impossible for a cylinder, else an empty text."""
    peak = max(map(abs, trace.values))
    if peak < LOWEST_PEAK:
        meant = "is the column in another unit?" if trace.file else f"a bare number is Pa, write {peak:.6g} bar"
        return f"a peak of {peak:g} Pa ({peak / 1e5:.2g} bar) is too low for a cylinder; {meant}"
    return f"a peak of {peak / 1e5:g} bar is too high for a cylinder; check the unit" if peak > HIGHEST_PEAK else ""

"""A pressure over one cycle of an engine."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from torsionnet.core.errors import Position
from torsionnet.model.excitations.order_excitation import ComplexArray, FloatArray
from torsionnet.model.excitations.slider_crank import harmonics, piston_rate

LOWEST_PEAK, HIGHEST_PEAK = 1e3, 1e9
"""Pa."""
CLOSING = 0.02
"""Share of the peak by which the ends of a trace may differ that holds both."""
LEAST_SAMPLES = 24
WHOLE_CYCLE = "a cycle is 720 deg of a four-stroke engine, 360 deg of a two-stroke engine"


@dataclass(frozen=True)
class PressureTrace:
    """Pressures at even steps over one cycle, one end of it.

    Attributes
    ----------
    values : tuple of float
        Pa.
    start : float
        Crank angle of the first one, rad.
    revolutions : int, optional
        What a file covers; a list covers what the engine's cycle is.
    file : str
        Where it came from.
    place : Position, optional
        Of the heading in that file.
    note : str
        What was made of it that its author may want to know.
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
        """How messages begin that speak of it."""
        return f"{self.file}: " if self.file else ""

    def tangential(self, ratio: float, revolutions: int, zero: float, below: float) -> tuple[FloatArray, FloatArray]:
        """Angles after firing top dead centre in rad, and torques over piston area and crank radius in Pa.

        ``zero`` is the angle of the trace at firing top dead centre, ``below`` the pressure under the piston.
        """
        angles = self.start - zero + 2 * np.pi * revolutions * np.arange(len(self.values)) / len(self.values)
        return angles, (np.array(self.values) - below) * piston_rate(angles, ratio)

    def harmonics(
        self, ratio: float, revolutions: int, orders: FloatArray, zero: float = 0.0, below: float = 0.0
    ) -> ComplexArray:
        """Tangential pressure in Pa by order: those of the samples, as they are."""
        angles, tangential = self.tangential(ratio, revolutions, zero, below)
        return np.asarray(harmonics(tangential, revolutions, orders) * np.exp(-1j * orders * angles[0]))

    def mean_indicated_pressure(self, ratio: float, revolutions: int, zero: float = 0.0) -> float:
        """Work of a cycle over the swept volume, Pa."""
        _, tangential = self.tangential(ratio, revolutions, zero, 0.0)
        return float(np.mean(tangential) * np.pi * revolutions)


def unlikely_size(trace: PressureTrace) -> str:
    """Why the peak cannot be that of a cylinder, or nothing."""
    peak = max(map(abs, trace.values))
    if peak < LOWEST_PEAK:
        meant = "is the column in another unit?" if trace.file else f"a bare number is Pa, write {peak:.6g} bar"
        return f"a peak of {peak:g} Pa ({peak / 1e5:.2g} bar) is no pressure in a cylinder; {meant}"
    return f"a peak of {peak / 1e5:g} bar is no pressure in a cylinder" if peak > HIGHEST_PEAK else ""

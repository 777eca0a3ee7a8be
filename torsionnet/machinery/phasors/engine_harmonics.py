"""Excitation of one cylinder by order, gas and reciprocating mass apart, and mean indicated pressure over speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from torsionnet.base.result_rows import Out
from torsionnet.base.units import RPM

MPA_PER_PA, BAR_PER_PA, KILO = 1e-6, 1e-5, 1e-3
"""Factors from Pa to N/mm^2 and to bar, and from SI units to kN m and kW."""


@dataclass(frozen=True)
class CylinderHarmonic:
    """Harmonic of a cylinder's torque, one order, as torque (N m) and divided by piston area and crank radius (Pa).

    Attributes
    ----------
    order : float
        Vibrations per revolution of the crankshaft.
    gas, inertia : float
        Peak values of the parts of the gas and of the reciprocating mass, Pa.
    resulting : float
        Peak value of both together, with their phases, Pa.
    torque : float
        Peak value in N m, the resulting pressure times piston area and crank radius.
    phase : float
        Of the cosine, from firing top dead centre on, rad.
    """

    order: Annotated[float, Out("order", digits=2)]
    gas: Annotated[float, Out("gas", "N/mm^2", digits=4, factor=MPA_PER_PA)]
    inertia: Annotated[float, Out("mass", "N/mm^2", digits=4, factor=MPA_PER_PA)]
    resulting: Annotated[float, Out("resulting", "N/mm^2", digits=4, factor=MPA_PER_PA)]
    torque: Annotated[float, Out("torque", "kN*m", digits=4, factor=KILO)]
    phase: Annotated[float, Out("phase", "deg", digits=4)]


@dataclass(frozen=True)
class IndicatedPressure:
    """Mean indicated pressure (Pa) of an engine at one speed (rad/s), with indicated torque (N m) of all its cylinders.

    ``speed`` in rad/s of the crankshaft, ``pressure`` in Pa, ``torque`` in N m, ``power`` in W; negative for a machine
    that takes work.
    """

    speed: Annotated[float, Out("speed", "r/min", digits=5, factor=RPM)]
    pressure: Annotated[float, Out("mean indicated pressure", "bar", digits=4, factor=BAR_PER_PA)]
    torque: Annotated[float, Out("indicated torque", "kN*m", digits=4, factor=KILO)]

    @property
    def power(self) -> Annotated[float, Out("indicated power", "kW", digits=4, factor=KILO, after="torque")]:
        """Indicated power of all cylinders in W."""
        return self.torque * self.speed

"""Steady temperature of a part that vibration heats, by the balance of the heat it takes up and gives off."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from torsionnet.base.entries.scalars import Value, read_scalar
from torsionnet.base.entries.spec import EntryError
from torsionnet.base.expressions import Number
from torsionnet.linear.frequency_response import FloatArray

ICE_POINT = 273.15
"""Temperature of 0 degC in K."""
Heat = TypeVar("Heat", float, FloatArray)
COLDEST = 200.0
"""Number without a unit from which on it is a temperature in K; smaller ones are refused, as they may be degC: no
machinery is as cold."""


class TemperatureValue(Value):
    """Entry of a fixed temperature with its unit, stored in K."""

    def coerce(self, raw: object) -> float:
        number = read_scalar(raw, self.dimension)
        if isinstance(number, Number) and number.unit_dimension is None and number.value < COLDEST:
            raise EntryError(f"a temperature has its unit: write {raw} degC, or {raw} K")
        return super().coerce(raw)

    def plain(self, value: float) -> str:
        return f"{value!r} K"


def temperature_words(hottest: float) -> str:
    """Remark on the highest steady temperature, given in K."""
    return f"steady temperature by balance of heat at most {hottest - ICE_POINT:.3g} degC"


def steady_temperature(power: Heat, heat_transfer: float, ambient: float) -> Heat:
    """Steady temperature in K of a part that turns ``power`` into heat, in the shape of ``power``.

    The heat that the part takes up by damping leaves it by its surface: P = Lambda (t - t_a). It is the temperature
    reached after many time constants C/Lambda, with C the heat capacity, as a mean over the part; its core is warmer.

    Parameters
    ----------
    power : float or array
        Mean power dissipated, W.
    heat_transfer : float
        Lambda, heat given off per degree above ambient, W/K: surface times heat transfer coefficient, from the maker.
    ambient : float
        Temperature of the air around the part, K. IACS UR M40 (1986) has 45 degC in engine rooms.

    References
    ----------
    F. P. Incropera, D. P. DeWitt et al., Fundamentals of Heat and Mass Transfer, 6th ed. (2007), section 5.1: lumped
    capacitance.

    Examples
    --------
    >>> round(steady_temperature(800.0, 20.0, 45 + 273.15) - 273.15, 6)
    85.0
    """
    return (
        np.asarray(ambient + power / heat_transfer)
        if isinstance(power, np.ndarray)
        else ambient + power / heat_transfer
    )

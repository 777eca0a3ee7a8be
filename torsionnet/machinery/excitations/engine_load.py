"""Load of an engine, its mean indicated pressure over speed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.composite import Nested, one_exactly
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import EntryError, entry, not_none
from torsionnet.base.errors import Fault
from torsionnet.machinery.excitations.order_excitation import FloatArray
from torsionnet.machinery.excitations.table_by_pressure import MEAN_PRESSURE, mean_pressure


@dataclass(frozen=True, kw_only=True)
class EngineLoad(Declared):
    """Mean indicated pressure of an engine at rated speed, or the power it makes, and how it follows the speed.

    Examples
    --------
    >>> load = EngineLoad(mean_indicated_pressure="20 bar", rated="750 rpm", exponent=2)
    >>> (load.at(np.array([375.0, 750.0]) * np.pi / 30, swept_volume=0.2, revolutions=2) / 1e5).round(6).tolist()
    [5.0, 20.0]
    """

    kind: ClassVar[str] = "engine load"
    article: ClassVar[str] = "the load of an engine"
    form: ClassVar[str] = "{mean_indicated_pressure: 27 bar, rated: 750 rpm, exponent: 2}"

    mean_indicated_pressure: float | None = entry(MEAN_PRESSURE, None)
    power: float | None = entry(Value("instead: power at the coupling at rated speed", "power", exclusive=True), None)
    mechanical_efficiency: float | None = entry(
        Value("power at the coupling over indicated power", "1", exclusive=True, below=1.0001), None
    )
    rated: float | None = entry(Value("speed to which these belong", "speed", exclusive=True), None)
    exponent: float = entry(
        Value("mean indicated pressure follows (speed/rated) to this power: 2 on a propeller curve", "1", lower=None), 0
    )

    def contradictions(self) -> list[Fault]:
        wrong = one_exactly(self, "mean_indicated_pressure", "power", of="a load", form=self.form)
        if wrong:
            return wrong
        if self.power is not None and self.mechanical_efficiency is None:
            text = "the indicated power follows from that at the coupling with mechanical_efficiency: 0.92"
            return [Fault(text, ("power",), on_key=True)]
        if self.power is None and self.mechanical_efficiency is not None:
            text = "a mean indicated pressure needs no mechanical_efficiency; that belongs to a power"
            return [Fault(text, ("mechanical_efficiency",), on_key=True)]
        if self.rated is None and (self.power is not None or self.exponent):
            return [Fault("give the speed at which this is reached: rated: 750 rpm", on_key=True)]
        if self.power is None:
            try:
                mean_pressure(self.mean_indicated_pressure)
            except EntryError as error:
                return [Fault(str(error), ("mean_indicated_pressure",))]
        return []

    def at(self, speeds: FloatArray, swept_volume: float, revolutions: int) -> FloatArray:
        """Mean indicated pressure in Pa at speeds in rad/s, shape (n_speeds,), of cycles of so many revolutions.

        ``swept_volume`` is that of all cylinders in m^3.
        """
        pressure = self.mean_indicated_pressure
        if pressure is None:
            power = not_none(self.power) / not_none(self.mechanical_efficiency)
            work = power * 2 * math.pi * revolutions / not_none(self.rated)
            pressure = work / swept_volume
        follows = (speeds / not_none(self.rated)) ** self.exponent if self.exponent else np.ones(len(speeds))
        return np.asarray(pressure * follows)


LOAD = Nested("mean indicated pressure over speed", lambda: EngineLoad, "engine_load")

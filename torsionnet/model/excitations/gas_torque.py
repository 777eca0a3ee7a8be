"""The pressure in a cylinder over the crank angle, and the torque it makes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from torsionnet.core.entries.composite import Listed, Nested
from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.scalars import Value
from torsionnet.core.entries.spec import entry
from torsionnet.core.entries.words import OneOf
from torsionnet.core.errors import Fault

PRESSURE = Value("a pressure", "pressure", lower=None)
_TRACE = Listed(
    "pressure at even steps over the cycle, from firing top dead centre on", PRESSURE, form="a list of pressures"
)
LEAST_SAMPLES = 24
CLOSING = 0.02
"""Share of the peak by which the ends of a trace with both of them may differ."""


@dataclass(frozen=True, kw_only=True)
class GasPressure(Declared):
    """Pressure over one cycle, with injection and without."""

    kind: ClassVar[str] = "gas"
    article: ClassVar[str] = "the gas of an engine"
    form: ClassVar[str] = "{fired: [...], motored: [...], crankcase: 1 bar}"

    fired: Any = entry(_TRACE)
    motored: Any = entry(
        Listed("the same without injection, but with compression", PRESSURE, form="a list of pressures"), ()
    )
    reference: str = entry(OneOf("what the pressures are over", ("absolute", "gauge")), "absolute")
    crankcase: Any = entry(Value("absolute pressure below the pistons", "pressure"), "1 bar")
    rated: Any = entry(Value("speed to which the pressures belong, of exponent", "speed", exclusive=True), None)
    exponent: Any = entry(Value("gas torque follows speed/rated to this power", "1", lower=None), 0)

    def contradictions(self) -> list[Fault]:
        faults = [fault.under(key) for key in ("fired", "motored") for fault in _trace_faults(getattr(self, key))]
        if self.motored and len(_open(self.motored)) != len(_open(self.fired)):
            faults.append(
                Fault("the trace without injection has other steps than that with it", ("motored",), on_key=True)
            )
        if self.exponent and self.rated is None:
            faults.append(
                Fault("an exponent needs the speed to which the pressures belong: rated: 105 rpm", ("exponent",))
            )
        return faults

    def over_crankcase(self, *, motored: bool = False) -> np.ndarray[Any, Any]:
        """Pressure difference across the piston in Pa at even steps, one end of the cycle."""
        below = self.crankcase if self.reference == "absolute" else 0.0
        return np.array(_open(self.motored if motored else self.fired)) - below

    def factor(self, speeds: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        """Gas torque at speeds in rad/s over that of the traces."""
        return np.asarray((speeds / self.rated) ** self.exponent if self.exponent else np.ones(len(speeds)))


GAS = Nested("pressure in the cylinders", lambda: GasPressure, "gas")


def _open(trace: tuple[float, ...]) -> tuple[float, ...]:
    """A trace with both ends of the cycle loses the second: 721 values at 0 to 720 degrees are 720 steps."""
    return trace[:-1] if len(trace) % 2 else trace


def _trace_faults(trace: tuple[float, ...]) -> list[Fault]:
    if not trace:
        return []
    if len(trace) < LEAST_SAMPLES:
        return [Fault(f"{len(trace)} pressures are too few for a cycle; give {LEAST_SAMPLES} or more", on_key=True)]
    peak = max(map(abs, trace))
    if len(trace) % 2 and abs(trace[0] - trace[-1]) > CLOSING * peak:
        text = f"the trace does not close: it begins with {trace[0]:.6g} Pa and ends with {trace[-1]:.6g} Pa"
        return [Fault(f"{text}; give the whole cycle, with or without its last point", on_key=True)]
    if peak < 1e3:
        return [
            Fault(f"a peak of {peak:g} Pa is no pressure in a cylinder; a bare number is Pa, write 98 bar", on_key=True)
        ]
    return []


def piston_area(bore: float) -> float:
    """m^2."""
    return math.pi * bore**2 / 4

"""Entries of a strain gauge with its telemetry, and of the disturbances of analog channels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value, ValueInUnitOfUse
from torsionnet.base.entries.spec import OneOf, entry
from torsionnet.base.expressions import Number
from torsionnet.bench.plan.parts import Transducer


@dataclass(frozen=True, kw_only=True)
class ShuntCalibration(Declared):
    """A resistor beside an arm of the bridge, which reads like a known value for a while.

    Examples
    --------
    >>> ShuntCalibration(value="50 kN*m", duration="2 s").at
    'start'
    """

    kind: ClassVar[str] = "shunt calibration"

    value: Number = entry(ValueInUnitOfUse("what the resistor is to read, added to the measurand", exclusive=True))
    duration: float = entry(Value("time for which it is connected", "time", exclusive=True))
    at: str = entry(OneOf("end of the record where it is connected", ("start", "end")), "start")


@dataclass(frozen=True, kw_only=True)
class ZeroDrift(Declared):
    """A zero that moves over the record, straight or as something that warms up.

    Examples
    --------
    >>> ZeroDrift(change="500 N*m").warming is None
    True
    """

    kind: ClassVar[str] = "zero drift"

    change: Number = entry(ValueInUnitOfUse("change of the zero from the first to the last sample", lower=None))
    warming: float | None = entry(
        Value("time constant of warming up; without it the zero moves straight", "time", exclusive=True), None
    )


@dataclass(frozen=True, kw_only=True)
class StrainGauge(Transducer):
    """A strain gauge bridge on a shaft with its amplifier and telemetry; it reads gain * value + zero + noise.

    Examples
    --------
    >>> StrainGauge(gain=1.02, shunt={"value": "50 kN*m", "duration": "2 s"}, delay="3 ms").shunt.duration
    2.0
    """

    kind: ClassVar[str] = "strain gauge"

    gain: float = entry(Value("bridge factor: what the chain reads over what is there", "1", lower=None), 1.0)
    shunt: ShuntCalibration | None = entry(
        Nested("shunt calibration", lambda: ShuntCalibration, "bench_shunt_calibration"), None
    )
    zero_drift: ZeroDrift | None = entry(Nested("drift of the zero", lambda: ZeroDrift, "bench_zero_drift"), None)

"""Entries for the exciter, the sensors and the data acquisition of a test bench."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import Listed, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Value, ValueInUnitOfUse, plain_number
from torsionnet.base.entries.spec import Count, EntryError, Flag, Json, OneOf, Schema, Spec, coerce_part, entry
from torsionnet.base.errors import Fault, got
from torsionnet.base.expressions import Number
from torsionnet.model.channels import ChannelName, RecordedName

DELAY = "time by which the channel lags behind the others"
"""Description of the entry ``delay`` of every sensor."""
SENSOR = 'what it reads if its name is no sensor of the model: "velocity(motor)", "torque(gearbox, output_shaft)"'
"""Description of the entry ``sensor`` of every channel."""


@dataclass(frozen=True, eq=False, repr=False)
class Shares(Spec[dict[int, float]]):
    """Entry of a share for each order: ``{2: 2 %, 3: 1 %}``."""

    highest: int = 20

    def coerce(self, raw: object) -> dict[int, float]:
        if not isinstance(raw, Mapping):
            raise EntryError(f"expected {{2: 2 %, 3: 1 %}}, {got(raw)}")
        shares = {}
        for key, share in raw.items():
            order = str(key)
            if not (order.isascii() and order.isdigit() and 2 <= int(order) <= self.highest):
                raise EntryError(
                    Fault(f'an order is a whole number from 2 to {self.highest}, got "{key}"', (key,), on_key=True)
                )
            shares[int(order)] = coerce_part(key, Value(self.description, "1"), share)
        return shares

    def plain(self, value: Any) -> Json:
        return {str(order): plain_number(share) for order, share in value.items()}

    def schema(self) -> Schema:
        names = {"pattern": "^[0-9]+$"}
        return {
            "type": "object",
            "propertyNames": names,
            "additionalProperties": SCALAR_SCHEMA,
            "description": self.description,
        }


@dataclass(frozen=True, kw_only=True)
class Exciter(Declared):
    """A torque-controlled motor that shakes the drivetrain; without entries it delivers its set-point exactly.

    The set-point is clipped at the rated torque, rounded by the analog output, and followed with a first-order lag.
    The harmonics bend the torque so delivered: a sine of the excitation's full amplitude A gets the shares of A.

    Examples
    --------
    >>> motor = Exciter(bandwidth="60 Hz", harmonics={2: 0.02, 3: "1 %"}, limit="110 N*m")
    >>> motor.bandwidth, motor.harmonics
    (60.0, {2: 0.02, 3: 0.01})
    """

    kind: ClassVar[str] = "exciter"

    bandwidth: float | None = entry(
        Value("frequency at which the torque is 3 dB below its set-point", "frequency", exclusive=True), None
    )
    compensated: bool = entry(
        Flag("whether the set-point is raised beforehand so that the delivered torque is flat (feed-forward)"), False
    )
    harmonics: dict[int, float] | None = entry(Shares("share of the amplitude that a sine gets at its multiples"), None)
    limit: float | None = entry(
        Value("rated torque, at which the set-point is clipped", "torque", exclusive=True), None
    )
    bits: int | None = entry(Count("resolution of the analog output of the set-point", upper=32), None)
    full_scale: float | None = entry(
        Value("torque at the end of the analog output's range, -full_scale to +full_scale", "torque", exclusive=True),
        None,
    )

    def contradictions(self) -> list[Fault]:
        found = []
        if (self.bits is None) != (self.full_scale is None):
            text = "bits and full_scale belong together: the range is divided into 2^bits levels"
            found.append(Fault(text, ("bits" if self.full_scale is None else "full_scale",)))
        if self.compensated and self.bandwidth is None:
            found.append(Fault("without a bandwidth there is nothing to compensate for", ("compensated",)))
        return found


@dataclass(frozen=True, kw_only=True)
class Hum(Declared):
    """A sine that the mains add to an analog channel, from a phase that the seed decides.

    Examples
    --------
    >>> Hum(amplitude="40 N*m").frequency
    50.0
    """

    kind: ClassVar[str] = "hum"

    amplitude: Number = entry(ValueInUnitOfUse("peak"))
    frequency: float = entry(Value("frequency of the mains", "frequency", exclusive=True), 50.0)


@dataclass(frozen=True, kw_only=True)
class DropOuts(Declared):
    """Times without telemetry, at random, in which the channel holds its last value or reads zero.

    Examples
    --------
    >>> DropOuts(rate="0.1 Hz", duration="20 ms").reads
    'held'
    """

    kind: ClassVar[str] = "drop-outs"

    rate: float = entry(Value("how many there are per second, on average", "frequency", exclusive=True))
    duration: float = entry(Value("length of each", "time", exclusive=True))
    reads: str = entry(OneOf("what is recorded meanwhile", ("held", "zero")), "held")


@dataclass(frozen=True, kw_only=True)
class Transducer(Declared):
    """An analog sensor: torque transducer, tachometer, accelerometer. It reads gain * value + offset + noise.

    Examples
    --------
    >>> float(Transducer(range="230 N*m", noise="0.23 N*m").noise.value)
    0.23
    """

    kind: ClassVar[str] = "transducer"

    sensor: str | None = entry(ChannelName(SENSOR), None)
    range: Number | None = entry(
        ValueInUnitOfUse("largest value, plus or minus; beyond it the reading is clipped", exclusive=True), None
    )
    noise: Number | None = entry(ValueInUnitOfUse("standard deviation of white noise at the sampling rate"), None)
    offset: Number | None = entry(ValueInUnitOfUse("added to every value", lower=None), None)
    gain: float = entry(Value("what it reads over what is there", "1", lower=None), 1.0)
    delay: float = entry(Value(DELAY, "time"), 0.0)
    hum: Hum | None = entry(Nested("hum of the mains", lambda: Hum, "bench_hum"), None)
    drop_outs: DropOuts | None = entry(Nested("times without telemetry", lambda: DropOuts, "bench_drop_outs"), None)


@dataclass(frozen=True, kw_only=True)
class Encoder(Declared):
    """An incremental encoder: the angle in whole steps, from wherever the shaft stands when counting begins.

    Examples
    --------
    >>> Encoder(lines=1024, quadrature=True).steps
    4096
    """

    kind: ClassVar[str] = "encoder"

    sensor: str | None = entry(ChannelName(SENSOR), None)
    lines: int = entry(Count("lines per revolution", upper=10_000_000))
    quadrature: bool = entry(Flag("whether all four edges of the two tracks are counted"), False)
    delay: float = entry(Value(DELAY, "time"), 0.0)

    @property
    def steps(self) -> int:
        """Number of steps that the encoder counts per revolution."""
        return int(self.lines) * (4 if self.quadrature else 1)


@dataclass(frozen=True, kw_only=True)
class Acquisition(Declared):
    """Sampling of all channels at once.

    Examples
    --------
    >>> Acquisition(rate="10 kHz", bits=16).rate
    10000.0
    """

    kind: ClassVar[str] = "acquisition"

    rate: float = entry(Value("sampling rate", "frequency", exclusive=True))
    bits: int | None = entry(Count("resolution of the analog inputs over the range of each transducer", upper=32), None)
    anti_alias: float | None = entry(
        Value("cut-off (-3 dB) of a Butterworth filter of order 4 in the analog channels", "frequency", exclusive=True),
        None,
    )

    def contradictions(self) -> list[Fault]:
        if self.anti_alias is not None and not self.anti_alias < self.rate / 2:
            half = f"half the sampling rate, {self.rate / 2:g} Hz"
            return [Fault(f"the cut-off must be below {half}", ("anti_alias",))]
        return []


@dataclass(frozen=True, kw_only=True)
class RecordingSystem(Declared):
    """A second system that records some channels on a clock of its own, into a record of its own.

    It begins ``offset`` after the first one, and its clock gains ``drift`` on that of the first.

    Examples
    --------
    >>> RecordingSystem(channels=["T_int"], drift="50 ppm", offset="0.3 s").drift
    5e-05
    """

    kind: ClassVar[str] = "system"
    article: ClassVar[str] = "a recording system"

    channels: tuple[str, ...] = entry(
        Listed("channels that it records", RecordedName("the name of a channel"), form="a list of names")
    )
    drift: float = entry(Value("share by which its clock is fast", "1", lower=None, below=0.01), 0.0)
    offset: float = entry(Value("time on the first system's clock at which it begins, at its own time 0", "time"), 0.0)
    rate: float | None = entry(Value("sampling rate, by default that of the first", "frequency", exclusive=True), None)

"""Entries for the exciter, the sensors and the data acquisition of a test bench."""

from __future__ import annotations

import math
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
            raise EntryError(f"expected {{2: 2 %, 3: 1 %}}, {got(raw)}", kind="wrong-form")
        shares = {}
        for key, share in raw.items():
            order = str(key)
            if not (order.isascii() and order.isdigit() and 2 <= int(order) <= self.highest):
                raise EntryError(
                    Fault(
                        f'an order is a whole number from 2 to {self.highest}, got "{key}"',
                        (key,),
                        on_key=True,
                        kind="out-of-range",
                    )
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
        faults = []
        if (self.bits is None) != (self.full_scale is None):
            text = "bits and full_scale belong together: the range is divided into 2^bits levels"
            faults.append(Fault(text, ("bits" if self.full_scale is None else "full_scale",), kind="missing-entry"))
        if self.compensated and self.bandwidth is None:
            faults.append(
                Fault("without a bandwidth there is nothing to compensate for", ("compensated",), kind="needless-entry")
            )
        return faults


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
            return [Fault(f"the cut-off must be below {half}", ("anti_alias",), kind="out-of-range")]
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


# Entries of a strain gauge with its telemetry, and of the disturbances of analog channels.


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
class Creep(Declared):
    """Creep of what carries the torque or of its gauge: a value that is held is read with a share more in the end.

    Below zero it relaxes. A sine is read (1 + share/(1 + j w time)) times, so that slow loops of torque over twist
    are wider.

    Examples
    --------
    >>> Creep(share="-3 %", time="2 s").share
    -0.03
    """

    kind: ClassVar[str] = "creep"

    share: float = entry(Value("what is read more of a value that is held for long, as a share", "1", lower=-1.0))
    time: float = entry(Value("time constant", "time", exclusive=True))


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
    creep: Creep | None = entry(Nested("creep under the torque", lambda: Creep, "bench_creep"), None)


# Entries of a toothed wheel on a bench that turns: teeth and their errors, pickups, the counter of its pulses.

SENSED = 'the angle of its node, if its name is no sensor of the model: "angle(fly)"'
"""Description of the entry ``sensor`` of a toothed wheel."""
LARGEST_PITCH_SHARE = 0.25
"""Largest standard deviation of a tooth's place, over a pitch: beyond it teeth would change places."""
OWN_ENTRIES = ("sensor", "teeth", "missing_teeth", "gearing", "mounting", "pitch_errors", "radius", "radial_vibration")
"""Entries of a wheel itself, which a second pickup on it takes from the first."""


@dataclass(frozen=True, kw_only=True)
class PitchErrors(Declared):
    """Errors of the places of the teeth of a wheel; those that are given add up.

    Independent errors of standard deviation s at z teeth add 2 s/sqrt(z) to the peak amplitude of each whole order,
    as the RMS over wheels.

    Examples
    --------
    >>> PitchErrors(normal="5 %", eccentricity="0.05 deg").normal
    0.05
    """

    kind: ClassVar[str] = "pitch errors"

    normal: float = entry(
        Value("standard deviation of each tooth's place, as a share of a pitch", "1", below=LARGEST_PITCH_SHARE), 0.0
    )
    uniform: float = entry(
        Value("largest error of each tooth's place, plus or minus, as a share of a pitch", "1", below=0.5), 0.0
    )
    eccentricity: float = entry(Value("amplitude once per turn, as an angle", "angle"), 0.0)
    eccentricity_phase: float = entry(
        Value("phase of the eccentricity: tooth k is late by a cos(2 pi k/teeth + phase)", "angle", lower=None), 0.0
    )
    list: tuple[float, ...] = entry(
        Listed("by how much each tooth stands beyond its place", Value("an angle", "angle", lower=None),
               form="a list of angles"), ()
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class RadialVibration(Declared):
    """Vibration of the centre of a wheel, which a pickup reads as a rotation of displacement over radius.

    The displacement is amplitude cos(order phi + 2 pi frequency t + phase), phi the angle of the reference shaft.

    Examples
    --------
    >>> RadialVibration(amplitude="0.05 mm", order=1).amplitude
    5e-05
    """

    kind: ClassVar[str] = "radial vibration"

    amplitude: float = entry(Value("peak displacement of the centre", "length"))
    order: float | None = entry(Value("vibrations per revolution of the reference shaft", "1", exclusive=True), None)
    frequency: float | None = entry(Value("instead: fixed frequency", "frequency", exclusive=True), None)
    phase: float = entry(Value("phase where phi and time are 0", "angle", lower=None), 0.0)
    direction: float = entry(
        Value("direction of the displacement, from the pickup at 0 in the sense of rotation", "angle", lower=None),
        math.pi / 2,
    )

    def contradictions(self) -> list[Fault]:
        if (self.order is None) != (self.frequency is None):
            return []
        text = f"a radial vibration has an order or a frequency; here is {'both' if self.order else 'neither'}"
        kind = "contradicting-entries" if self.order else "missing-entry"
        return [Fault(text, ("order",) if self.order else (), on_key=True, kind=kind)]


@dataclass(frozen=True, kw_only=True)
class ToothedWheel(Declared):
    """A toothed wheel with a pickup, whose pulses a counter stamps; a channel of pulse times.

    Tooth k passes the pickup where the wheel's angle, positive in its sense of rotation, is 2 pi k/teeth plus the error
    of its place plus the pickup's angle. Channels with ``wheel`` are further pickups on the wheel of another channel.

    Examples
    --------
    >>> wheel = ToothedWheel(teeth=60, pitch_errors={"uniform": "5 %"}, tick="12.5 ns")
    >>> wheel.tick
    1.25e-08
    """

    kind: ClassVar[str] = "toothed wheel"
    article: ClassVar[str] = "a toothed wheel"

    sensor: str | None = entry(ChannelName(SENSED), None)
    wheel: str = entry(RecordedName("channel of the wheel's first pickup, of a further pickup on it"), "")
    teeth: int | None = entry(Count("teeth on the circumference, missing ones included", upper=100_000), None)
    missing_teeth: int = entry(Count("teeth that the gap lacks, the last ones of a turn", lower=0, upper=1000), 0)
    gearing: float = entry(
        Value("turns of the wheel per turn of its node, as 0.5 of a camshaft", "1", exclusive=True), 1.0
    )
    mounting: float = entry(
        Value("angle of the wheel where that of its node is 0, in its sense of rotation", "angle", lower=None), 0.0
    )
    pitch_errors: PitchErrors = entry(
        Nested("errors of the places of the teeth", lambda: PitchErrors, "bench_pitch_errors"), PitchErrors()
    )
    radius: float | None = entry(Value("radius at the tips of the teeth", "length", exclusive=True), None)
    radial_vibration: RadialVibration | None = entry(
        Nested("vibration of the wheel's centre", lambda: RadialVibration, "bench_radial_vibration"), None
    )
    pickup_angle: float = entry(
        Value("place of the pickup in the sense of rotation, so that a tooth passes it later", "angle", lower=None), 0.0
    )
    index: bool = entry(
        Flag("whether a pulse per turn is recorded, too, as NAME_index, at the place of tooth 0"), False
    )
    missing_pulses: float = entry(Value("share of the pulses that are lost", "1", below=0.5), 0.0)
    double_pulses: float = entry(Value("share of the pulses followed by a second one", "1", below=0.5), 0.0)
    jitter: float = entry(Value("standard deviation of the time of a pulse", "time"), 0.0)
    tick: float = entry(Value("step of the counter, to which times are rounded down", "time"), 0.0)

    def contradictions(self) -> list[Fault]:
        if self.wheel:
            defaults = type(self).defaults()
            own = [name for name in OWN_ENTRIES if getattr(self, name) != defaults[name]]
            text = f"a further pickup takes it from the wheel of {self.wheel}; leave it out"
            return [Fault(text, (name,), on_key=True, kind="needless-entry") for name in own]
        faults = []
        if not self.teeth:
            text = "a toothed wheel needs teeth: 60, or wheel: the channel of the wheel's first pickup"
            faults.append(Fault(text, on_key=True, kind="missing-entry", about="teeth"))
        elif self.missing_teeth and self.missing_teeth >= self.teeth - 1:
            text = f"a wheel of {self.teeth} teeth cannot lack {self.missing_teeth}"
            faults.append(Fault(text, ("missing_teeth",), kind="contradicting-values"))
        if self.teeth and self.pitch_errors.list and len(self.pitch_errors.list) != self.teeth:
            text = f"{len(self.pitch_errors.list)} places do not fit a wheel of {self.teeth} teeth"
            faults.append(Fault(text, ("pitch_errors", "list"), kind="wrong-count"))
        if self.radial_vibration is not None and self.radius is None:
            text = "a radial vibration reads as displacement over radius; give the radius"
            faults.append(Fault(text, ("radial_vibration",), on_key=True, kind="missing-entry"))
        return faults

"""Entries of a toothed wheel on a bench that turns: teeth and their errors, pickups, the counter of its pulses."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import Listed, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, Flag, entry
from torsionnet.base.errors import MISSING_KEY, Fault
from torsionnet.model.channels import ChannelName, RecordedName

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
        return [Fault(text, ("order",) if self.order else (), on_key=True)]


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
            return [Fault(text, (name,), on_key=True) for name in own]
        found = []
        if not self.teeth:
            text = "a toothed wheel needs teeth: 60, or wheel: the channel of the wheel's first pickup"
            found.append(Fault(text, on_key=True, kind=MISSING_KEY, about="teeth"))
        elif self.missing_teeth and self.missing_teeth >= self.teeth - 1:
            text = f"a wheel of {self.teeth} teeth cannot lack {self.missing_teeth}"
            found.append(Fault(text, ("missing_teeth",)))
        if self.teeth and self.pitch_errors.list and len(self.pitch_errors.list) != self.teeth:
            text = f"{len(self.pitch_errors.list)} places do not fit a wheel of {self.teeth} teeth"
            found.append(Fault(text, ("pitch_errors", "list")))
        if self.radial_vibration is not None and self.radius is None:
            text = "a radial vibration reads as displacement over radius; give the radius"
            found.append(Fault(text, ("radial_vibration",), on_key=True))
        return found

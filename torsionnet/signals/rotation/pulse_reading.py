"""Entries on what a channel of pulses holds: counts of a counter, of which clock, times, or the signal of teeth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import AnyNumber, Value
from torsionnet.base.entries.spec import Count, OneOf, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.signals.pulse_train import HYSTERESIS

SIGNAL_ENTRIES = ("level", "hysteresis", "edge", "pickup", "second")
"""Entries of a reading that describe the signal of teeth, which a counter does not have."""

WIDEST_COUNTER = 64
"""Most bits of a counter of pulses; wider ones are not built."""


@dataclass(frozen=True, kw_only=True)
class PulseReading(Declared):
    """Reading of the values of a channel of pulses: counts of a clock, which may wrap, times, or the signal of teeth.

    Without ``tick`` and ``clock`` the values are times of pulses in the unit of the channel.

    Examples
    --------
    >>> PulseReading(clock="80 MHz", bits=32).seconds
    1.25e-08
    >>> PulseReading(tick="12.5 ns").seconds
    1.25e-08
    """

    kind: ClassVar[str] = "pulse reading"
    article: ClassVar[str] = "a pulse reading"

    tick: float | None = entry(Value("time of one count of the counter", "time", exclusive=True), None)
    clock: float | None = entry(Value("instead: frequency that the counter counts", "frequency", exclusive=True), None)
    bits: int | None = entry(
        Count("width of the counter in bits, which begins at 0 again when it is full", lower=4, upper=WIDEST_COUNTER),
        None,
    )

    level: float | None = entry(AnyNumber("value that a tooth signal passes, in its unit; default: the middle"), None)
    hysteresis: float = entry(
        Value("share of its height by which a tooth signal must pass on either side", "1", exclusive=True, below=0.5),
        HYSTERESIS,
    )
    edge: str = entry(OneOf("which flanks of a tooth signal are pulses", ("rising", "falling")), "rising")
    pickup: str = entry(
        OneOf("whether a tooth signal switches, or grows with the speed", ("switching", "inductive")), "switching"
    )
    second: str = entry(Text("channel of a second track a quarter pitch further, which tells the direction"), "")

    def contradictions(self) -> list[Fault]:
        if self.tick is not None and self.clock is not None:
            return [Fault("tick and clock say the same thing; leave one out", ("clock",))]
        if self.bits is not None and self.tick is None and self.clock is None:
            return [Fault("a counter of so many bits needs the time of its tick, or its clock", ("bits",))]
        if self.seconds is not None and self.is_of_a_signal:
            return [Fault("a counter has no level, hysteresis, edge, pickup or second track", ("tick",))]
        return []

    @property
    def is_of_a_signal(self) -> bool:
        """Whether an entry is given that only the signal of teeth has, as its level."""
        return any(getattr(self, name) != self.defaults()[name] for name in SIGNAL_ENTRIES)

    @property
    def seconds(self) -> float | None:
        """Time of one count in s, None where the values are times."""
        return 1 / self.clock if self.clock is not None else self.tick

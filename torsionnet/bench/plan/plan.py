"""Plan of a bench test, with its excitation, exciter, channels and data acquisition."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar, TypeAlias

from torsionnet.base.entries.composite import Named, Nested, Typed
from torsionnet.base.entries.declared import KEY, Declared
from torsionnet.base.entries.spec import MODEL_NAME, Count, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.bench.plan.bench_motions import MOTIONS, BenchMotion
from torsionnet.bench.plan.parts import (
    Acquisition,
    Encoder,
    Exciter,
    RecordingSystem,
    StrainGauge,
    ToothedWheel,
    Transducer,
)
from torsionnet.model.channels import RecordedName
from torsionnet.model.configurations import ConfigurationName
from torsionnet.signals.excitation import (
    BurstRandom,
    Excitation,
    LinearChirp,
    LoadCycles,
    LogarithmicSweep,
    Multisine,
    SteppedSine,
)

SWEEP = "{type: linear chirp, start: 0.1 Hz, stop: 80 Hz, duration: 100 s, amplitude: 15 N*m}"
"""Example of a bench's excitation, for the message that it is missing."""
CHANNELS = "{name of a sensor: {type: encoder, lines: 1024}, ...}"
"""Example of a bench's channels, for the message that they are missing."""
RUN_UP = "{type: run-up, start: 300 rpm, stop: 750 rpm, duration: 60 s}"
"""Example of a bench's motion, for the message that it is missing."""
_MOTION = Typed("how the drivetrain turns", lambda: MOTIONS, "motion", "bench_motion", shown=RUN_UP)
_SYSTEM = Nested("a further recording system", lambda: RecordingSystem, "bench_system")
_EXCITATION = Typed("what the torque is to be", lambda: EXCITATIONS, "excitation", "bench_excitation", shown=SWEEP)
_CHANNEL = Typed("a sensor and its errors", lambda: SENSORS, "sensor", "bench_channel")
_CHANNEL_NAME = RecordedName("a sensor, or a channel with a sensor of its own")
_EXCITER = Nested("the motor that shakes", lambda: Exciter, "bench_exciter")
_ACQUISITION = Nested("sampling of all channels", lambda: Acquisition, "bench_acquisition", shown="{rate: 10 kHz}")


EXCITATIONS: dict[str, type[Excitation]] = {
    cls.kind: cls for cls in (LinearChirp, LogarithmicSweep, SteppedSine, LoadCycles, Multisine, BurstRandom)
}
"""Class of each type of excitation on a bench, by the word in ``type:``."""
Sensing: TypeAlias = Transducer | Encoder | ToothedWheel
"""Type of the entries of a channel of a bench, by what it is read."""
SENSORS: dict[str, type[Sensing]] = {cls.kind: cls for cls in (Transducer, StrainGauge, Encoder, ToothedWheel)}
"""Class of each type of sensor on a bench, by the word in ``type:``."""


@dataclass(frozen=True, kw_only=True)
class Plan(Declared):
    """A test: what drives the drivetrain, what is measured, and how it is recorded.

    Attributes
    ----------
    excitation : Excitation, optional
        Set-point of the torque that shakes the drivetrain.
    motion : BenchMotion, optional
        Instead: how the drivetrain turns under the excitations of its model.
    channels : mapping of str to Transducer, StrainGauge, Encoder or ToothedWheel
        By the name of a sensor of the model, or of any other name with a ``sensor`` of its own.
    acquisition : Acquisition
    exciter : Exciter, optional
        By default delivers its set-point exactly.
    drive : str, optional
        Input of the model on which the torque acts; by default the only one there is.
    seed : int, optional
        Of noise and of the encoders' starting positions; the same seed gives the same record.
    systems : mapping of str to RecordingSystem
        Further recording systems by name, with the channels that they record.
    """

    kind: ClassVar[str] = "bench"
    article: ClassVar[str] = "a bench"
    form: ClassVar[str] = "the entries drive, excitation, motion, exciter, channels, acquisition, seed"

    drive: str = entry(RecordedName("input on which the torque acts, if there are several"), "")
    excitation: Excitation | None = entry(_EXCITATION, None)
    motion: BenchMotion | None = entry(_MOTION, None)
    exciter: Exciter = entry(_EXCITER, Exciter())
    channels: Mapping[str, Sensing] = entry(
        Named("what is recorded, by the name of a sensor", _CHANNEL, form=CHANNELS, fewest=1, keys=_CHANNEL_NAME)
    )
    acquisition: Acquisition = entry(_ACQUISITION)
    seed: int = entry(Count("the same seed gives the same record", lower=0, upper=2**32 - 1), 0)
    systems: Mapping[str, RecordingSystem] = entry(
        Named("further recording systems, by name", _SYSTEM, form="{telemetry: {channels: [T_int], drift: 50 ppm}}"),
        None,
    )

    def contradictions(self) -> list[Fault]:
        if self.excitation is None and self.motion is None:
            text = f"a bench needs excitation: {SWEEP}, which shakes, or motion: {RUN_UP}, which turns"
            return [Fault(text, on_key=True, kind="missing-entry", about="excitation")]
        if self.motion is None:
            return list(self._of_motion_only())
        faults = []
        if self.excitation is not None:
            faults.append(
                Fault(
                    "a bench shakes by excitation: or turns by motion:; leave one out",
                    ("motion",),
                    kind="contradicting-entries",
                )
            )
        if self.drive:
            faults.append(
                Fault(
                    "drive: belongs to excitation:; a bench that turns has none",
                    ("drive",),
                    on_key=True,
                    kind="needless-entry",
                )
            )
        return faults

    def _of_motion_only(self) -> Iterator[Fault]:
        for name, part in self.channels.items():
            if isinstance(part, ToothedWheel):
                yield Fault(
                    "a toothed wheel gives pulses where it turns; give motion:",
                    ("channels", name),
                    on_key=True,
                    kind="missing-entry",
                )
        if self.systems:
            yield Fault("systems: belong to a bench with motion:", ("systems",), on_key=True, kind="needless-entry")


# Bench file, which names a model and describes a test of it.

_PLAN = Nested("a virtual test: excitation, exciter, sensors, data acquisition", lambda: Plan, "bench")


@dataclass(frozen=True, kw_only=True)
class BenchFile(Declared):
    """A test bench that names its model."""

    kind: ClassVar[str] = "bench file"
    article: ClassVar[str] = "a bench file"
    head: ClassVar[tuple[str, ...]] = (KEY,)

    name: str = entry(Text("title of the test"), "")
    source: str = entry(Text("where the numbers come from"), "")
    description: str = entry(Text("what the test is"), "")
    model: str = entry(
        Text("name of a library model, or path of a model file from the folder of this file", MODEL_NAME)
    )
    configuration: str | None = entry(ConfigurationName("configuration in which the model is tested"), None)
    bench: Plan = entry(_PLAN)

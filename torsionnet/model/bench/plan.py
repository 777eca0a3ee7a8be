"""Plan of a bench test, with its excitation, exciter, channels and data acquisition."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.core.entries.composite import Named, Nested, Typed
from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.spec import entry
from torsionnet.core.entries.words import Count, Text
from torsionnet.model.bench.parts import SENSORS, Acquisition, Encoder, Exciter, Transducer
from torsionnet.signals.excitation import BurstRandom, LinearChirp, LogarithmicSweep, Multisine, SteppedSine
from torsionnet.signals.excitation.excitation import Excitation

SWEEP = "{type: linear chirp, start: 0.1 Hz, stop: 80 Hz, duration: 100 s, amplitude: 15 N*m}"
"""Example of a bench's excitation, for the message that it is missing."""
CHANNELS = "{name of a sensor: {type: encoder, lines: 1024}, ...}"
"""Example of a bench's channels, for the message that they are missing."""
_EXCITATION = Typed("what the torque is to be", lambda: EXCITATIONS, "excitation", "bench_excitation", shown=SWEEP)
_CHANNEL = Typed("a sensor and its errors", lambda: SENSORS, "sensor", "bench_channel")
_EXCITER = Nested("the motor that shakes", lambda: Exciter, "bench_exciter")
_ACQUISITION = Nested("sampling of all channels", lambda: Acquisition, "bench_acquisition", shown="{rate: 10 kHz}")


EXCITATIONS: dict[str, type[Excitation]] = {
    cls.kind: cls for cls in (LinearChirp, LogarithmicSweep, SteppedSine, Multisine, BurstRandom)
}
"""Class of each type of excitation on a bench, by the word in ``type:``."""


@dataclass(frozen=True, kw_only=True)
class Plan(Declared):
    """A test: what drives the drivetrain, what is measured, and how it is recorded.

    Attributes
    ----------
    excitation : Excitation
        Set-point of the torque.
    channels : mapping of str to Transducer or Encoder
        By the name of a sensor of the model, or of any other name with a ``sensor`` of its own.
    acquisition : Acquisition
    exciter : Exciter, optional
        By default delivers its set-point exactly.
    drive : str, optional
        Input of the model on which the torque acts; by default the only one there is.
    seed : int, optional
        Of noise and of the encoders' starting positions; the same seed gives the same record.
    """

    kind: ClassVar[str] = "bench"
    article: ClassVar[str] = "a bench"
    form: ClassVar[str] = "the entries drive, excitation, exciter, channels, acquisition, seed"

    drive: str = entry(Text("input on which the torque acts, if there are several"), "")
    excitation: Excitation = entry(_EXCITATION)
    exciter: Exciter = entry(_EXCITER, Exciter())
    channels: Mapping[str, Transducer | Encoder] = entry(
        Named("what is recorded, by the name of a sensor", _CHANNEL, form=CHANNELS, fewest=1)
    )
    acquisition: Acquisition = entry(_ACQUISITION)
    seed: int = entry(Count("the same seed gives the same record", lower=0, upper=2**32 - 1), 0)

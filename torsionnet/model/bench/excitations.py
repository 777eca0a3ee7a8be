"""What the torque of a bench may be."""

from __future__ import annotations

from torsionnet.signals.excitation import BurstRandom, LinearChirp, LogarithmicSweep, Multisine, SteppedSine
from torsionnet.signals.excitation.excitation import Excitation

EXCITATIONS: dict[str, type[Excitation]] = {
    cls.kind: cls for cls in (LinearChirp, LogarithmicSweep, SteppedSine, Multisine, BurstRandom)
}

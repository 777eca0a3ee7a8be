"""Test signals to excite a drivetrain with (sweeps, stepped sines, multisines, bursts of noise)."""

from torsionnet.signals.excitation.broadband import BurstRandom, Multisine
from torsionnet.signals.excitation.excitation import Excitation
from torsionnet.signals.excitation.sweeps import LinearChirp, LogarithmicSweep, SteppedSine

__all__ = ["BurstRandom", "Excitation", "LinearChirp", "LogarithmicSweep", "Multisine", "SteppedSine"]

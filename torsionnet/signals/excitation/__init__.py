"""Signals to drive a test with, sweeps, stepped sines, multisines and bursts of noise."""

from torsionnet.signals.excitation.broadband import BurstRandom, Multisine
from torsionnet.signals.excitation.excitation import Excitation
from torsionnet.signals.excitation.sweeps import LinearChirp, LogarithmicSweep, SteppedSine

__all__ = ["BurstRandom", "Excitation", "LinearChirp", "LogarithmicSweep", "Multisine", "SteppedSine"]

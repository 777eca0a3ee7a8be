"""Recorded and simulated signals: records, processing, and the frequency responses estimated from them."""

from torsionnet.signals.advice import resolution_limit
from torsionnet.signals.comparison import Difference, difference, frac
from torsionnet.signals.decimation import decimate
from torsionnet.signals.estimators import estimate
from torsionnet.signals.excitation import BurstRandom, LinearChirp, LogarithmicSweep, Multisine, SteppedSine
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.spectrogram import Spectrogram, spectrogram
from torsionnet.signals.welch import PAPER, Welch

__all__ = [
    "PAPER",
    "BurstRandom",
    "Difference",
    "LinearChirp",
    "LogarithmicSweep",
    "Multisine",
    "Recording",
    "Signal",
    "Spectrogram",
    "SteppedSine",
    "Welch",
    "decimate",
    "difference",
    "estimate",
    "frac",
    "resolution_limit",
    "spectrogram",
]

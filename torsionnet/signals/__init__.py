"""Recorded and simulated signals: records, processing, and the frequency responses estimated from them."""

from torsionnet.signals.advice import resolution_limit
from torsionnet.signals.checks import check_recording
from torsionnet.signals.comparison import Difference, difference, frac
from torsionnet.signals.decimation import decimate
from torsionnet.signals.encoder import MissingPulses, angle_from_counts, angle_from_pulses, missing_pulses, unwrapped
from torsionnet.signals.estimators import estimate
from torsionnet.signals.excitation import BurstRandom, LinearChirp, LogarithmicSweep, Multisine, SteppedSine
from torsionnet.signals.files import iter_blocks, read_recording, write_recording
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.resampling import resampled
from torsionnet.signals.spectrogram import Spectrogram, spectrogram
from torsionnet.signals.welch import PAPER, Welch

__all__ = [
    "PAPER",
    "BurstRandom",
    "Difference",
    "LinearChirp",
    "LogarithmicSweep",
    "MissingPulses",
    "Multisine",
    "Recording",
    "Signal",
    "Spectrogram",
    "SteppedSine",
    "Welch",
    "angle_from_counts",
    "angle_from_pulses",
    "check_recording",
    "decimate",
    "difference",
    "estimate",
    "frac",
    "iter_blocks",
    "missing_pulses",
    "read_recording",
    "resampled",
    "resolution_limit",
    "spectrogram",
    "unwrapped",
    "write_recording",
]

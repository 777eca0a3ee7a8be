"""Recorded and simulated signals: records, processing, and the frequency responses estimated from them."""

from __future__ import annotations

from torsionnet.core.lazy import names_on_demand
from torsionnet.response.recording import Recording, Signal
from torsionnet.signals.advice import resolution_limit
from torsionnet.signals.calculus import convert, differentiate, integrate
from torsionnet.signals.comparison import Difference, difference, frac
from torsionnet.signals.decimation import decimate
from torsionnet.signals.encoder import angle_from_counts, angle_from_pulses, unwrapped
from torsionnet.signals.estimators import estimate, multiple_coherence
from torsionnet.signals.excitation import BurstRandom, LinearChirp, LogarithmicSweep, Multisine, SteppedSine
from torsionnet.signals.harmonics import Harmonics, sweep_harmonics
from torsionnet.signals.order_tracking import OrderMap, order_map
from torsionnet.signals.pulses import MissingPulses, Pulses, missing_pulses, repaired_pulses
from torsionnet.signals.recording_checks import check_recording
from torsionnet.signals.resampling import resampled
from torsionnet.signals.resolution import Resolution, resolution
from torsionnet.signals.single_tests import Step, full_record, stepped_sine
from torsionnet.signals.spectra import cross_spectra
from torsionnet.signals.spectral_matrix import CrossSpectra
from torsionnet.signals.spectrogram import Spectrogram, spectrogram
from torsionnet.signals.uncertainty import RandomError, random_error, random_errors
from torsionnet.signals.welch import PAPER, Welch

__all__ = [
    "PAPER",
    "BurstRandom",
    "CrossSpectra",
    "Difference",
    "Harmonics",
    "LinearChirp",
    "LogarithmicSweep",
    "MissingPulses",
    "Multisine",
    "OrderMap",
    "Pulses",
    "RandomError",
    "Recording",
    "Resolution",
    "Signal",
    "Spectrogram",
    "Step",
    "SteppedSine",
    "Welch",
    "angle_from_counts",
    "angle_from_pulses",
    "check_recording",
    "convert",
    "cross_spectra",
    "decimate",
    "difference",
    "differentiate",
    "estimate",
    "frac",
    "full_record",
    "integrate",
    "iter_blocks",
    "missing_pulses",
    "multiple_coherence",
    "order_map",
    "random_error",
    "random_errors",
    "read_recording",
    "repaired_pulses",
    "resampled",
    "resolution",
    "resolution_limit",
    "spectrogram",
    "stepped_sine",
    "sweep_harmonics",
    "unwrapped",
    "write_recording",
]

# Files are read in a layer above this one, which knows no files; the names have their place here all the same.
__getattr__ = names_on_demand(
    __name__, dict.fromkeys(("iter_blocks", "read_recording", "write_recording"), "torsionnet.io.recording_files")
)

# Written by `make generate`.
from torsionnet.entry_classes import BurstRandom as BurstRandom
from torsionnet.entry_classes import LinearChirp as LinearChirp
from torsionnet.entry_classes import LogarithmicSweep as LogarithmicSweep
from torsionnet.entry_classes import Multisine as Multisine
from torsionnet.entry_classes import SteppedSine as SteppedSine
from torsionnet.io.recording_files import iter_blocks as iter_blocks
from torsionnet.io.recording_files import read_recording as read_recording
from torsionnet.io.recording_files import write_recording as write_recording
from torsionnet.response.recording import Recording as Recording
from torsionnet.response.recording import Signal as Signal
from torsionnet.signals.advice import resolution_limit as resolution_limit
from torsionnet.signals.calculus import convert as convert
from torsionnet.signals.calculus import differentiate as differentiate
from torsionnet.signals.calculus import integrate as integrate
from torsionnet.signals.comparison import Difference as Difference
from torsionnet.signals.comparison import difference as difference
from torsionnet.signals.comparison import frac as frac
from torsionnet.signals.decimation import decimate as decimate
from torsionnet.signals.encoder import angle_from_counts as angle_from_counts
from torsionnet.signals.encoder import angle_from_pulses as angle_from_pulses
from torsionnet.signals.encoder import unwrapped as unwrapped
from torsionnet.signals.estimators import estimate as estimate
from torsionnet.signals.estimators import multiple_coherence as multiple_coherence
from torsionnet.signals.harmonics import Harmonics as Harmonics
from torsionnet.signals.harmonics import sweep_harmonics as sweep_harmonics
from torsionnet.signals.order_tracking import OrderMap as OrderMap
from torsionnet.signals.order_tracking import order_map as order_map
from torsionnet.signals.pulses import MissingPulses as MissingPulses
from torsionnet.signals.pulses import Pulses as Pulses
from torsionnet.signals.pulses import missing_pulses as missing_pulses
from torsionnet.signals.pulses import repaired_pulses as repaired_pulses
from torsionnet.signals.recording_checks import check_recording as check_recording
from torsionnet.signals.resampling import resampled as resampled
from torsionnet.signals.resolution import Resolution as Resolution
from torsionnet.signals.resolution import resolution as resolution
from torsionnet.signals.spectra import cross_spectra as cross_spectra
from torsionnet.signals.spectral_matrix import CrossSpectra as CrossSpectra
from torsionnet.signals.spectrogram import Spectrogram as Spectrogram
from torsionnet.signals.spectrogram import spectrogram as spectrogram
from torsionnet.signals.unaveraged_estimates import Step as Step
from torsionnet.signals.unaveraged_estimates import full_record as full_record
from torsionnet.signals.unaveraged_estimates import stepped_sine as stepped_sine
from torsionnet.signals.uncertainty import RandomError as RandomError
from torsionnet.signals.uncertainty import random_error as random_error
from torsionnet.signals.uncertainty import random_errors as random_errors
from torsionnet.signals.welch import PAPER as PAPER
from torsionnet.signals.welch import Welch as Welch

__all__ = [
    "BurstRandom",
    "CrossSpectra",
    "Difference",
    "Harmonics",
    "LinearChirp",
    "LogarithmicSweep",
    "MissingPulses",
    "Multisine",
    "OrderMap",
    "PAPER",
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

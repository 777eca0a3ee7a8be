# Written by `make generate`.
from torsionnet.entry_classes import BurstRandom as BurstRandom
from torsionnet.entry_classes import LinearChirp as LinearChirp
from torsionnet.entry_classes import LogarithmicSweep as LogarithmicSweep
from torsionnet.entry_classes import Multisine as Multisine
from torsionnet.entry_classes import PulseReading as PulseReading
from torsionnet.entry_classes import SteppedSine as SteppedSine
from torsionnet.entry_classes import Wheel as Wheel
from torsionnet.entry_classes import WheelChannel as WheelChannel
from torsionnet.io.wheel_files import read_wheels as read_wheels
from torsionnet.linear.between_samples import BetweenSamples as BetweenSamples
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
from torsionnet.signals.estimators import Step as Step
from torsionnet.signals.estimators import estimate as estimate
from torsionnet.signals.estimators import full_record as full_record
from torsionnet.signals.estimators import multiple_coherence as multiple_coherence
from torsionnet.signals.estimators import stepped_sine as stepped_sine
from torsionnet.signals.order_tracking import Harmonics as Harmonics
from torsionnet.signals.order_tracking import OrderMap as OrderMap
from torsionnet.signals.order_tracking import order_map as order_map
from torsionnet.signals.order_tracking import sweep_harmonics as sweep_harmonics
from torsionnet.signals.orders.cycle_average import CycleAverage as CycleAverage
from torsionnet.signals.orders.mean_rotation import MeanRotation as MeanRotation
from torsionnet.signals.orders.mean_rotation import PhaseReference as PhaseReference
from torsionnet.signals.orders.mean_rotation import mean_rotation as mean_rotation
from torsionnet.signals.orders.mean_rotation import phase_reference as phase_reference
from torsionnet.signals.orders.track_orders import PhaseMark as PhaseMark
from torsionnet.signals.orders.track_orders import orders_of_test as orders_of_test
from torsionnet.signals.orders.track_orders import track_orders as track_orders
from torsionnet.signals.orders.tracked_orders import MeasuredOrder as MeasuredOrder
from torsionnet.signals.orders.tracked_orders import TrackedOrders as TrackedOrders
from torsionnet.signals.orders.tracked_orders import TrackingKernel as TrackingKernel
from torsionnet.signals.orders.tracked_signals import Twist as Twist
from torsionnet.signals.orders.vold_kalman import VoldKalman as VoldKalman
from torsionnet.signals.pulses import MissingPulses as MissingPulses
from torsionnet.signals.pulses import Pulses as Pulses
from torsionnet.signals.pulses import missing_pulses as missing_pulses
from torsionnet.signals.pulses import repaired_pulses as repaired_pulses
from torsionnet.signals.recording import Recording as Recording
from torsionnet.signals.recording import Signal as Signal
from torsionnet.signals.recording_checks import check_recording as check_recording
from torsionnet.signals.records.recording_files import iter_blocks as iter_blocks
from torsionnet.signals.records.recording_files import read_recording as read_recording
from torsionnet.signals.records.recording_files import write_recording as write_recording
from torsionnet.signals.resampling import interpolated_at as interpolated_at
from torsionnet.signals.resampling import resampled as resampled
from torsionnet.signals.rotation.calibration_result import WheelCalibration as WheelCalibration
from torsionnet.signals.rotation.clock_drift import ClockDrift as ClockDrift
from torsionnet.signals.rotation.clock_drift import on_first_clock as on_first_clock
from torsionnet.signals.rotation.clock_drift import rotation_clocks as rotation_clocks
from torsionnet.signals.rotation.clock_drift import signal_clocks as signal_clocks
from torsionnet.signals.rotation.counter import lowest_speed as lowest_speed
from torsionnet.signals.rotation.counter import pulse_channel as pulse_channel
from torsionnet.signals.rotation.pitch_order import CalculatedOrders as CalculatedOrders
from torsionnet.signals.rotation.pitch_order import PitchOrder as PitchOrder
from torsionnet.signals.rotation.pitch_order import pickup_gains as pickup_gains
from torsionnet.signals.rotation.pulse_channel import PulseChannel as PulseChannel
from torsionnet.signals.rotation.quadrature import DirectedPulses as DirectedPulses
from torsionnet.signals.rotation.quadrature import quadrature_pulses as quadrature_pulses
from torsionnet.signals.rotation.rotations_of_wheels import angle_record as angle_record
from torsionnet.signals.rotation.rotations_of_wheels import iter_wheel_rotations as iter_wheel_rotations
from torsionnet.signals.rotation.rotations_of_wheels import phase_between as phase_between
from torsionnet.signals.rotation.rotations_of_wheels import rotations_of_wheels as rotations_of_wheels
from torsionnet.signals.rotation.rotations_of_wheels import tooth_by_difference as tooth_by_difference
from torsionnet.signals.rotation.wheel import WheelPattern as WheelPattern
from torsionnet.signals.rotation.wheel_calibration import WheelTest as WheelTest
from torsionnet.signals.rotation.wheel_calibration import calibrate_wheel as calibrate_wheel
from torsionnet.signals.rotation.wheel_channel import wheel_pulses as wheel_pulses
from torsionnet.signals.rotation.wheel_rotation import WheelRotation as WheelRotation
from torsionnet.signals.rotation.wheel_rotation import wheel_rotation as wheel_rotation
from torsionnet.signals.spectra import CrossSpectra as CrossSpectra
from torsionnet.signals.spectra import Spectrogram as Spectrogram
from torsionnet.signals.spectra import cross_spectra as cross_spectra
from torsionnet.signals.spectra import spectrogram as spectrogram
from torsionnet.signals.uncertainty import RandomError as RandomError
from torsionnet.signals.uncertainty import Resolution as Resolution
from torsionnet.signals.uncertainty import random_error as random_error
from torsionnet.signals.uncertainty import random_errors as random_errors
from torsionnet.signals.uncertainty import resolution as resolution
from torsionnet.signals.uncertainty import resolution_limit as resolution_limit
from torsionnet.signals.welch import PAPER as PAPER
from torsionnet.signals.welch import Welch as Welch

__all__ = [
    "BetweenSamples",
    "BurstRandom",
    "CalculatedOrders",
    "ClockDrift",
    "CrossSpectra",
    "CycleAverage",
    "Difference",
    "DirectedPulses",
    "Harmonics",
    "LinearChirp",
    "LogarithmicSweep",
    "MeanRotation",
    "MeasuredOrder",
    "MissingPulses",
    "Multisine",
    "OrderMap",
    "PAPER",
    "PhaseMark",
    "PhaseReference",
    "PitchOrder",
    "PulseChannel",
    "PulseReading",
    "Pulses",
    "RandomError",
    "Recording",
    "Resolution",
    "Signal",
    "Spectrogram",
    "Step",
    "SteppedSine",
    "TrackedOrders",
    "TrackingKernel",
    "Twist",
    "VoldKalman",
    "Welch",
    "Wheel",
    "WheelCalibration",
    "WheelChannel",
    "WheelPattern",
    "WheelRotation",
    "WheelTest",
    "angle_from_counts",
    "angle_from_pulses",
    "angle_record",
    "calibrate_wheel",
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
    "interpolated_at",
    "iter_blocks",
    "iter_wheel_rotations",
    "lowest_speed",
    "mean_rotation",
    "missing_pulses",
    "multiple_coherence",
    "on_first_clock",
    "order_map",
    "orders_of_test",
    "phase_between",
    "phase_reference",
    "pickup_gains",
    "pulse_channel",
    "quadrature_pulses",
    "random_error",
    "random_errors",
    "read_recording",
    "read_wheels",
    "repaired_pulses",
    "resampled",
    "resolution",
    "resolution_limit",
    "rotation_clocks",
    "rotations_of_wheels",
    "signal_clocks",
    "spectrogram",
    "stepped_sine",
    "sweep_harmonics",
    "tooth_by_difference",
    "track_orders",
    "unwrapped",
    "wheel_pulses",
    "wheel_rotation",
    "write_recording",
]

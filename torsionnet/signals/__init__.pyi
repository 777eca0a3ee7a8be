# Written by `make generate`.
from torsionnet.entry_classes import BurstRandom as BurstRandom
from torsionnet.entry_classes import LinearChirp as LinearChirp
from torsionnet.entry_classes import PulseReading as PulseReading
from torsionnet.entry_classes import Wheel as Wheel
from torsionnet.signals.comparison import difference as difference
from torsionnet.signals.comparison import frac as frac
from torsionnet.signals.encoder import angle_from_pulses as angle_from_pulses
from torsionnet.signals.encoder import unwrapped as unwrapped
from torsionnet.signals.estimators import Step as Step
from torsionnet.signals.estimators import estimate as estimate
from torsionnet.signals.estimators import stepped_sine as stepped_sine
from torsionnet.signals.orders.cycle_average import CycleAverage as CycleAverage
from torsionnet.signals.orders.mean_rotation import PhaseReference as PhaseReference
from torsionnet.signals.orders.mean_rotation import mean_rotation as mean_rotation
from torsionnet.signals.orders.track_orders import track_orders as track_orders
from torsionnet.signals.orders.tracked_orders import MeasuredOrder as MeasuredOrder
from torsionnet.signals.orders.tracked_signals import Twist as Twist
from torsionnet.signals.orders.vold_kalman import VoldKalman as VoldKalman
from torsionnet.signals.pulses import repaired_pulses as repaired_pulses
from torsionnet.signals.recording import Recording as Recording
from torsionnet.signals.recording import Signal as Signal
from torsionnet.signals.recording_checks import check_recording as check_recording
from torsionnet.signals.records.recording_files import iter_blocks as iter_blocks
from torsionnet.signals.records.recording_files import read_recording as read_recording
from torsionnet.signals.records.recording_files import write_recording as write_recording
from torsionnet.signals.resampling import decimate as decimate
from torsionnet.signals.resampling import resampled as resampled
from torsionnet.signals.rotation.clock_drift import on_first_clock as on_first_clock
from torsionnet.signals.rotation.clock_drift import rotation_clocks as rotation_clocks
from torsionnet.signals.rotation.clock_drift import signal_clocks as signal_clocks
from torsionnet.signals.rotation.counter import lowest_speed as lowest_speed
from torsionnet.signals.rotation.counter import pulse_channel as pulse_channel
from torsionnet.signals.rotation.pitch_order import CalculatedOrders as CalculatedOrders
from torsionnet.signals.rotation.pitch_order import pickup_gains as pickup_gains
from torsionnet.signals.rotation.pulse_channel import PulseChannel as PulseChannel
from torsionnet.signals.rotation.rotations_of_wheels import iter_wheel_rotations as iter_wheel_rotations
from torsionnet.signals.rotation.wheel import WheelPattern as WheelPattern
from torsionnet.signals.rotation.wheel_calibration import WheelTest as WheelTest
from torsionnet.signals.rotation.wheel_calibration import calibrate_wheel as calibrate_wheel
from torsionnet.signals.rotation.wheel_rotation import wheel_rotation as wheel_rotation
from torsionnet.signals.spectra import spectrogram as spectrogram
from torsionnet.signals.torque_loops.loops import loops as loops
from torsionnet.signals.uncertainty import resolution_limit as resolution_limit
from torsionnet.signals.welch import PAPER as PAPER
from torsionnet.signals.welch import Welch as Welch

__all__ = [
    "BurstRandom",
    "CalculatedOrders",
    "CycleAverage",
    "LinearChirp",
    "MeasuredOrder",
    "PAPER",
    "PhaseReference",
    "PulseChannel",
    "PulseReading",
    "Recording",
    "Signal",
    "Step",
    "Twist",
    "VoldKalman",
    "Welch",
    "Wheel",
    "WheelPattern",
    "WheelTest",
    "angle_from_pulses",
    "calibrate_wheel",
    "check_recording",
    "decimate",
    "difference",
    "estimate",
    "frac",
    "iter_blocks",
    "iter_wheel_rotations",
    "loops",
    "lowest_speed",
    "mean_rotation",
    "on_first_clock",
    "pickup_gains",
    "pulse_channel",
    "read_recording",
    "repaired_pulses",
    "resampled",
    "resolution_limit",
    "rotation_clocks",
    "signal_clocks",
    "spectrogram",
    "stepped_sine",
    "track_orders",
    "unwrapped",
    "wheel_rotation",
    "write_recording",
]

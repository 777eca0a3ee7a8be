# Written by `make generate`.
from torsionnet.motion.motion_start import MotionStart as MotionStart
from torsionnet.signals.energy_balance import EnergyBalance as EnergyBalance
from torsionnet.signals.motion_event import MotionEvent as MotionEvent

__all__ = [
    "EnergyBalance",
    "MotionEvent",
    "MotionStart",
]

# Written by `make generate`.
from torsionnet.motion.contact_states import MotionStart as MotionStart
from torsionnet.signals.recording import EnergyBalance as EnergyBalance
from torsionnet.signals.recording import MotionEvent as MotionEvent

__all__ = [
    "EnergyBalance",
    "MotionEvent",
    "MotionStart",
]

# Written by `make generate`.
from torsionnet.motion.contact_states import MotionStart as MotionStart

__all__ = [
    "MotionStart",
]

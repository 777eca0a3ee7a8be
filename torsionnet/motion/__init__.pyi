# Written by `make generate`.
from torsionnet.motion.contact_states import MotionStart as MotionStart
from torsionnet.motion.periodic.periodic_result import PeriodicResponse as PeriodicResponse

__all__ = [
    "MotionStart",
    "PeriodicResponse",
]

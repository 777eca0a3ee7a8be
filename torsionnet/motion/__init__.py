"""Motion over time: laws that are not linear, their operating points, scenarios, contacts and friction."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "MotionStart": "torsionnet.motion.contact_states",
    },
)

"""Exact derivatives of responses and modes with respect to parameters, by numbers that carry their derivatives."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "mode_sensitivities": "torsionnet.linear.sensitivity.sensitivities_of_modes",
    },
)

"""Exact derivatives of responses and modes with respect to parameters, by numbers that carry their derivatives."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Evaluation": "torsionnet.linear.sensitivity.parametric",
        "ModeEffect": "torsionnet.linear.sensitivity.mode_sensitivities",
        "ModeSensitivities": "torsionnet.linear.sensitivity.mode_sensitivities",
        "ParametricResponse": "torsionnet.linear.sensitivity.parametric",
        "mode_sensitivities": "torsionnet.linear.sensitivity.mode_sensitivities",
        "parametric_response": "torsionnet.linear.sensitivity.parametric",
    },
)

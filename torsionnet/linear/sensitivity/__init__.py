"""Exact derivatives of responses and modes with respect to parameters, by numbers that carry their derivatives."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Evaluation": "torsionnet.linear.sensitivity.parametric",
        "ModeEffect": "torsionnet.linear.sensitivity.sensitivities_of_modes",
        "ModeSensitivities": "torsionnet.linear.sensitivity.sensitivities_of_modes",
        "ParametricResponse": "torsionnet.linear.sensitivity.parametric",
        "mode_sensitivities": "torsionnet.linear.sensitivity.sensitivities_of_modes",
        "parametric_response": "torsionnet.linear.sensitivity.parametric",
    },
)

"""Exact derivatives of responses and modes with respect to parameters, by numbers that carry their derivatives."""

from torsionnet.core.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Evaluation": "torsionnet.solve.sensitivity.parametric",
        "ModeEffect": "torsionnet.solve.sensitivity.mode_sensitivities",
        "ModeSensitivities": "torsionnet.solve.sensitivity.mode_sensitivities",
        "ParametricResponse": "torsionnet.solve.sensitivity.parametric",
        "mode_sensitivities": "torsionnet.solve.sensitivity.mode_sensitivities",
        "parametric_response": "torsionnet.solve.sensitivity.parametric",
    },
)

"""Derivatives of responses and modes to parameters, exact: every number carries its own along."""

from torsionnet.core.lazy import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Evaluation": "torsionnet.solve.sensitivity.parametric",
        "ModeSensitivities": "torsionnet.solve.sensitivity.mode_sensitivities",
        "ParametricResponse": "torsionnet.solve.sensitivity.parametric",
        "mode_sensitivities": "torsionnet.solve.sensitivity.mode_sensitivities",
        "parametric_response": "torsionnet.solve.sensitivity.parametric",
    },
)

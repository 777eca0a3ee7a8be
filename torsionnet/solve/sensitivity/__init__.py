"""Derivatives of responses and modes to parameters, exact: every number carries its own along."""

from torsionnet.solve.sensitivity.mode_sensitivities import ModeSensitivities, mode_sensitivities
from torsionnet.solve.sensitivity.parametric import Evaluation, ParametricResponse, parametric_response

__all__ = ["Evaluation", "ModeSensitivities", "ParametricResponse", "mode_sensitivities", "parametric_response"]

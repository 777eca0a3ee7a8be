"""Derivatives of responses and modes to parameters, exact: every number carries its own along."""

from torsionnet.sensitivity.modes import ModeSensitivities, mode_sensitivities
from torsionnet.sensitivity.parametric import Evaluation, ParametricResponse, parametric_response

__all__ = ["Evaluation", "ModeSensitivities", "ParametricResponse", "mode_sensitivities", "parametric_response"]

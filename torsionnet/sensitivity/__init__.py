"""Derivatives of responses and modes to parameters, exact: every number carries its own along."""

from torsionnet.sensitivity.parametric import Evaluation, ParametricResponse, parametric_response

__all__ = ["Evaluation", "ParametricResponse", "parametric_response"]

# Written by `make generate`.
from torsionnet.linear.sensitivity.mode_sensitivities import ModeEffect as ModeEffect
from torsionnet.linear.sensitivity.mode_sensitivities import ModeSensitivities as ModeSensitivities
from torsionnet.linear.sensitivity.mode_sensitivities import mode_sensitivities as mode_sensitivities
from torsionnet.linear.sensitivity.parametric import Evaluation as Evaluation
from torsionnet.linear.sensitivity.parametric import ParametricResponse as ParametricResponse
from torsionnet.linear.sensitivity.parametric import parametric_response as parametric_response

__all__ = [
    "Evaluation",
    "ModeEffect",
    "ModeSensitivities",
    "ParametricResponse",
    "mode_sensitivities",
    "parametric_response",
]

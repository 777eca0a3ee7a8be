# Written by `make generate`.
from torsionnet.solve.sensitivity.mode_sensitivities import ModeEffect as ModeEffect
from torsionnet.solve.sensitivity.mode_sensitivities import ModeSensitivities as ModeSensitivities
from torsionnet.solve.sensitivity.mode_sensitivities import mode_sensitivities as mode_sensitivities
from torsionnet.solve.sensitivity.parametric import Evaluation as Evaluation
from torsionnet.solve.sensitivity.parametric import ParametricResponse as ParametricResponse
from torsionnet.solve.sensitivity.parametric import parametric_response as parametric_response

__all__ = [
    "Evaluation",
    "ModeEffect",
    "ModeSensitivities",
    "ParametricResponse",
    "mode_sensitivities",
    "parametric_response",
]

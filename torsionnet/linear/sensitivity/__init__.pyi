# Written by `make generate`.
from torsionnet.linear.sensitivity.parametric import Evaluation as Evaluation
from torsionnet.linear.sensitivity.parametric import ParametricResponse as ParametricResponse
from torsionnet.linear.sensitivity.parametric import parametric_response as parametric_response
from torsionnet.linear.sensitivity.sensitivities_of_modes import ModeEffect as ModeEffect
from torsionnet.linear.sensitivity.sensitivities_of_modes import ModeSensitivities as ModeSensitivities
from torsionnet.linear.sensitivity.sensitivities_of_modes import mode_sensitivities as mode_sensitivities

__all__ = [
    "Evaluation",
    "ModeEffect",
    "ModeSensitivities",
    "ParametricResponse",
    "mode_sensitivities",
    "parametric_response",
]

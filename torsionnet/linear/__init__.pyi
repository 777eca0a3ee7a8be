# Written by `make generate`.
from torsionnet.linear.assembly.matrices import SystemMatrices as SystemMatrices
from torsionnet.linear.estimation import Estimation as Estimation
from torsionnet.linear.modes.mode_pairs import VibrationMode as VibrationMode
from torsionnet.linear.modes.mode_pairs import amplification as amplification
from torsionnet.linear.modes.modes import ModeRow as ModeRow
from torsionnet.linear.responses.loop_margins import LoopMargins as LoopMargins
from torsionnet.linear.responses.loop_margins import Margin as Margin

__all__ = [
    "Estimation",
    "LoopMargins",
    "Margin",
    "ModeRow",
    "SystemMatrices",
    "VibrationMode",
    "amplification",
]

# Written by `make generate`.
from torsionnet.linear.sensitivity.sensitivities_of_modes import mode_sensitivities as mode_sensitivities

__all__ = [
    "mode_sensitivities",
]

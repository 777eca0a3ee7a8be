# Written by `make generate`.
from torsionnet.modal.circle_fitting import circle_fit as circle_fit
from torsionnet.modal.matching import cmif as cmif
from torsionnet.modal.matching import match as match
from torsionnet.modal.mode_identification import identify_modes as identify_modes
from torsionnet.modal.mode_identification import peak_picking as peak_picking
from torsionnet.modal.operational.ambient_modes import modes_from_ambient as modes_from_ambient
from torsionnet.modal.operational.decay_modes import modes_from_decay as modes_from_decay
from torsionnet.modal.operational.run_up_fit import sweep_of as sweep_of
from torsionnet.modal.operational.run_up_fit import swept_response as swept_response
from torsionnet.modal.operational.run_up_modes import modes_from_run_up as modes_from_run_up
from torsionnet.modal.selection import stabilisation as stabilisation
from torsionnet.modal.spectral_lines import Settings as Settings

__all__ = [
    "Settings",
    "circle_fit",
    "cmif",
    "identify_modes",
    "match",
    "modes_from_ambient",
    "modes_from_decay",
    "modes_from_run_up",
    "peak_picking",
    "stabilisation",
    "sweep_of",
    "swept_response",
]

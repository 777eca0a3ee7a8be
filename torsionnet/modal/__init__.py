"""Modes identified from frequency responses, without a model, and their comparison with those of one."""

from torsionnet.modal.circle_fit import CircleFit, circle_fit
from torsionnet.modal.criteria import cmif, mac, mpc, msf
from torsionnet.modal.identify_modes import fit_poles, identify_modes
from torsionnet.modal.matching import Match, match
from torsionnet.modal.method_choice import stabilisation
from torsionnet.modal.modal_estimate import ModalEstimate
from torsionnet.modal.peak_picking import peak_picking
from torsionnet.modal.settings import Criteria, Settings
from torsionnet.modal.stabilisation import Stabilisation

__all__ = [
    "CircleFit",
    "Criteria",
    "Match",
    "ModalEstimate",
    "Settings",
    "Stabilisation",
    "circle_fit",
    "cmif",
    "fit_poles",
    "identify_modes",
    "mac",
    "match",
    "mpc",
    "msf",
    "peak_picking",
    "stabilisation",
]

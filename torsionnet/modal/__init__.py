"""Modes identified from frequency responses, without a model, and their comparison with those of one."""

from torsionnet.modal.criteria import cmif, mac, mpc, msf
from torsionnet.modal.estimate import ModalEstimate
from torsionnet.modal.identification import fit_poles, identify_modes
from torsionnet.modal.settings import Criteria, Settings
from torsionnet.modal.stabilisation import Stabilisation, stabilisation

__all__ = [
    "Criteria",
    "ModalEstimate",
    "Settings",
    "Stabilisation",
    "cmif",
    "fit_poles",
    "identify_modes",
    "mac",
    "mpc",
    "msf",
    "stabilisation",
]

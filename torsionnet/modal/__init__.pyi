# Written by `make generate`.
from torsionnet.modal.circle_fit import CircleFit as CircleFit
from torsionnet.modal.circle_fit import circle_fit as circle_fit
from torsionnet.modal.criteria import cmif as cmif
from torsionnet.modal.criteria import mac as mac
from torsionnet.modal.criteria import mpc as mpc
from torsionnet.modal.criteria import msf as msf
from torsionnet.modal.identify_modes import fit_poles as fit_poles
from torsionnet.modal.identify_modes import identify_modes as identify_modes
from torsionnet.modal.matching import Match as Match
from torsionnet.modal.matching import match as match
from torsionnet.modal.method_choice import stabilisation as stabilisation
from torsionnet.modal.modal_estimate import IdentifiedMode as IdentifiedMode
from torsionnet.modal.modal_estimate import ModalEstimate as ModalEstimate
from torsionnet.modal.peak_picking import peak_picking as peak_picking
from torsionnet.modal.settings import Criteria as Criteria
from torsionnet.modal.settings import Settings as Settings
from torsionnet.modal.stabilisation import Order as Order
from torsionnet.modal.stabilisation import Stabilisation as Stabilisation

__all__ = [
    "CircleFit",
    "Criteria",
    "IdentifiedMode",
    "Match",
    "ModalEstimate",
    "Order",
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

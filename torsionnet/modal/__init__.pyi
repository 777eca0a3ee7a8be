# Written by `make generate`.
from torsionnet.modal.circle_fitting import CircleFit as CircleFit
from torsionnet.modal.circle_fitting import circle_fit as circle_fit
from torsionnet.modal.matching import Match as Match
from torsionnet.modal.matching import cmif as cmif
from torsionnet.modal.matching import mac as mac
from torsionnet.modal.matching import match as match
from torsionnet.modal.matching import mpc as mpc
from torsionnet.modal.matching import msf as msf
from torsionnet.modal.modal_estimate import IdentifiedMode as IdentifiedMode
from torsionnet.modal.modal_estimate import ModalEstimate as ModalEstimate
from torsionnet.modal.mode_identification import fit_poles as fit_poles
from torsionnet.modal.mode_identification import identify_modes as identify_modes
from torsionnet.modal.operational.ambient_modes import AmbientPoles as AmbientPoles
from torsionnet.modal.operational.ambient_modes import modes_from_ambient as modes_from_ambient
from torsionnet.modal.operational.decay_modes import DecayFit as DecayFit
from torsionnet.modal.operational.decay_modes import Decrement as Decrement
from torsionnet.modal.operational.decay_modes import modes_from_decay as modes_from_decay
from torsionnet.modal.operational.operational_modes import OperationalMode as OperationalMode
from torsionnet.modal.operational.operational_modes import OperationalModes as OperationalModes
from torsionnet.modal.operational.run_up_fit import SpeedSweep as SpeedSweep
from torsionnet.modal.operational.run_up_fit import sweep_of as sweep_of
from torsionnet.modal.operational.run_up_fit import swept_response as swept_response
from torsionnet.modal.operational.run_up_modes import SweptFit as SweptFit
from torsionnet.modal.operational.run_up_modes import modes_from_run_up as modes_from_run_up
from torsionnet.modal.operational.run_up_modes import modes_from_tracked_orders as modes_from_tracked_orders
from torsionnet.modal.peak_modes import peak_picking as peak_picking
from torsionnet.modal.selection import stabilisation as stabilisation
from torsionnet.modal.spectral_lines import Criteria as Criteria
from torsionnet.modal.spectral_lines import Settings as Settings
from torsionnet.modal.stabilisation_chart import Order as Order
from torsionnet.modal.stabilisation_chart import Stabilisation as Stabilisation

__all__ = [
    "AmbientPoles",
    "CircleFit",
    "Criteria",
    "DecayFit",
    "Decrement",
    "IdentifiedMode",
    "Match",
    "ModalEstimate",
    "OperationalMode",
    "OperationalModes",
    "Order",
    "Settings",
    "SpeedSweep",
    "Stabilisation",
    "SweptFit",
    "circle_fit",
    "cmif",
    "fit_poles",
    "identify_modes",
    "mac",
    "match",
    "modes_from_ambient",
    "modes_from_decay",
    "modes_from_run_up",
    "modes_from_tracked_orders",
    "mpc",
    "msf",
    "peak_picking",
    "stabilisation",
    "sweep_of",
    "swept_response",
]

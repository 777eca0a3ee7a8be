"""Modes identified from frequency responses without a model, and compared with the modes of a model."""

from torsionnet.core.lazy_imports import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "CircleFit": "torsionnet.modal.circle_fit",
        "Criteria": "torsionnet.modal.settings",
        "IdentifiedMode": "torsionnet.modal.modal_estimate",
        "Match": "torsionnet.modal.matching",
        "ModalEstimate": "torsionnet.modal.modal_estimate",
        "Order": "torsionnet.modal.stabilisation",
        "Settings": "torsionnet.modal.settings",
        "Stabilisation": "torsionnet.modal.stabilisation",
        "circle_fit": "torsionnet.modal.circle_fit",
        "cmif": "torsionnet.modal.criteria",
        "fit_poles": "torsionnet.modal.identify_modes",
        "identify_modes": "torsionnet.modal.identify_modes",
        "mac": "torsionnet.modal.criteria",
        "match": "torsionnet.modal.matching",
        "mpc": "torsionnet.modal.criteria",
        "msf": "torsionnet.modal.criteria",
        "peak_picking": "torsionnet.modal.peak_picking",
        "stabilisation": "torsionnet.modal.method_choice",
    },
)

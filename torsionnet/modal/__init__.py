"""Modes identified from frequency responses without a model, and compared with the modes of a model."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Settings": "torsionnet.modal.spectral_lines",
        "circle_fit": "torsionnet.modal.circle_fitting",
        "cmif": "torsionnet.modal.matching",
        "identify_modes": "torsionnet.modal.mode_identification",
        "match": "torsionnet.modal.matching",
        "modes_from_ambient": "torsionnet.modal.operational.ambient_modes",
        "modes_from_decay": "torsionnet.modal.operational.decay_modes",
        "modes_from_run_up": "torsionnet.modal.operational.run_up_modes",
        "peak_picking": "torsionnet.modal.mode_identification",
        "swept_response": "torsionnet.modal.operational.run_up_fit",
        "sweep_of": "torsionnet.modal.operational.run_up_fit",
        "stabilisation": "torsionnet.modal.selection",
    },
)

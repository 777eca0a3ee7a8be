"""Identification of the parameters of a drivetrain from measurements, with standard errors and lack of fit."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Candidate": "torsionnet.identification.ranking",
        "Fit": "torsionnet.identification.fit",
        "Measurement": "torsionnet.identification.residuals.measurement",
        "Unknown": "torsionnet.identification.plan.fit_entries",
        "choose_model": "torsionnet.identification.ranking",
        "identify": "torsionnet.identification.fitting",
        "load_fit": "torsionnet.identification.fit",
        "rank_causes": "torsionnet.identification.ranking",
    },
)

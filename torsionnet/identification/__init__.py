"""Identification of the parameters of a drivetrain from measurements, with standard errors and lack of fit."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Candidate": "torsionnet.identification.model_choice",
        "Choice": "torsionnet.identification.model_choice",
        "Compared": "torsionnet.identification.fit_result",
        "Explanation": "torsionnet.identification.lack_of_fit",
        "Fit": "torsionnet.identification.fit",
        "LackOfFit": "torsionnet.identification.lack_of_fit",
        "Measurement": "torsionnet.identification.residuals.measurement",
        "Misfit": "torsionnet.identification.lack_of_fit",
        "RankedCause": "torsionnet.identification.ranking",
        "Ranking": "torsionnet.identification.ranking",
        "Unknown": "torsionnet.identification.unknown_parameter",
        "choose_model": "torsionnet.identification.model_choice",
        "identify": "torsionnet.identification.fitting",
        "load_fit": "torsionnet.identification.fit",
        "rank_causes": "torsionnet.identification.ranking",
    },
)

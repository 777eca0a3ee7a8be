"""From tests to parameters that can be trusted."""

from torsionnet.identification.fit import Fit, load_fit
from torsionnet.identification.fit_result import Compared
from torsionnet.identification.fitting import identify
from torsionnet.identification.lack_of_fit import Explanation, LackOfFit, Misfit
from torsionnet.identification.model_choice import Candidate, Choice, choose_model
from torsionnet.identification.ranking import RankedCause, Ranking, rank_causes
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.identification.unknown import Unknown

__all__ = [
    "Candidate",
    "Choice",
    "Compared",
    "Explanation",
    "Fit",
    "LackOfFit",
    "Measurement",
    "Misfit",
    "RankedCause",
    "Ranking",
    "Unknown",
    "choose_model",
    "identify",
    "load_fit",
    "rank_causes",
]

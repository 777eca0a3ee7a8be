# Written by `make generate`.
from torsionnet.identification.fit import Fit as Fit
from torsionnet.identification.fit import load_fit as load_fit
from torsionnet.identification.fit_result import Compared as Compared
from torsionnet.identification.fitting import identify as identify
from torsionnet.identification.lack_of_fit import Explanation as Explanation
from torsionnet.identification.lack_of_fit import LackOfFit as LackOfFit
from torsionnet.identification.lack_of_fit import Misfit as Misfit
from torsionnet.identification.model_choice import Candidate as Candidate
from torsionnet.identification.model_choice import Choice as Choice
from torsionnet.identification.model_choice import choose_model as choose_model
from torsionnet.identification.ranking import RankedCause as RankedCause
from torsionnet.identification.ranking import Ranking as Ranking
from torsionnet.identification.ranking import rank_causes as rank_causes
from torsionnet.identification.residuals.measurement import Measurement as Measurement
from torsionnet.identification.unknown_parameter import Unknown as Unknown

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

# Written by `make generate`.
from torsionnet.identification.fit import Fit as Fit
from torsionnet.identification.fit import load_fit as load_fit
from torsionnet.identification.fitting import identify as identify
from torsionnet.identification.model_choice import Candidate as Candidate
from torsionnet.identification.model_choice import choose_model as choose_model
from torsionnet.identification.ranking import rank_causes as rank_causes
from torsionnet.identification.residuals.measurement import Measurement as Measurement
from torsionnet.identification.unknown_parameter import Unknown as Unknown

__all__ = [
    "Candidate",
    "Fit",
    "Measurement",
    "Unknown",
    "choose_model",
    "identify",
    "load_fit",
    "rank_causes",
]

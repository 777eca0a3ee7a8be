# Written by `make generate`.
from torsionnet.identification.fit import Fit as Fit
from torsionnet.identification.fit import load_fit as load_fit
from torsionnet.identification.fitting import identify as identify
from torsionnet.identification.plan.fit_entries import Unknown as Unknown
from torsionnet.identification.ranking import Candidate as Candidate
from torsionnet.identification.ranking import choose_model as choose_model
from torsionnet.identification.ranking import rank_causes as rank_causes
from torsionnet.identification.residuals.measurement import Measurement as Measurement

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

"""From tests to parameters that can be trusted."""

from torsionnet.identification.fit import Compared, Fit
from torsionnet.identification.fitting import identify
from torsionnet.identification.measurement import Measurement
from torsionnet.identification.unknown import Unknown

__all__ = ["Compared", "Fit", "Measurement", "Unknown", "identify"]

"""From tests to parameters that can be trusted."""

from torsionnet.identify.fit import Compared, Fit
from torsionnet.identify.fitting import identify
from torsionnet.identify.measurement import Measurement
from torsionnet.identify.unknown import Unknown

__all__ = ["Compared", "Fit", "Measurement", "Unknown", "identify"]

"""Pictures of drivetrains and results. Each function returns a matplotlib figure and shows or writes nothing."""

from torsionnet.report.bode import bode
from torsionnet.report.coherence import coherence
from torsionnet.report.comparison import comparison
from torsionnet.report.histories import time_histories
from torsionnet.report.save import save
from torsionnet.report.schematic import schematic
from torsionnet.report.shapes import mode_shapes
from torsionnet.report.spectra import order_map, spectrogram, sweep_harmonics

__all__ = [
    "bode",
    "coherence",
    "comparison",
    "mode_shapes",
    "order_map",
    "save",
    "schematic",
    "spectrogram",
    "sweep_harmonics",
    "time_histories",
]

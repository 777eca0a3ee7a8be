"""Pictures of drivetrains and results. Each function returns a matplotlib figure and shows or writes nothing."""

from torsionnet.report.bode import bode
from torsionnet.report.circle import circle
from torsionnet.report.coherence import coherence
from torsionnet.report.comparison import comparison
from torsionnet.report.fits import correlation, fit
from torsionnet.report.histories import time_histories
from torsionnet.report.mac import mac_matrix
from torsionnet.report.save import save
from torsionnet.report.schematic import schematic
from torsionnet.report.shapes import mode_shapes
from torsionnet.report.spectra import order_map, spectrogram, sweep_harmonics
from torsionnet.report.stabilisation import stabilisation
from torsionnet.report.tornado import tornado

__all__ = [
    "bode",
    "circle",
    "coherence",
    "comparison",
    "correlation",
    "fit",
    "mac_matrix",
    "mode_shapes",
    "order_map",
    "save",
    "schematic",
    "spectrogram",
    "stabilisation",
    "sweep_harmonics",
    "time_histories",
    "tornado",
]

"""Pictures of drivetrains and results. Each function returns a matplotlib figure and shows or writes nothing."""

from torsionnet.plot.bode import bode
from torsionnet.plot.circle import circle
from torsionnet.plot.coherence import coherence
from torsionnet.plot.comparison import comparison
from torsionnet.plot.damper_curves import damper_design
from torsionnet.plot.fits import correlation, fit
from torsionnet.plot.histories import time_histories
from torsionnet.plot.interference_diagram import interference_diagram
from torsionnet.plot.limit_check import limit_check
from torsionnet.plot.mac import mac_matrix
from torsionnet.plot.nyquist import nyquist
from torsionnet.plot.order_overlay import order_overlay
from torsionnet.plot.order_response import half_ranges, order_response, waveform
from torsionnet.plot.save import save
from torsionnet.plot.schematic import schematic
from torsionnet.plot.shapes import mode_shapes
from torsionnet.plot.stabilisation import stabilisation
from torsionnet.plot.star_diagrams import star_diagrams
from torsionnet.plot.time_frequency import order_map, spectrogram, sweep_harmonics
from torsionnet.plot.tornado import tornado
from torsionnet.plot.waterfall import waterfall

__all__ = [
    "bode",
    "circle",
    "coherence",
    "comparison",
    "correlation",
    "damper_design",
    "fit",
    "half_ranges",
    "interference_diagram",
    "limit_check",
    "mac_matrix",
    "mode_shapes",
    "nyquist",
    "order_map",
    "order_overlay",
    "order_response",
    "save",
    "schematic",
    "spectrogram",
    "stabilisation",
    "star_diagrams",
    "sweep_harmonics",
    "time_histories",
    "tornado",
    "waterfall",
    "waveform",
]

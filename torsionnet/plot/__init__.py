"""Pictures of drivetrains and results. Each function returns a matplotlib figure and shows or writes nothing."""

from torsionnet.plot.bode import bode
from torsionnet.plot.circle import circle
from torsionnet.plot.coherence import coherence
from torsionnet.plot.comparison import comparison
from torsionnet.plot.damper_curves import damper_design
from torsionnet.plot.drawing.save import save
from torsionnet.plot.drawing.style import STYLE
from torsionnet.plot.fits import correlation, fit
from torsionnet.plot.histories import time_histories
from torsionnet.plot.interference_diagram import interference_diagram
from torsionnet.plot.limit_check import limit_check
from torsionnet.plot.mac import mac_matrix
from torsionnet.plot.nyquist import nyquist
from torsionnet.plot.order_overlay import order_overlay
from torsionnet.plot.order_response import half_ranges, order_response, waveform
from torsionnet.plot.schematic.schematic import schematic
from torsionnet.plot.shapes import mode_shapes
from torsionnet.plot.stabilisation import stabilisation
from torsionnet.plot.star_diagrams import star_diagrams
from torsionnet.plot.study.contour_map import contour_map
from torsionnet.plot.study.designs import damper_over_conditions, design_optimum, pareto_front, robust_optimum
from torsionnet.plot.study.failure_probabilities import failure_probabilities
from torsionnet.plot.study.limit_shares import limit_shares
from torsionnet.plot.study.parallel_coordinates import parallel_coordinates
from torsionnet.plot.study.percentile_bands import percentile_bands
from torsionnet.plot.study.scatter_matrix import scatter_matrix
from torsionnet.plot.study.sobol_bars import sobol_indices
from torsionnet.plot.study.study_tornado import study_tornado
from torsionnet.plot.study.worst_variants import worst_variants
from torsionnet.plot.time_frequency import order_map, spectrogram, sweep_harmonics
from torsionnet.plot.tornado import tornado
from torsionnet.plot.waterfall import waterfall

__all__ = [
    "STYLE",
    "bode",
    "circle",
    "coherence",
    "comparison",
    "contour_map",
    "correlation",
    "damper_design",
    "damper_over_conditions",
    "design_optimum",
    "failure_probabilities",
    "fit",
    "half_ranges",
    "interference_diagram",
    "limit_check",
    "limit_shares",
    "mac_matrix",
    "mode_shapes",
    "nyquist",
    "order_map",
    "order_overlay",
    "order_response",
    "parallel_coordinates",
    "pareto_front",
    "percentile_bands",
    "robust_optimum",
    "save",
    "scatter_matrix",
    "schematic",
    "sobol_indices",
    "spectrogram",
    "stabilisation",
    "star_diagrams",
    "study_tornado",
    "sweep_harmonics",
    "time_histories",
    "tornado",
    "waterfall",
    "waveform",
    "worst_variants",
]

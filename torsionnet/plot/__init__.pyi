# Written by `make generate`.
from torsionnet.plot.bode_plot import bode as bode
from torsionnet.plot.comparison_plot import coherence as coherence
from torsionnet.plot.comparison_plot import comparison as comparison
from torsionnet.plot.drawing.save import save as save
from torsionnet.plot.drawing.style import STYLE as STYLE
from torsionnet.plot.fits import correlation as correlation
from torsionnet.plot.fits import fit as fit
from torsionnet.plot.histories import passage_response as passage_response
from torsionnet.plot.histories import scenario_motion as scenario_motion
from torsionnet.plot.histories import time_histories as time_histories
from torsionnet.plot.interference_plot import interference_diagram as interference_diagram
from torsionnet.plot.limit_plot import limit_check as limit_check
from torsionnet.plot.limit_plot import limit_families as limit_families
from torsionnet.plot.modal_plots import circle as circle
from torsionnet.plot.modal_plots import mac_matrix as mac_matrix
from torsionnet.plot.modal_plots import operational_modes as operational_modes
from torsionnet.plot.modal_plots import stabilisation as stabilisation
from torsionnet.plot.nyquist_plot import nyquist as nyquist
from torsionnet.plot.order_overlay_plot import order_overlay as order_overlay
from torsionnet.plot.order_overlay_plot import tracked_orders as tracked_orders
from torsionnet.plot.order_response_plot import half_ranges as half_ranges
from torsionnet.plot.order_response_plot import order_response as order_response
from torsionnet.plot.order_response_plot import waterfall as waterfall
from torsionnet.plot.order_response_plot import waveform as waveform
from torsionnet.plot.schematics.schematic import schematic as schematic
from torsionnet.plot.shapes import mode_shapes as mode_shapes
from torsionnet.plot.star_diagram_plot import star_diagrams as star_diagrams
from torsionnet.plot.study.contour_map import contour_map as contour_map
from torsionnet.plot.study.designs import damper_design as damper_design
from torsionnet.plot.study.designs import damper_over_conditions as damper_over_conditions
from torsionnet.plot.study.designs import design_optimum as design_optimum
from torsionnet.plot.study.designs import pareto_front as pareto_front
from torsionnet.plot.study.designs import robust_optimum as robust_optimum
from torsionnet.plot.study.distributions import failure_probabilities as failure_probabilities
from torsionnet.plot.study.distributions import limit_shares as limit_shares
from torsionnet.plot.study.distributions import percentile_bands as percentile_bands
from torsionnet.plot.study.scatter_matrix import parallel_coordinates as parallel_coordinates
from torsionnet.plot.study.scatter_matrix import scatter_matrix as scatter_matrix
from torsionnet.plot.study.study_tornado import sobol_indices as sobol_indices
from torsionnet.plot.study.study_tornado import study_tornado as study_tornado
from torsionnet.plot.study.worst_variants import worst_variants as worst_variants
from torsionnet.plot.time_frequency import order_map as order_map
from torsionnet.plot.time_frequency import spectrogram as spectrogram
from torsionnet.plot.time_frequency import sweep_harmonics as sweep_harmonics
from torsionnet.plot.tornado_plot import tornado as tornado
from torsionnet.plot.wheel_plots import wheel_pattern as wheel_pattern
from torsionnet.plot.wheel_plots import wheel_rotations as wheel_rotations

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
    "limit_families",
    "limit_shares",
    "mac_matrix",
    "mode_shapes",
    "nyquist",
    "operational_modes",
    "order_map",
    "order_overlay",
    "order_response",
    "parallel_coordinates",
    "pareto_front",
    "passage_response",
    "percentile_bands",
    "robust_optimum",
    "save",
    "scatter_matrix",
    "scenario_motion",
    "schematic",
    "sobol_indices",
    "spectrogram",
    "stabilisation",
    "star_diagrams",
    "study_tornado",
    "sweep_harmonics",
    "time_histories",
    "tornado",
    "tracked_orders",
    "waterfall",
    "waveform",
    "wheel_pattern",
    "wheel_rotations",
    "worst_variants",
]

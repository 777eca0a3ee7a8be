# Written by `make generate`.
from torsionnet.plot.bode_plot import bode as bode
from torsionnet.plot.bode_plot import nyquist as nyquist
from torsionnet.plot.comparison_plot import coherence as coherence
from torsionnet.plot.comparison_plot import comparison as comparison
from torsionnet.plot.drawing.save import save as save
from torsionnet.plot.drawing.style import STYLE as STYLE
from torsionnet.plot.fits import correlation as correlation
from torsionnet.plot.fits import fit as fit
from torsionnet.plot.histories import passage_response as passage_response
from torsionnet.plot.histories import time_histories as time_histories
from torsionnet.plot.interference_plot import interference_diagram as interference_diagram
from torsionnet.plot.interference_plot import star_diagrams as star_diagrams
from torsionnet.plot.limit_plot import limit_check as limit_check
from torsionnet.plot.modal_plots import circle as circle
from torsionnet.plot.modal_plots import mac_matrix as mac_matrix
from torsionnet.plot.modal_plots import operational_modes as operational_modes
from torsionnet.plot.modal_plots import stabilisation as stabilisation
from torsionnet.plot.order_overlay_plot import tracked_orders as tracked_orders
from torsionnet.plot.order_response_plot import order_response as order_response
from torsionnet.plot.order_response_plot import periodic_response as periodic_response
from torsionnet.plot.order_response_plot import waterfall as waterfall
from torsionnet.plot.order_response_plot import waveform as waveform
from torsionnet.plot.schematics.schematic import schematic as schematic
from torsionnet.plot.shapes import mode_shapes as mode_shapes
from torsionnet.plot.signal_plots import spectrogram as spectrogram
from torsionnet.plot.signal_plots import wheel_pattern as wheel_pattern
from torsionnet.plot.study.designs import damper_design as damper_design
from torsionnet.plot.study.study_tornado import tornado as tornado

__all__ = [
    "STYLE",
    "bode",
    "circle",
    "coherence",
    "comparison",
    "correlation",
    "damper_design",
    "fit",
    "interference_diagram",
    "limit_check",
    "mac_matrix",
    "mode_shapes",
    "nyquist",
    "operational_modes",
    "order_response",
    "passage_response",
    "periodic_response",
    "save",
    "schematic",
    "spectrogram",
    "stabilisation",
    "star_diagrams",
    "time_histories",
    "tornado",
    "tracked_orders",
    "waterfall",
    "waveform",
    "wheel_pattern",
]

"""Pictures of drivetrains and results as matplotlib figures, which are neither shown nor written to files."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "STYLE": "torsionnet.plot.drawing.style",
        "bode": "torsionnet.plot.bode_plot",
        "circle": "torsionnet.plot.modal_plots",
        "coherence": "torsionnet.plot.comparison_plot",
        "comparison": "torsionnet.plot.comparison_plot",
        "correlation": "torsionnet.plot.fits",
        "damper_design": "torsionnet.plot.study.designs",
        "fit": "torsionnet.plot.fits",
        "interference_diagram": "torsionnet.plot.interference_plot",
        "limit_check": "torsionnet.plot.limit_plot",
        "mac_matrix": "torsionnet.plot.modal_plots",
        "mode_shapes": "torsionnet.plot.shapes",
        "nyquist": "torsionnet.plot.bode_plot",
        "operational_modes": "torsionnet.plot.modal_plots",
        "order_response": "torsionnet.plot.order_response_plot",
        "passage_response": "torsionnet.plot.histories",
        "periodic_response": "torsionnet.plot.order_response_plot",
        "save": "torsionnet.plot.drawing.save",
        "schematic": "torsionnet.plot.schematics.schematic",
        "spectrogram": "torsionnet.plot.signal_plots",
        "stabilisation": "torsionnet.plot.modal_plots",
        "star_diagrams": "torsionnet.plot.interference_plot",
        "time_histories": "torsionnet.plot.histories",
        "tornado": "torsionnet.plot.study.study_tornado",
        "tracked_orders": "torsionnet.plot.order_overlay_plot",
        "waterfall": "torsionnet.plot.order_response_plot",
        "waveform": "torsionnet.plot.order_response_plot",
        "wheel_pattern": "torsionnet.plot.signal_plots",
    },
)

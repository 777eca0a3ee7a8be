"""Linear vibration of drivetrains: rows, frequency responses, modes, sensitivities, variants and their results."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Estimation": "torsionnet.linear.estimation",
        "LoopMargins": "torsionnet.linear.responses.loop_margins",
        "Margin": "torsionnet.linear.responses.loop_margins",
        "ModeRow": "torsionnet.linear.modes.modes",
        "SystemMatrices": "torsionnet.linear.assembly.matrices",
        "VibrationMode": "torsionnet.linear.modes.mode_pairs",
        "amplification": "torsionnet.linear.modes.mode_pairs",
    },
)

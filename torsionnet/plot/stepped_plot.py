"""Plot of stiffness and loss over the amplitude of a stepped sine, of a test and of a model beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from torsionnet.signals.stepped_levels import SteppedStiffness


def stepped_stiffness(found: SteppedStiffness, model: NDArray[np.complex128] | None = None, title: str = "") -> Figure:
    """Figure of k' and eta_1 over the amplitude of the twist, circles of the test, crosses of the model."""
    sheet, (upper, lower) = style.stacked_panels(5.4, ["k'", "eta_1"], None)
    at = np.rad2deg(found.amplitudes)
    pairs = [(found.stiffness, "o", style.PALETTE[0], "test")]
    pairs += [] if model is None else [(model, "x", style.PALETTE[1], "model")]
    for values, marker, color, label in pairs:
        upper.plot(at, values.real, marker, color=color, label=label)
        real = np.where(values.real == 0, np.nan, values.real)
        lower.plot(at, values.imag / real, marker, color=color)
    upper.set_ylabel("k' [N m/rad]")
    lower.set_ylabel("loss factor eta_1")
    lower.set_xlabel("amplitude of the twist [deg]")
    for panel in (upper, lower):
        panel.set_xlim(0, 1.05 * float(at.max()))
        panel.set_ylim(0, 1.05 * panel.get_ylim()[1])
    if model is not None:
        sheet.legend(2)
    return sheet.titled(title or found.title or "Stiffness over amplitude")

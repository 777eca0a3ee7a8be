"""Plots of a component bench: loops of torque over twist, and stiffness and loss over the amplitude of a sine."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.signals.torque_loops.loop_result import TorqueLoops

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from torsionnet.signals.stepped_levels import SteppedStiffness


def torque_loops(
    loops: TorqueLoops, *, conventions: Conventions = SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of the loops of a test: mean branches, the fitted spring line dashed, and dots where stages begin.

    Parameters
    ----------
    loops : TorqueLoops
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the loops.
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    sheet, panel = style.one_panel(4.0, ax)
    scale = conventions.scale("rad")
    for number, loop in enumerate(loops.loops):
        colour = style.PALETTE[number % len(style.PALETTE)]
        twist = loop.twist * scale
        label = f"{loop.amplitude.value * scale:.3g} {conventions.unit('rad')} about {loop.mean_torque:.3g} N·m"
        # Solid: both mean branches as one line around the loop. Dashed: the spring line fitted between them.
        around = np.r_[twist, twist[::-1]], np.r_[loop.upper, loop.lower[::-1]]
        panel.plot(*around, color=colour, linewidth=0.9, label=label)
        panel.plot(twist, loop.spring_line, color=colour, linewidth=1.3, linestyle="--")
        # Dots where stages begin, at negative twists on the coast side.
        begins = [
            (1 if stage.side == "drive" else -1) * stage.begins.value
            for stage in loop.stages
            if stage.begins is not None and stage.side != "both"
        ]
        at = np.array([begin for begin in begins if loop.twist[0] <= begin <= loop.twist[-1]])
        panel.plot(at * scale, np.interp(at, loop.twist, loop.spring_line), "o", color=colour, markersize=4)
    panel.set_xlabel(f"twist [{conventions.unit('rad')}]")
    panel.set_ylabel("torque [N·m]")
    panel.legend(fontsize=style.FONT - 1)
    style.style_axes(panel)
    return sheet.titled(loops.title if title is None else title)


def stepped_stiffness(
    stepped: SteppedStiffness,
    model: NDArray[np.complex128] | None = None,
    title: str = "",
    ax: GivenAxes = None,
) -> Figure:
    """Figure of k' and eta_1 over the amplitude of the twist, circles of the test, crosses of the model.

    ``ax`` are two axes to draw into; by default those of a new figure.
    """
    sheet, (upper, lower) = style.stacked_panels(5.4, ["k'", "eta_1"], ax)
    at = np.rad2deg(stepped.amplitudes)
    pairs = [(stepped.stiffness, "o", style.PALETTE[0], "test")]
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
    return sheet.titled(title or stepped.title or "Stiffness over amplitude")

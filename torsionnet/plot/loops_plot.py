"""Plot of loops of torque over twist, with branches, spring line and stages."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.signals.torque_loops.loop_result import TorqueLoops


def torque_loops(
    found: TorqueLoops, *, conventions: Conventions = SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of the loops of a test: mean branches, the fitted spring line dashed, and dots where stages begin.

    Parameters
    ----------
    found : TorqueLoops
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
    for number, loop in enumerate(found.loops):
        colour = style.PALETTE[number % len(style.PALETTE)]
        twist = loop.twist * scale
        label = f"{loop.amplitude.value * scale:.3g} {conventions.unit('rad')} about {loop.mean_torque:.3g} N·m"
        around = np.r_[twist, twist[::-1]], np.r_[loop.upper, loop.lower[::-1]]
        panel.plot(*around, color=colour, linewidth=0.9, label=label)
        panel.plot(twist, loop.spring_line, color=colour, linewidth=1.3, linestyle="--")
        begins = [
            (1 if one.side == "drive" else -1) * one.begins.value
            for one in loop.stages
            if one.begins is not None and one.side != "both"
        ]
        at = np.array([one for one in begins if loop.twist[0] <= one <= loop.twist[-1]])
        panel.plot(at * scale, np.interp(at, loop.twist, loop.spring_line), "o", color=colour, markersize=4)
    panel.set_xlabel(f"twist [{conventions.unit('rad')}]")
    panel.set_ylabel("torque [N·m]")
    panel.legend(fontsize=style.FONT - 1)
    style.style_axes(panel)
    return sheet.titled(found.title if title is None else title)

"""Picture of the page on laws of motion: torque over twist or slip of each kind of law."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from sign_picture import save

import torsionnet as tn
from torsionnet.base.expressions import FLOAT
from torsionnet.model.elements import Element, MotionLaw, Values
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve
from torsionnet.plot.drawing import style

ENDS = ("a", "b")
LAWS: dict[str, tuple[Element, float, str]] = {
    "stages, the second with preload": (
        tn.Spring("e", ENDS, stages=[{"stiffness": 460, "to": "0.12 rad"}, {"stiffness": 1500, "preload": 30}]),
        0.2,
        "twist in rad",
    ),
    "cubic": (tn.Spring("e", ENDS, stiffness=400, cubic=2e4), 0.2, "twist in rad"),
    "clearance": (tn.Clearance("e", ENDS, gap=0.16, stiffness=2000, damping=12), 0.2, "twist in rad"),
    "friction that falls with slip": (
        tn.Friction("e", ENDS, stick=30, torque_over_slip=[[0, 24], [6, 15], [20, 17]]),
        20.0,
        "slip in rad/s",
    ),
}
"""Element, end of the axis and its label, by title."""


def write(folder: Path) -> None:
    """Write the picture as SVG."""
    figure = Figure(figsize=(7.2, 5.4), layout="constrained", facecolor="white")
    for axes, (title, (element, end, label)) in zip(figure.subplots(2, 2).flat, LAWS.items(), strict=True):
        (law,) = (part for part in element.whole_parts(Values({}, FLOAT)) if isinstance(part, MotionLaw))
        _draw(axes, law, end, parting=isinstance(element, tn.Clearance))
        axes.set(xlabel=label, ylabel="torque in N m", xlim=(-end, end))
        axes.set_title(title, fontsize=10)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    save(figure, folder / "laws_of_motion.svg")


def _draw(axes: Any, law: MotionLaw, end: float, *, parting: bool) -> None:
    """Draw the torque at rest, each step as a vertical line, and with a broken line that of parting bodies."""
    over_twist = law.curve.over == "twist"
    steps = law.curve.pieces if isinstance(law.curve, PieceCurve) else ()
    holds = [piece for piece in steps if isinstance(piece, Hold)]
    at = np.linspace(-end, end, 801)
    torques = np.array([float(law.torque(x, 0.0) if over_twist else law.torque(0.0, x)) for x in at])
    for hold in holds:
        torques[np.argmin(abs(at - float(hold.at)))] = np.nan
        axes.plot([hold.at, hold.at], [hold.low, hold.high], color=style.PALETTE[1], linewidth=2.2)
    axes.axhline(0, color=style.MUTED, linewidth=0.6)
    axes.axvline(0, color=style.MUTED, linewidth=0.6)
    axes.plot(at, torques, color=style.PALETTE[0])
    if parting:
        apart = [float(law.torque(x, -12.0 if x > 0 else 12.0)) for x in at]
        axes.plot(at, apart, color=style.PALETTE[0], linestyle="--", linewidth=1, label="bodies part at 12 rad/s")
        axes.legend(loc="upper left", fontsize=8, framealpha=1)

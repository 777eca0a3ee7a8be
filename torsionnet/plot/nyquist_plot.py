"""Nyquist plot of a control loop opened at its controller, with the stability margins."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.plot.drawing.style import GivenAxes

if TYPE_CHECKING:
    from torsionnet.linear.frequency_response import FloatArray
    from torsionnet.linear.responses.loop_margins import LoopMargins

SMALLEST_LOOP = 0.01
"""Smallest loop gain |L| of the frequencies shown, as a share of the largest gain if that is below 1; they end at its
reciprocal."""
LARGEST_LOOP = 3.0
"""Loop gain |L| up to which the loop is drawn to scale in the complex plane; a larger L is drawn at this distance, so
that -1 stays visible."""


def nyquist(margins: LoopMargins, *, title: str | None = None, ax: GivenAxes = None) -> Figure:
    """Figure of the open control loop L(j omega) in the complex plane, and its magnitude and phase over frequency.

    Parameters
    ----------
    margins : LoopMargins
        Result of :meth:`torsionnet.Drivetrain.loop_margins`.
    title : str, optional
        By default the controller at which the loop is opened.
    ax : sequence of Axes, optional
        Axes to draw into, for the complex plane, magnitude and phase; by default those of a new figure.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.Drivetrain("governed", [tn.Inertia("rotor", node="a", inertia=2),
    ...     tn.Controller("governor", sense={"velocity": "a"}, act="a", law=-30, delay="50 ms")])
    >>> [axes.get_xlabel() for axes in nyquist(rig.loop_margins()).axes]
    ['real part of L', '', 'frequency [Hz]']
    """
    shows = [["complex plane", "magnitude"], ["complex plane", "phase"]]
    sheet = style.mosaic_panels(4.1, shows, ax, width_ratios=(1.1, 1))
    plane, size, phase = sheet.panels
    style.share_axis(phase, size, "sharex")
    _plane(plane, margins)
    _over_frequency(size, phase, margins)
    sheet.legend(3)
    words = f"{margins.title}: loop opened at {margins.controller}"
    words += "" if margins.stable else " (unstable)"
    return sheet.titled(words if title is None else title)


def _plane(axes: Axes, margins: LoopMargins) -> None:
    style.style_axes(axes)
    loop = margins.loop * np.minimum(1, LARGEST_LOOP / np.maximum(np.abs(margins.loop), 1e-300))
    axes.plot(loop.real, loop.imag, color=style.PALETTE[0], linewidth=1.4, label="L, frequency > 0")
    # L(-j omega) is the conjugate of L(j omega).
    axes.plot(loop.real, -loop.imag, color=style.PALETTE[0], linewidth=0.7, linestyle="--")
    turn = np.linspace(0, 2 * np.pi, 361)
    axes.plot(np.cos(turn), np.sin(turn), color=style.INK, linewidth=0.6, alpha=0.5)
    axes.plot([-1], [0], "+", color=style.PALETTE[1], markersize=10, markeredgewidth=2, label="-1")
    # k L is -1 where L = -1/k, and L exp(-j phi) is -1 where L = -exp(j phi).
    if math.isfinite(margins.gain_increase.value):
        text = f"gain × {margins.gain_increase.value:.3g}"
        axes.plot([-1 / margins.gain_increase.value], [0], "D", color=style.PALETTE[2], markersize=4, label=text)
    if math.isfinite(margins.phase.value):
        point = -np.exp(1j * math.radians(margins.phase.value))
        text = f"phase {margins.phase.value:.3g}°"
        axes.plot([point.real], [point.imag], "o", color=style.PALETTE[3], markersize=5, label=text)
    axes.set_aspect("equal")
    axes.set_xlabel("real part of L")
    axes.set_ylabel("imaginary part of L")


def _over_frequency(size: Axes, phase: Axes, margins: LoopMargins) -> None:
    for axes in (size, phase):
        style.style_axes(axes)
        axes.set_xscale("log")
    shown = _shown_range(margins)
    f, loop = margins.frequencies[shown], margins.loop[shown]
    size.loglog(f, np.abs(loop), color=style.PALETTE[0], linewidth=1.2)
    size.axhline(1, color=style.INK, linewidth=0.6)
    size.set_ylabel("|L|")
    phase.plot(*_broken(f, np.degrees(np.angle(loop))), color=style.PALETTE[0], linewidth=1.2)
    if len(f) > 1:
        phase.set_xlim(f[0], f[-1])
    phase.set_ylabel("phase of L [°]")
    phase.set_yticks([-180, -90, 0, 90, 180])
    phase.set_xlabel("frequency [Hz]")
    for margin, color in ((margins.gain_increase, style.PALETTE[2]), (margins.phase, style.PALETTE[3])):
        if math.isfinite(margin.frequency):
            for axes in (size, phase):
                axes.axvline(margin.frequency, color=color, linewidth=0.8)


def _shown_range(margins: LoopMargins) -> slice:
    """Slice of the frequencies from the first to the last at which a control loop's gain |L| is in the range shown."""
    sizes = np.abs(margins.loop)
    low, high = SMALLEST_LOOP * min(1.0, float(sizes.max(initial=0.0))), 1 / SMALLEST_LOOP
    places = np.flatnonzero((sizes >= low) & (sizes <= high))
    return slice(int(places[0]), int(places[-1]) + 1) if len(places) > 1 else slice(None)


def _broken(f: FloatArray, degrees: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Arrays of frequencies in Hz, and of phases from -180 to 180 degrees, with a gap (nan) where the phase jumps."""
    jumps = np.flatnonzero(np.abs(np.diff(degrees)) > 180) + 1
    return np.insert(f, jumps, np.nan), np.insert(degrees, jumps, np.nan)

"""Plots of toothed wheels: speed over time with what is uncertain, and the pitch pattern."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import Conventions
from torsionnet.base.number_text import typeset_unit
from torsionnet.base.units import RPM
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.plot.histories import thin_out
from torsionnet.signals.rotation.calibration_result import WheelCalibration
from torsionnet.signals.rotation.wheel_rotation import WheelRotation

# Plot of the speed of toothed wheels over time, and of what counter and teeth leave of the angle uncertain.


def wheel_rotations(wheels: Sequence[WheelRotation], *, title: str = "", ax: GivenAxes = None) -> Figure:
    """Figure of the speeds of wheels in rpm over time, and below of the standard deviation of their angles in deg.

    Thin lines are the share that times of pulses have: counter and jitter. The rest is that of the places of teeth.

    Parameters
    ----------
    wheels : sequence of WheelRotation
    title : str, optional
    ax : sequence of Axes, optional
        Axes to draw into, for speeds and deviations of angles; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from torsionnet.signals.rotation.pulse_channel import PulseChannel
    >>> from torsionnet.signals import Wheel, wheel_rotation
    >>> channel = PulseChannel("n1", np.round(np.arange(6000) / 601.3, 6), tick=1e-6)
    >>> [axes.get_ylabel() for axes in wheel_rotations([wheel_rotation(channel, Wheel(teeth=60))]).axes]
    ['speed [rpm]', 'deviation of angle [deg]']
    """
    sheet, (above, below) = style.stacked_panels(4.5, ["speed", "deviation of angle"], ax)
    for number, wheel in enumerate(wheels):
        colour = style.PALETTE[number % len(style.PALETTE)]
        above.plot(*thin_out(wheel.times, wheel.speeds * RPM), color=colour, linewidth=0.7, label=wheel.name)
        times, deviation = thin_out(wheel.times, np.degrees(wheel.angle_deviation))
        below.plot(times, deviation, color=colour, linewidth=1.8, label="" if number else "total")
        of_times = np.degrees(wheel.deviations.time * np.abs(wheel.speeds))
        if of_times.any():
            label = "" if number else "share of counter and jitter"
            below.plot(*thin_out(wheel.times, of_times), color=colour, linewidth=0.7, label=label)
    if any(np.asarray(line.get_ydata()).max(initial=0.0) > 0 for line in below.lines):
        below.set_yscale("log")
    above.set_ylabel("speed [rpm]")
    below.set_ylabel("deviation of angle [deg]")
    below.set_xlabel("time [s]")
    below.set_xlim(min(wheel.times[0] for wheel in wheels), max(wheel.times[-1] for wheel in wheels))
    above.legend(loc="best")
    below.legend(loc="best")
    sheet.figure.align_ylabels([above, below])
    return sheet.titled(title)


# Plot of the pitch pattern of a wheel, over its teeth and over orders.

DEGREES = Conventions(angle="deg")
"""Unit of angles by default: errors of teeth are given in degrees."""


def wheel_pattern(
    calibration: WheelCalibration,
    *,
    conventions: Conventions = DEGREES,
    title: str | None = None,
    ax: GivenAxes = None,
) -> Figure:
    """Figure of a wheel's pitch pattern, positions of its teeth above, amplitudes of its orders with intervals below.

    Parameters
    ----------
    calibration : WheelCalibration
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the calibration.
    ax : sequence of Axes, optional
        Axes to draw into, for positions and orders; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    scale, unit = conventions.scale("rad"), typeset_unit(conventions.unit("rad"))
    sheet = style.mosaic_panels(5.0, [["positions of the teeth"], ["orders"]], ax)
    above, below = sheet.panels
    _teeth(above, calibration, scale)
    _orders(below, calibration, scale)
    above.set_ylabel(f"position of the tooth [{unit}]")
    below.set_ylabel(f"peak amplitude [{unit}]")
    return sheet.titled(calibration.title if title is None else title)


def _teeth(axes: Axes, calibration: WheelCalibration, scale: float) -> None:
    pattern = calibration.pattern
    teeth = np.arange(pattern.teeth - pattern.missing)
    positions, widths = pattern.positions[teeth] * scale, pattern.half_widths[teeth] * scale
    axes.axhline(0.0, color=style.MUTED, linewidth=0.8)
    axes.fill_between(
        teeth,
        positions - widths,
        positions + widths,
        color=style.PALETTE[0],
        alpha=0.2,
        linewidth=0,
        label="95 % interval",
    )
    axes.plot(teeth, positions, color=style.PALETTE[0], marker="o", markersize=2.5, linewidth=0.8, label="position")
    axes.set_xlabel("tooth")
    axes.set_xlim(-0.5, pattern.teeth - 0.5)
    style.legend_beside(axes)


def _orders(axes: Axes, calibration: WheelCalibration, scale: float) -> None:
    """Bars of the orders: full where they are resolved, empty where a part may be vibration."""
    for resolved, label in ((True, "of the pattern"), (False, "not resolved")):
        rows = [row for row in calibration.orders if row.resolved is resolved]
        if not rows:
            continue
        orders, sizes = [row.order for row in rows], np.array([abs(row.value) for row in rows]) * scale
        widths = np.array([row.half_width if np.isfinite(row.half_width) else 0.0 for row in rows]) * scale
        face = style.PALETTE[0] if resolved else style.PAPER
        axes.bar(orders, sizes, width=0.7, facecolor=face, edgecolor=style.PALETTE[0], linewidth=0.8, label=label)
        axes.errorbar(orders, sizes, widths, fmt="none", ecolor=style.INK, elinewidth=0.8, capsize=1.5)
    axes.set_xlabel("order of the wheel")
    axes.set_xlim(0, calibration.orders[-1].order + 1)
    axes.set_ylim(bottom=0)
    style.legend_beside(axes)

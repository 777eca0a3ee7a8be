"""Plots of recorded signals: spectrograms, order maps, toothed wheels, and loops of torque over twist."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.number_text import typeset_unit
from torsionnet.base.units import RPM
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.plot.histories import thin_out
from torsionnet.signals.order_tracking import Harmonics, OrderMap
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.pulse_deviations import WheelCalibration
from torsionnet.signals.rotation.wheel_rotation import WheelRotation
from torsionnet.signals.spectra import Spectrogram
from torsionnet.signals.torque_loops.loop_result import TorqueLoops

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from torsionnet.signals.stepped_levels import SteppedStiffness


# Plots of spectrograms over time and frequency, order maps over speed and order, and the harmonics of a sweep.

COLOURS = "viridis"
HEADROOM = 1.1
"""Factor from the highest frequency whose level the colours show to the upper end of the axis."""


def spectrogram(
    result: Spectrogram,
    *,
    up_to: float | None = None,
    span: float = 60.0,
    conventions: Conventions = SI,
    title: str | None = None,
    ax: Axes | None = None,
) -> Figure:
    """Figure of a signal's spectrogram, with its level in dB in colours over time and frequency.

    Parameters
    ----------
    result : Spectrogram
    up_to : float, optional
        Upper end of the frequency axis, Hz; by default a tenth above the last level that the colours show.
    span : float, optional
        dB below the highest level at which the colours end.
    conventions : Conventions, optional
        Unit of angles, reference of the decibels.
    title : str, optional
        By default the name of the signal.
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from torsionnet.signals import Recording, Signal
    >>> from torsionnet.signals import spectrogram as calculated
    >>> record = Recording((Signal("T", "torque", np.sin(np.arange(2000.0))),), sampling_rate=200)
    >>> spectrogram(calculated(record, "T")).axes[0].get_ylabel()
    'frequency [Hz]'
    """
    scale = conventions.scale(result.unit) if result.unit else 1.0
    levels = result.decibels(conventions.db_reference / scale)
    unit = typeset_unit(conventions.unit(result.unit)) if result.unit else "unknown unit"
    label = f"{result.name} [dB re {conventions.db_reference:g} {unit}]"
    sheet, ((axes,),) = style.grid_panels(style.WIDTH, 3.6, [""], ax)
    kept = result.frequencies <= (_last_shown(result.frequencies, levels, span) if up_to is None else up_to)
    _map(axes, result.times, result.frequencies[kept], levels[kept], span, label)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("frequency [Hz]")
    return sheet.titled(result.name if title is None else title)


def _last_shown(frequencies: FloatArray, levels: FloatArray, span: float) -> float:
    """Upper end in Hz of the frequency axis of a spectrogram: a tenth above the last level that the colours show."""
    top = levels[np.isfinite(levels)].max(initial=-np.inf)
    carrying = np.flatnonzero((levels > top - span).any(axis=1))
    return float(HEADROOM * frequencies[carrying[-1]]) if len(carrying) and frequencies[carrying[-1]] else np.inf


def order_map(
    result: OrderMap,
    *,
    span: float = 60.0,
    conventions: Conventions = SI,
    title: str | None = None,
    ax: Axes | None = None,
) -> Figure:
    """Figure of a signal's order map, with its level in dB in colours over speed and order.

    Parameters
    ----------
    result : OrderMap
    span : float, optional
        dB below the highest level at which the colours end.
    conventions : Conventions, optional
    title : str, optional
        By default the name of the signal.
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.
    """
    scale = conventions.scale(result.unit) if result.unit else 1.0
    with np.errstate(divide="ignore"):
        levels = 20 * np.log10(result.amplitude * scale / conventions.db_reference)
    unit = typeset_unit(conventions.unit(result.unit)) if result.unit else "unknown unit"
    sheet, ((axes,),) = style.grid_panels(style.WIDTH, 3.6, [""], ax)
    speeds = result.speeds * 60 / (2 * np.pi)
    rising = np.argsort(speeds, kind="stable")
    label = f"{result.name} [dB re {conventions.db_reference:g} {unit}]"
    _map(axes, speeds[rising], result.orders, levels[:, rising], span, label)
    axes.set_xlabel("speed [rpm]")
    axes.set_ylabel("order [-]")
    return sheet.titled(result.name if title is None else title)


def sweep_harmonics(
    result: Harmonics, *, conventions: Conventions = SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of the amplitude, and the phase in degrees, of every order of a signal over the frequency of the sweep.

    Parameters
    ----------
    result : Harmonics
    conventions : Conventions, optional
    title : str, optional
        By default the name of the signal.
    ax : sequence of Axes, optional
        Axes to draw into, for amplitude and phase; by default those of a new figure.
    """
    scale = conventions.scale(result.unit) if result.unit else 1.0
    unit = typeset_unit(conventions.unit(result.unit)) if result.unit else "unknown unit"
    sheet, (size, phase) = style.stacked_panels(4.2, ["amplitude", "phase"], ax, shares=[3, 2])
    for number, order in enumerate(result.orders):
        look = style.line_style(number)
        size.plot(result.frequencies, result.amplitude[:, number] * scale, label=f"{order:g}x", **look)
        phase.plot(result.frequencies, np.unwrap(result.phase[:, number], period=360), **look)
    size.set_yscale("log")
    style.log_ticks(size.yaxis, *size.get_ylim())
    size.set_ylabel(f"amplitude [{unit}]")
    phase.set_ylabel("phase [deg]")
    phase.set_xlabel("frequency of the sweep [Hz]")
    sheet.legend(len(result.orders))
    return sheet.titled(result.name if title is None else title)


def _map(axes: Axes, x: FloatArray, y: FloatArray, levels: FloatArray, span: float, label: str) -> None:
    finite = levels[np.isfinite(levels)]
    top = float(finite.max()) if finite.size else 0.0
    shown: Any = axes.pcolormesh(
        x,
        y,
        np.maximum(levels, top - span),
        cmap=COLOURS,
        vmin=top - span,
        vmax=top,
        shading="nearest",
        rasterized=True,
    )
    style.style_axes(axes)
    axes.grid(visible=False)
    bar = axes.figure.colorbar(shown, ax=axes, pad=0.02)
    bar.set_label(label, fontsize=style.FONT, color=style.INK)
    bar.ax.tick_params(labelsize=style.SMALL)
    bar.outline.set_visible(False)


# Plots of toothed wheels: speed over time with what is uncertain, and the pitch pattern.

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


# Plots of a component bench: loops of torque over twist, and stiffness and loss over the amplitude of a sine.


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

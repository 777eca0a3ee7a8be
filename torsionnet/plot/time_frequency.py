"""Plots of spectrograms over time and frequency, order maps over speed and order, and the harmonics of a sweep."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.number_text import typeset_unit
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.signals.order_tracking import Harmonics, OrderMap
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.spectra import Spectrogram

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

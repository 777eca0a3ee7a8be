"""Plot of measured complex orders over speed, amplitudes with their intervals as bands, and phases."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.plot.drawing.speed_axis import curve_mark, fit_speeds, is_steady
from torsionnet.plot.drawing.torque_units import axis_label, axis_unit
from torsionnet.signals.orders.tracked_orders import TrackedOrders

MOST_LINES = 6
"""Largest number of orders drawn, those of largest amplitude; more could not be told apart by colour and dashes."""
CLEAR_PHASE = 3.0
"""Amplitude over half width from which a phase is drawn: below, its interval is wider than 40 degrees."""


def tracked_orders(
    tracked: TrackedOrders,
    orders: Sequence[float] | None = None,
    *,
    most: int = MOST_LINES,
    conventions: Conventions = SI,
    title: str | None = None,
) -> Figure:
    """Figure of the amplitudes of measured orders over speed with their 95 % intervals, half range, and phases below.

    Parameters
    ----------
    tracked : TrackedOrders
    orders : sequence of float, optional
        By default those of largest amplitude.
    most : int
        Orders drawn.
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default the channel, with the title of the record.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        An order was not tracked.
    """
    if orders is None:
        largest = np.argsort(-np.abs(tracked.values).max(axis=1), kind="stable")[:most]
        orders = sorted(tracked.orders[largest].tolist())
    phased = [order for order in orders if tracked.reference and order not in tracked.undecided]
    rising = np.argsort(tracked.speeds, kind="stable")
    rpm = tracked.rpm[rising]
    figure = style.new_figure(style.WIDTH, 5.4 if phased else 3.4)
    panels = figure.subplots(
        2 if phased else 1, 1, sharex=True, squeeze=False, gridspec_kw={"height_ratios": [2, 1][: 1 + bool(phased)]}
    )[:, 0]
    top = panels[0]
    highest = np.abs(tracked.values).max() if tracked.half_range is None else tracked.half_range.max()
    scale, unit = axis_unit(tracked.unit, float(highest), conventions)
    for panel in panels:
        style.style_axes(panel)
    if tracked.half_range is not None:
        marks = curve_mark(rpm)
        top.plot(rpm, tracked.half_range[rising] * scale, color=style.INK, linewidth=2.0, label="half range", **marks)
    for number, order in enumerate(orders):
        drawn = style.line_style(number)
        if is_steady(rpm):
            drawn |= {"marker": "o", "markersize": 4}
        values = tracked.along(order)[rising]
        widths = np.nan_to_num(tracked.half_widths[_place(tracked, order), rising])
        size = np.abs(values) * scale
        low, high = np.maximum(size - widths * scale, 0), size + widths * scale
        top.fill_between(rpm, low, high, color=drawn["color"], alpha=0.2, linewidth=0)
        top.plot(rpm, size, label=f"order {order:g}", **drawn)
        if order in phased:
            clear = np.abs(values) > CLEAR_PHASE * widths
            panels[1].plot(rpm, np.where(clear, np.degrees(np.angle(values)), np.nan), **drawn | {"marker": "."})
    top.set_ylabel(axis_label(f"{tracked.name}, peak", unit))
    top.set_ylim(bottom=0)
    top.legend(fontsize=style.SMALL, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    if phased:
        panels[1].set_ylabel("phase [deg]")
        panels[1].set_ylim(-180, 180)
        panels[1].yaxis.set_major_locator(MultipleLocator(90))
    panels[-1].set_xlabel("speed of the reference shaft [rpm]")
    panels[-1].set_xlim(rpm[0], rpm[-1] if rpm[-1] > rpm[0] else None)
    fit_speeds(panels[-1], rpm)
    named = f"{tracked.title}: {tracked.name}" if tracked.title else f"{tracked.name}, measured orders"
    style.set_title(figure, named if title is None else title)
    return figure


def _place(tracked: TrackedOrders, order: float) -> int:
    return int(np.abs(tracked.orders - order).argmin())

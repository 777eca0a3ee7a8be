"""Plot of measured orders as dots over speed, amplitude and phase with intervals, with the calculated ones as lines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.units import RPM
from torsionnet.linear.phase import unwrapped_phase
from torsionnet.machinery.orders.order_comparison import ComparedOrder, compared_orders
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.plot.drawing.labels import axis_label, axis_unit, speed_label
from torsionnet.plot.drawing.style import GivenAxes, curve_mark, fit_speeds, is_steady
from torsionnet.signals.orders.tracked_orders import MeasuredOrder, TrackedOrders

MARKERS = ("o", "s", "^", "D", "v")
MOST_ORDERS = 6
"""Most orders that a panel shows, as more cannot be told apart: those with the largest amplitudes, calculated or
measured beyond their intervals."""
HEADROOM = 1.15
"""Factor from the largest amplitude to the upper end of a panel; wide intervals of small orders reach beyond it."""


WIDTH_ALPHA = 0.5
"""Opacity of the lines of intervals, which are behind the dots."""


def order_overlay(
    response: OrderResponse,
    measured: Mapping[str, Sequence[MeasuredOrder]],
    *,
    conventions: Conventions = SI,
    title: str | None = None,
    swept: Mapping[str, Sequence[MeasuredOrder]] = MappingProxyType({}),
    ax: GivenAxes = None,
) -> Figure:
    """Figure of amplitudes of orders over speed, measured as dots, calculated as lines, a panel for each output.

    Of many orders the six strongest are drawn. Intervals of 95 % are upright lines through the dots. Where phases are
    compared a panel of phases in degrees stands below that of the amplitudes.

    Parameters
    ----------
    response : OrderResponse
    measured : mapping
        Output -> its measured orders; one panel each.
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the response.
    swept : mapping, optional
        Output -> orders of the model along the speed over time of the test, in place of the steady ones.
    ax : sequence of Axes, optional
        Axes to draw into, for amplitudes and, if compared, phases of each output; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        No such output, or none of the measured orders was calculated.
    """
    pairs = {
        name: _strongest(compared_orders(response, name, orders, swept.get(name, ())))
        for name, orders in measured.items()
    }
    shown = [
        (name, compared, phase)
        for name, compared in pairs.items()
        for phase in (False, True)
        if not phase or any(order.pair.has_phase for order in compared)
    ]
    ratios = [0.6 if phase else 1.0 for *_, phase in shown]
    shows = [f"phase of {name}" if phase else name for name, _, phase in shown]
    sheet, panels = style.stacked_panels(0.8 + 2.6 * sum(ratios), shows, ax, shares=ratios)
    for panel, (name, compared, phase) in zip(panels, shown, strict=True):
        if phase:
            _phases(panel, compared)
            continue
        unit = response.outputs[response.output(name)].unit
        largest = max(float(max(order.curve.max(), order.measured.amplitude.max())) for order in compared)
        scale, words = axis_unit(unit, largest, conventions)
        _amplitudes(panel, compared, scale)
        panel.set_ylabel(f"{name} [{words}]")
        panel.set_ylim(0, HEADROOM * largest * scale or None)
        style.legend_beside(panel)
    panels[-1].set_xlabel(speed_label(response.reference))
    everything = [order for compared in pairs.values() for order in compared]
    # The axis holds the speeds of the test and those of the model.
    drawn = [speeds for order in everything for speeds in (order.pair.curve_speeds, order.measured.speeds)]
    fit_speeds(panels[-1], np.concatenate(drawn) * RPM)
    return sheet.titled(response.title if title is None else title)


def _strongest(pairs: Sequence[ComparedOrder]) -> list[ComparedOrder]:
    """Orders of a panel with the largest amplitudes, in their order."""

    def size(o: ComparedOrder) -> float:
        width = o.pair.half_widths
        seen = o.measured.amplitude - (0.0 if width is None or len(width) != len(o.measured.amplitude) else width)
        return float(max(np.nanmax(np.abs(o.pair.curve)), np.nanmax(seen)))

    sizes = [size(order) for order in pairs]
    kept = sorted(range(len(pairs)), key=lambda place: -sizes[place])[:MOST_ORDERS]
    return [pairs[place] for place in sorted(kept)]


def _amplitudes(panel: Axes, pairs: Sequence[ComparedOrder], scale: float) -> None:
    for number, order in enumerate(pairs):
        drawn = style.line_style(number)
        rpm, label = order.measured.speeds * RPM, f"order {order.measured.order:g}"
        model = "model, at most" if order.pair.bound else "model, swept" if order.pair.swept else "model"
        panel.plot(
            order.pair.curve_speeds * RPM,
            np.abs(order.pair.curve) * scale,
            label=f"{label}, {model}",
            **drawn | curve_mark(order.pair.curve_speeds),
        )
        size = order.measured.amplitude * scale
        panel.plot(rpm, size, color=drawn["color"], label=f"{label}, test", **_dots(number))
        if order.pair.half_widths is not None:
            width = order.pair.half_widths * scale
            panel.vlines(rpm, np.maximum(size - width, 0), size + width, color=drawn["color"], alpha=WIDTH_ALPHA)


def _phases(panel: Axes, pairs: Sequence[ComparedOrder]) -> None:
    """Phases in degrees; a measured one is drawn in the turn of the calculated one."""
    drawn_phases = []
    for number, order in enumerate(pairs):
        pair = order.pair
        if not pair.has_phase:
            continue
        drawn = style.line_style(number)
        curve = unwrapped_phase(pair.curve)
        panel.plot(pair.curve_speeds * RPM, curve, **drawn | curve_mark(pair.curve_speeds))
        beside = np.interp(pair.speeds, pair.curve_speeds, curve)
        apart = np.degrees(np.angle(pair.measured * np.exp(-1j * np.radians(beside))))
        panel.plot(pair.speeds * RPM, beside + apart, color=drawn["color"], **_dots(number))
        if pair.half_widths is not None:
            # An error of size w turns a phasor of length |X| by arcsin(w/|X|) at most.
            with np.errstate(divide="ignore"):
                width = np.degrees(np.arcsin(np.minimum(pair.half_widths / np.abs(pair.measured), 1.0)))
            ends = beside + apart - width, beside + apart + width
            panel.vlines(pair.speeds * RPM, *ends, color=drawn["color"], alpha=WIDTH_ALPHA)
        drawn_phases += [curve, beside + apart]
    known = np.concatenate(drawn_phases)
    style.phase_ticks(panel, float(np.nanmin(known)), float(np.nanmax(known)))
    panel.set_ylabel("phase [deg]")


def _dots(number: int) -> dict[str, Any]:
    return {"linestyle": "none", "marker": MARKERS[number % len(MARKERS)], "markersize": 3.5}


# Plot of measured complex orders over speed, amplitudes with their intervals as bands, and phases.

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
    ax: GivenAxes = None,
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
    ax : sequence of Axes, optional
        Axes to draw into, for amplitudes and, if there are any, phases; by default those of a new figure.

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
    # Phases are against a reference; an order whose turn within the cycle is open has none.
    phased = [order for order in orders if tracked.reference and order not in tracked.undecided]
    # Lines go by rising speed, also where the test ran down.
    rising = np.argsort(tracked.speeds, kind="stable")
    rpm = tracked.rpm[rising]
    height, shows, shares = (5.4, ["amplitude", "phase"], [2, 1]) if phased else (3.4, ["amplitude"], [1])
    sheet, panels = style.stacked_panels(height, shows, ax, shares=shares)
    top = panels[0]
    highest = np.abs(tracked.values).max() if tracked.half_range is None else tracked.half_range.max()
    scale, unit = axis_unit(tracked.unit, float(highest), conventions)
    if tracked.half_range is not None:
        marks = curve_mark(rpm)
        top.plot(rpm, tracked.half_range[rising] * scale, color=style.INK, linewidth=2.0, label="half range", **marks)
    for number, order in enumerate(orders):
        drawn = style.line_style(number)
        if is_steady(rpm):
            drawn |= {"marker": "o", "markersize": 4}
        values = tracked.along(order)[rising]
        place = int(np.abs(tracked.orders - order).argmin())
        widths = np.nan_to_num(tracked.half_widths[place, rising])
        size = np.abs(values) * scale
        low, high = np.maximum(size - widths * scale, 0), size + widths * scale
        top.fill_between(rpm, low, high, color=drawn["color"], alpha=0.2, linewidth=0)
        top.plot(rpm, size, label=f"order {order:g}", **drawn)
        if order in phased:
            # An amplitude that its interval nearly holds may have any phase.
            clear = np.abs(values) > CLEAR_PHASE * widths
            panels[1].plot(rpm, np.where(clear, np.degrees(np.angle(values)), np.nan), **drawn | {"marker": "."})
    top.set_ylabel(axis_label(f"{tracked.name}, peak", unit))
    top.set_ylim(bottom=0)
    style.legend_beside(top)
    if phased:
        panels[1].set_ylabel("phase [deg]")
        panels[1].set_ylim(-180, 180)
        panels[1].yaxis.set_major_locator(MultipleLocator(90))
    panels[-1].set_xlabel("speed of the reference shaft [rpm]")
    panels[-1].set_xlim(rpm[0], rpm[-1] if rpm[-1] > rpm[0] else None)
    fit_speeds(panels[-1], rpm)
    named = f"{tracked.title}: {tracked.name}" if tracked.title else f"{tracked.name}, measured orders"
    return sheet.titled(named if title is None else title)

"""Plot of measured amplitudes of orders as dots over speed, with the calculated amplitudes as lines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.core.units import RPM
from torsionnet.plot.drawing.torque_units import axis_unit, speed_label
from torsionnet.response import Conventions
from torsionnet.response.conventions import SI
from torsionnet.response.order_comparison import MeasuredOrder, compared_orders
from torsionnet.response.order_response import OrderResponse

MARKERS = ("o", "s", "^", "D", "v")


def order_overlay(
    response: OrderResponse,
    measured: Mapping[str, Sequence[MeasuredOrder]],
    *,
    conventions: Conventions = SI,
    title: str | None = None,
) -> Figure:
    """Figure of amplitudes of orders over speed, measured as dots, calculated as lines, a panel for each output.

    Parameters
    ----------
    response : OrderResponse
    measured : mapping
        Output -> its measured orders; one panel each.
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the response.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        No such output, or none of the measured orders was calculated.
    """
    figure = style.new_figure(style.WIDTH, 0.8 + 2.6 * len(measured))
    panels = figure.subplots(len(measured), 1, sharex=True, squeeze=False)[:, 0]
    for panel, (name, orders) in zip(panels, measured.items(), strict=True):
        unit = response.outputs[response.output(name)].unit
        pairs = compared_orders(response, name, orders)
        largest = max(float(max(pair.curve.max(), pair.measured.amplitude.max())) for pair in pairs)
        scale, shown = axis_unit(unit, largest, conventions)
        style.style_axes(panel)
        for number, pair in enumerate(pairs):
            drawn = style.line_style(number)
            rpm, label = pair.measured.speeds * RPM, f"order {pair.measured.order:g}"
            panel.plot(response.rpm, pair.curve * scale, label=f"{label}, model", **drawn)
            dots = {"linestyle": "none", "marker": MARKERS[number % len(MARKERS)], "markersize": 3.5}
            panel.plot(rpm, pair.measured.amplitude * scale, color=drawn["color"], label=f"{label}, test", **dots)
        panel.set_ylabel(f"{name} [{shown}]")
        panel.set_ylim(bottom=0)
        panel.legend(fontsize=style.SMALL, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    panels[-1].set_xlabel(speed_label(response.reference))
    style.set_title(figure, response.title if title is None else title)
    return figure

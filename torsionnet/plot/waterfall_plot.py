"""Waterfall plot of line spectra of an output at many speeds, one behind the other."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.plot.drawing.torque_units import axis_unit, speed_label
from torsionnet.signals.orders.tracked_orders import TrackedOrders

MOST_SPECTRA = 30
"""Largest number of spectra drawn, evenly chosen from those of all speeds; more would hide each other."""
LINE_HEIGHT, LINE_HALF_WIDTH = 0.15, 0.004
"""Height of the highest spectral line as a share of the range of speeds, and half the width of its foot as a share of
the range of frequencies."""
SMALLEST_ORDER = 0.02
"""Amplitude, relative to the largest one, from which on an order is named and has room on the frequency axis."""
NAME_DISTANCE = 0.025
"""Least distance of the names of two orders, as a share of the range of frequencies."""


def waterfall(
    response: OrderResponse | TrackedOrders,
    output: str | None = None,
    *,
    conventions: Conventions = SI,
    title: str | None = None,
) -> Figure:
    """Figure of line spectra of an output over frequency, each at the height of its speed, so that orders are rays.

    Parameters
    ----------
    response : OrderResponse or TrackedOrders
        Calculated orders, or measured ones of a channel.
    output : str, optional
        Needed where there are several.
    conventions : Conventions, optional
        Unit of angles of the output.
    title : str, optional
        By default that of the response.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        No such output, or several and no name.
    """
    lines = _measured(response) if isinstance(response, TrackedOrders) else _calculated(response, output)
    count = len(lines.rpm)
    chosen = np.unique(np.linspace(0, count - 1, min(count, MOST_SPECTRA)).round().astype(int))
    sizes = lines.sizes[chosen]
    scale, unit = axis_unit(lines.unit, float(sizes.max()), conventions)
    sizes = sizes * scale
    hertz, rpm = lines.hertz[chosen], lines.rpm[chosen]
    span = float(np.ptp(rpm)) or float(rpm[0])
    largest = float(sizes.max()) or 1.0
    tops = rpm[:, None] + sizes / largest * LINE_HEIGHT * span
    shown = sizes.max(axis=0) >= SMALLEST_ORDER * sizes.max()
    right = 1.05 * float(hertz[:, shown].max())
    figure = style.new_figure(style.WIDTH, 4.6)
    axes = figure.subplots()
    style.style_axes(axes)
    for number in range(len(chosen))[::-1]:  # those in front are drawn last and hide what is behind
        f, heights = _spectrum(hertz[number], sizes[number] / largest * LINE_HEIGHT * span, right)
        axes.fill_between(
            f, rpm[number], rpm[number] + heights, color=style.PAPER, linewidth=0, zorder=3 - number / 1e3
        )
        axes.plot(f, rpm[number] + heights, color=style.INK, linewidth=0.8, zorder=3 - number / 1e3)
    axes.set_xlim(0, right)
    axes.set_ylim(float(rpm.min()) - 0.02 * span, float(tops.max()) + 0.12 * span)
    _name_orders(axes, [(hertz[-1, k], tops[-1, k], name) for k, name in enumerate(lines.names) if shown[k]], right)
    bar = float(f"{largest:.1g}")
    foot = float(rpm.min())
    edge = 0.99 * right
    axes.plot(
        [edge, edge], [foot, foot + bar / largest * LINE_HEIGHT * span], color=style.PALETTE[1], linewidth=2.5, zorder=4
    )
    axes.annotate(f"{bar:g} {unit}", (edge, foot), xytext=(-6, 4), textcoords="offset points", ha="right",
                  fontsize=style.SMALL, color=style.PALETTE[1], zorder=5,
                  bbox={"facecolor": style.PAPER, "edgecolor": "none", "pad": 1})  # fmt: skip
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel(f"{lines.speed}, lines: {lines.channel}")
    style.set_title(figure, response.title if title is None else title)
    return figure


class _Lines(NamedTuple):
    """Lines of spectra at rising speeds, (n_speeds, n_lines), with the names of lines, axis and channel."""

    rpm: FloatArray
    hertz: FloatArray
    sizes: FloatArray
    names: tuple[str, ...]
    speed: str
    channel: str
    unit: str


def _calculated(response: OrderResponse, output: str | None) -> _Lines:
    place = response.output(output)
    channel = response.outputs[place]
    sizes, hertz = np.abs(response.values[:, :, place]), np.abs(response.frequencies)
    names = tuple(map(str, response.lines))
    return _Lines(response.rpm, hertz, sizes, names, speed_label(response.reference), channel.name, channel.unit)


def _measured(tracked: TrackedOrders) -> _Lines:
    rising = np.argsort(tracked.speeds, kind="stable")
    hertz = np.outer(tracked.speeds[rising], tracked.orders) / (2 * np.pi)
    names = tuple(f"order {order:g}" for order in tracked.orders)
    label = "speed of the reference shaft [rpm]"
    return _Lines(
        tracked.rpm[rising], hertz, np.abs(tracked.values.T[rising]), names, label, tracked.name, tracked.unit
    )


def _spectrum(hertz: FloatArray, sizes: FloatArray, right: float) -> tuple[FloatArray, FloatArray]:
    """Arrays of frequencies in Hz, and of heights in the unit of ``sizes``, of a spectrum drawn as narrow triangles."""
    half = LINE_HALF_WIDTH * right
    order = np.argsort(hertz, kind="stable")
    f = (hertz[order, None] + np.array([-half, 0.0, half])).ravel()
    heights = np.zeros_like(f)
    heights[1::3] = sizes[order]
    rising = np.argsort(f, kind="stable")
    return np.concatenate([[0.0], f[rising], [right]]), np.concatenate([[0.0], heights[rising], [0.0]])


def _name_orders(axes: Axes, ends: list[tuple[float, float, str]], right: float) -> None:
    """Write the names of orders above their rays in the waterfall, as many as have room."""
    last = -np.inf
    for f, top, name in sorted(ends):
        if f - last >= NAME_DISTANCE * right:
            last = f
            axes.annotate(name, (f, top), xytext=(0, 3), textcoords="offset points", rotation=60, ha="left",
                          rotation_mode="anchor", fontsize=style.SMALL, color=style.PALETTE[0])  # fmt: skip

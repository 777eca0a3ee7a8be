"""Plots of running machinery's response over speed, with orders, half ranges, waves, and all periodic motions."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby, pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.plot.drawing.labels import axis_label, axis_unit, speed_label
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.signals.orders.tracked_orders import TrackedOrders

if TYPE_CHECKING:
    from torsionnet.motion.periodic.periodic_result import FoundMotion, PeriodicResponse


# Plots of running machinery's response, with orders and half ranges over speed, and the wave at one speed.

MOST_LINES = 6
"""Largest number of orders drawn in a panel, those of largest amplitude; more could not be told apart by colour and
dashes."""
UNMET = "of no stable motion"
"""Label of the crosses on values of a motion that is not met."""
HALF_WIDTH_LABEL = 45
"""Number of letters of a label up to which two labels fit side by side in the legend."""


def order_response(
    response: OrderResponse,
    output: str | Sequence[str] | None = None,
    *,
    most: int = MOST_LINES,
    conventions: Conventions = SI,
    title: str | None = None,
    milli: bool = False,
    ax: GivenAxes = None,
) -> Figure:
    """Figure of amplitudes of the largest orders over speed, and half range of all in black, a panel for each output.

    Parameters
    ----------
    response : OrderResponse
    output : str or sequence of str, optional
        By default all, one below the other.
    most : int
        Orders drawn.
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the response.
    milli : bool
        Whether angles are in thousandths, as in mrad.
    ax : sequence of Axes, optional
        Axes to draw into, one for each output; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        No such output.
    """
    names = [output] if isinstance(output, str) else list(output or [channel.name for channel in response.outputs])
    sheet, panels = style.stacked_panels(0.8 + 2.6 * len(names), names, ax)
    total = response.half_range
    for panel, name in zip(panels, names, strict=True):
        place = response.output(name)
        scale, unit = axis_unit(response.outputs[place].unit, float(total[:, place].max()), conventions)
        scale, unit = (1e3 * scale, f"m{unit}") if milli and unit == "rad" else (scale, unit)
        sizes = response.sizes[:, :, place] * scale
        label = response.sum_label.replace(", worst", ",\nworst")
        panel.plot(response.rpm, total[:, place] * scale, color=style.INK, linewidth=2.0, label=label)
        _cross_out(panel, response, total[:, place] * scale, style.INK)
        for number, line in enumerate(np.argsort(-sizes.max(axis=0), kind="stable")[:most].tolist()):
            panel.plot(response.rpm, sizes[:, line], label=str(response.lines[line]), **style.line_style(number))
        panel.set_ylabel(axis_label(name, unit))
        panel.set_ylim(bottom=0)
        style.legend_beside(panel)
    panels[-1].set_xlabel(speed_label(response.reference))
    if len(response.rpm) > 1:
        panels[-1].set_xlim(response.rpm[0], response.rpm[-1])
    return sheet.titled(response.title if title is None else title)


def _cross_out(axes: Axes, response: OrderResponse, sizes: FloatArray, color: object) -> None:
    """Mark the speeds at which no motion was found that is stable."""
    if response.unmet.any():
        axes.plot(response.rpm[response.unmet], sizes[response.unmet], "x", color=color, label=UNMET)


def half_ranges(
    responses: Sequence[OrderResponse],
    output: str | None = None,
    *,
    labels: Sequence[str] | None = None,
    conventions: Conventions = SI,
    title: str | None = None,
    ax: Axes | None = None,
) -> Figure:
    """Figure of the half range of all orders of an output over speed, with a curve for each configuration.

    Parameters
    ----------
    responses : sequence of OrderResponse
    output : str, optional
        Needed where there are several.
    labels : sequence of str, optional
        By default the titles.
    conventions : Conventions, optional
        Unit of angles of the output.
    title : str, optional
        By default the output.
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.

    Raises
    ------
    UsageError
        No such output.
    """
    place = responses[0].output(output)
    channel = responses[0].outputs[place]
    sizes = [response.half_range[:, response.output(channel.name)] for response in responses]
    scale, unit = axis_unit(channel.unit, max(float(size.max()) for size in sizes), conventions)
    sheet, axes = style.one_panel(3.4, ax)
    for number, (response, size) in enumerate(zip(responses, sizes, strict=True)):
        label = labels[number] if labels else response.title
        (line,) = axes.plot(response.rpm, size * scale, label=label, **style.line_style(number))
        _cross_out(axes, response, size * scale, line.get_color())
    axes.set_xlabel(speed_label(responses[0].reference))
    axes.set_ylabel(axis_label(f"{channel.name}, half range", unit))
    axes.set_ylim(bottom=0)
    if len(responses[0].rpm) > 1:
        axes.set_xlim(responses[0].rpm[0], responses[0].rpm[-1])
    if len(responses) > 1 or labels:
        # Names of configurations are long: below, they leave the curves their width.
        columns = 1 if max(len(str(line.get_label())) for line in axes.lines) > HALF_WIDTH_LABEL else 2
        sheet.legend(columns)
    return sheet.titled(channel.name if title is None else title)


def waveform(
    response: OrderResponse,
    output: str | None = None,
    *,
    speed: float,
    conventions: Conventions = SI,
    title: str | None = None,
    ax: Axes | None = None,
) -> Figure:
    """Figure of an output over the reference shaft's angle at one speed, the sum of all orders with their phases.

    Parameters
    ----------
    response : OrderResponse
    output : str, optional
        Needed where there are several.
    speed : float
        rad/s; the calculated speed next to this one is drawn.
    conventions : Conventions, optional
        Unit of angles of the output.
    title : str, optional
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.

    Raises
    ------
    UsageError
        No such output, no common cycle, or a speed outside those calculated.
    """
    place = response.output(output)
    low, high = response.speeds.min(), response.speeds.max()
    if not low * (1 - 1e-9) <= speed <= high * (1 + 1e-9):
        calculated = f"{low * RPM:g} to {high * RPM:g} r/min"
        raise UsageError(f"{speed * RPM:g} r/min is outside the speeds calculated, {calculated}", kind="out-of-range")
    at = int(np.argmin(np.abs(response.speeds - speed)))
    angle, waves = response.waveform(response.outputs[place].name)
    channel = response.outputs[place]
    sheet, axes = style.one_panel(3.2, ax)
    scale, unit = axis_unit(channel.unit, float(np.abs(waves[at]).max()), conventions)
    axes.plot(np.degrees(angle), waves[at] * scale, color=style.INK, linewidth=1.4)
    axes.set_xlabel(f"angle of {response.reference} [deg]")
    axes.set_ylabel(axis_label(channel.name, unit))
    axes.xaxis.set_major_locator(MultipleLocator(90 if angle[-1] < 15 else 360))
    # The last sample stands one step before the end of the cycle.
    axes.set_xlim(0, np.degrees(angle[-1]) * len(angle) / (len(angle) - 1))
    return sheet.titled(f"{response.title}, {response.rpm[at]:.5g} r/min" if title is None else title)


# Waterfall plot of line spectra of an output at many speeds, one behind the other.

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
    ax: Axes | None = None,
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
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.

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
    sheet, axes = style.one_panel(4.6, ax)
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
    return sheet.titled(response.title if title is None else title)


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


# Plot of periodic motions over frequency or speed, unstable parts dashed, with the places where branches turn.

TURNS = {"fold": "o", "doubling": "D", "symmetry": "^", "second frequency": "s"}
"""Marker of matplotlib of each kind of place at which a branch turns."""


def periodic_response(
    response: PeriodicResponse, *, conventions: Conventions = SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of the peak to peak of every output over frequency or speed, branch by branch; what is unstable is dashed.

    Dotted parts are those whose stability is not determined. Circles are folds, diamonds doublings, triangles where
    lopsided motions begin, squares onsets of a second frequency.

    Parameters
    ----------
    response : PeriodicResponse
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the model.
    ax : sequence of Axes, optional
        Axes to draw into, one for each output; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    names = [channel.name for channel in response.outputs]
    sheet, panels = style.stacked_panels(1.2 + 2.6 * len(names), names, ax)
    for place, (panel, channel) in enumerate(zip(panels, response.outputs, strict=True)):
        sizes = [float(motion.highest[place] - motion.lowest[place]) for motion in response.motions]
        scale, unit = axis_unit(channel.unit, max(sizes, default=0.0), conventions)
        # Each branch in its colour: stable parts as lines, unstable ones dashed, undetermined ones dotted.
        for number, group in groupby(response.motions, key=lambda motion: motion.branch):
            _draw_branch(panel, response, list(group), number, (place, scale))
        panel.set_ylabel(axis_label(f"{channel.name}, peak to peak", unit, 40))
        panel.set_ylim(bottom=0)
    panels[-1].set_xlabel("speed [rpm]" if response.over == "speed" else "frequency [Hz]")
    if len(response.ways) > 1:
        sheet.legend(min(len(response.ways), 3))
    return sheet.titled(f"{response.title}: periodic motions" if title is None else title)


def _draw_branch(
    panel: Axes, response: PeriodicResponse, motions: list[FoundMotion], number: int, shown: tuple[int, float]
) -> None:
    place, scale = shown
    color = style.PALETTE[number % len(style.PALETTE)]
    line = _with_ends(response, motions)
    at = np.array([response.shown(motion.at) for motion in line])
    sizes = np.array([scale * float(motion.highest[place] - motion.lowest[place]) for motion in line])
    label: str | None = f"branch {number + 1}: {response.ways[number]}"
    if len(line) == 1:
        panel.plot(at, sizes, ".", color=color, label=label)
    first = 0
    # One line for all steps of a style: in lines shorter than a dash, dashes would not show.
    for dashes, steps in groupby(_dashes(motion, other) for motion, other in pairwise(line)):
        last = first + len(list(steps))
        panel.plot(
            at[first : last + 1], sizes[first : last + 1], color=color, linewidth=1.6, linestyle=dashes, label=label
        )
        first, label = last, None
    for kind, marker in TURNS.items():
        turns = [i for i, motion in enumerate(line) if motion.turn == kind and motion.branch == number]
        panel.plot(at[turns], sizes[turns], marker, color=color, markersize=5, fillstyle="none")


def _with_ends(response: PeriodicResponse, motions: list[FoundMotion]) -> list[FoundMotion]:
    """Motions of a branch with the doublings at which it begins and ends; the same of branches that double nothing.

    It ends at one where no other branch begins, if no place asked for lies between.
    """
    first, last = motions[0], motions[-1]
    doublings = [doubling for doubling in response.turns("doubling") if 2 * doubling.periods == first.periods]
    begins = {doubling: _begun(response, doubling) for doubling in doublings}
    own = [doubling for doubling in doublings if begins[doubling] == first.branch]
    places = {motion.at for motion in response.motions if not motion.turn}
    ends = [
        doubling
        for doubling in doublings
        if begins[doubling] is None and not any(min(at := doubling.at, last.at) < p < max(at, last.at) for p in places)
    ]
    return [*own, *motions, *sorted(ends, key=lambda doubling: abs(doubling.at - last.at))[:1]]


def _begun(response: PeriodicResponse, doubling: FoundMotion) -> int | None:
    """Number of the branch that begins at a doubling; None of one where none begins."""
    way = f"doubled at {response.shown(doubling.at):.8g} {response.unit}"
    return response.ways.index(way) if way in response.ways else None


def _dashes(motion: FoundMotion, other: FoundMotion) -> str:
    """Line style between two motions: where one lies on the edge of stability the other decides."""
    states = [each.is_stable for each in (motion, other) if not each.on_edge]
    if any(state is False for state in states):
        return "--"
    return ":" if not states or None in states else "-"

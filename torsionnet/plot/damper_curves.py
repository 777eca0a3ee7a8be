"""Plot of a damper design, the vibration level over frequency or speed, and its maximum over each damper value."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.number_text import typeset_unit
from torsionnet.machinery.design.damper_optimum import DamperOptimum
from torsionnet.plot.drawing.labels import axis_unit

TOP_FACTOR, BOTTOM_FACTOR = 3.0, 300.0
"""Ratio of the top of the level axis to the largest vibration level, and largest ratio of that level to the bottom."""
WIDE_RANGE = 3.0
"""Ratio of the largest to the smallest value on an axis of a damper plot above which the axis is logarithmic."""


MARK: dict[str, Any] = {"markersize": 6, "zorder": 5, "clip_on": False}


def damper_design(result: DamperOptimum, *, conventions: Conventions = SI, title: str | None = None) -> Figure:
    """Figure of vibration levels over frequency or speed with the damper as given, optimal, undamped and locked.

    Below, the largest level over each value.

    Parameters
    ----------
    result : DamperOptimum
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the result.

    Returns
    -------
    matplotlib.figure.Figure
    """
    largest = max(result.before.level, result.after.level)
    scale, unit = axis_unit(result.channel.unit, largest, conventions)
    count = len(result.parameters)
    figure = style.new_figure(style.WIDTH, 6.4)
    grid = figure.add_gridspec(2, count, height_ratios=(1.5, 1))
    _draw_levels(figure.add_subplot(grid[0, :]), result, scale, unit)
    first = None
    for number in range(count):
        first = _draw_effect(figure.add_subplot(grid[1, number], sharey=first), result, number, scale)
    figure.axes[1].set_ylabel(f"its maximum [{unit}]")
    style.set_title(figure, result.title if title is None else title)
    return figure


def _draw_levels(axes: Axes, result: DamperOptimum, scale: float, unit: str) -> None:
    style.style_axes(axes)
    for number, curve in enumerate(result.curves):
        axes.plot(curve.points, curve.levels * scale, label=curve.label, **style.line_style(number))
    for label, mark, points in (("maximum", "o", result.peaks), ("all films meet", "x", result.fixed_points)):
        if points:
            sizes = [one.level * scale for one in points]
            axes.plot([one.point for one in points], sizes, mark, color=style.INK, label=label, **MARK)
    top = max(result.before.level, result.after.level) * scale
    lowest = min(curve.levels.min() for curve in result.curves[:2]) * scale
    low, high = max(0.8 * lowest, top / BOTTOM_FACTOR), TOP_FACTOR * top
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    style.log_ticks(axes.yaxis, low, high)
    along = result.curves[0].points
    if along[-1] > 10 * along[0]:
        axes.set_xscale("log")
        style.log_ticks(axes.xaxis, along[0], along[-1])
    if len(along) > 1:
        axes.set_xlim(along[0], along[-1])
    axes.set_xlabel(f"{result.of[0]} [{result.of[1]}]")
    axes.set_ylabel(f"{result.channel.name} [{unit}]")
    style.legend_beside(axes)


def _draw_effect(axes: Axes, result: DamperOptimum, number: int, scale: float) -> Axes:
    """Draw the largest vibration level over one damper value, with a line at the value given, and return the axes."""
    style.style_axes(axes)
    one = result.parameters[number]
    axes.plot(one.values, one.largest * scale, color=style.INK, linewidth=1.6)
    axes.plot([one.value], [result.after.level * scale], "o", color=style.INK, **MARK)
    if one.lower <= one.start <= one.upper:
        axes.axvline(one.start, label="as given", **style.line_style(0))
    if one.lower > 0 and one.upper > WIDE_RANGE * one.lower:
        axes.set_xscale("log")
        style.log_ticks(axes.xaxis, one.lower, one.upper)
    every = np.concatenate([each.largest for each in result.parameters]) * scale
    lowest, highest = every.min(), every.max()
    if highest > WIDE_RANGE * lowest:
        axes.set_yscale("log")
        style.log_ticks(axes.yaxis, lowest, highest)
    axes.set_xlim(one.lower, one.upper)
    axes.set_xlabel(f"{one.name} [{typeset_unit(one.unit or '1')}]")
    return axes

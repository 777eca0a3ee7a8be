"""A damper: the level over frequency or speed with and without it, and the largest level over each value."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

import torsionnet.plot.style as style
from torsionnet.core.number_text import typeset_unit
from torsionnet.response import Conventions
from torsionnet.response.conventions import SI
from torsionnet.response.damper_optimum import DamperOptimum

HIGHEST, LOWEST = 3.0, 300.0
"""Of the largest level as given or best: curves leave the panel above and below."""
WIDE = 3.0


def damper_design(found: DamperOptimum, *, conventions: Conventions = SI, title: str | None = None) -> Figure:
    """The level for the values as given, the best ones, without damping and locked; below, what each value does.

    Parameters
    ----------
    found : DamperOptimum
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the result.

    Returns
    -------
    matplotlib.figure.Figure
    """
    scale, unit = conventions.scale(found.channel.unit), typeset_unit(conventions.unit(found.channel.unit))
    count = len(found.parameters)
    figure = style.new_figure(style.WIDTH, 6.4)
    grid = figure.add_gridspec(2, count, height_ratios=(1.5, 1))
    above = figure.add_subplot(grid[0, :])
    style.dress(above)
    for number, curve in enumerate(found.curves):
        above.plot(curve.points, curve.levels * scale, label=curve.label, **style.line_style(number))
    at, levels = [one.point for one in found.peaks], [one.level * scale for one in found.peaks]
    above.plot(at, levels, "o", color=style.INK, markersize=5, label="maximum of the optimum", zorder=5)
    if found.fixed_points:
        at, levels = [one.point for one in found.fixed_points], [one.level * scale for one in found.fixed_points]
        above.plot(at, levels, "x", color=style.INK, markersize=7, label="all films meet", zorder=6)
    top = max(found.before.level, found.after.level) * scale
    shown = np.concatenate([curve.levels for curve in found.curves[:2]]) * scale
    above.set_yscale("log")
    above.set_ylim(max(0.8 * shown.min(), top / LOWEST), HIGHEST * top)
    points = found.curves[0].points
    if points[-1] > 10 * points[0]:
        above.set_xscale("log")
    if len(points) > 1:
        above.set_xlim(points[0], points[-1])
    above.set_xlabel(f"{found.of[0]} [{found.of[1]}]")
    above.set_ylabel(f"{found.channel.name} [{unit}]")
    above.legend(fontsize=style.SMALL, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    for number, one in enumerate(found.parameters):
        axes = figure.add_subplot(grid[1, number])
        style.dress(axes)
        values, sizes = found.effects[one.name].T
        axes.plot(values, sizes * scale, color=style.INK, linewidth=1.6)
        axes.plot([one.value], [found.after.level * scale], "o", color=style.INK, markersize=5)
        axes.axvline(one.start, color=style.INK, linewidth=0.8, linestyle=":")
        if one.lower > 0 and one.upper > WIDE * one.lower:
            axes.set_xscale("log")
            axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xlim(one.lower, one.upper)
        axes.set_xlabel(f"{one.name} [{typeset_unit(one.unit or '1')}]")
        if not number:
            axes.set_ylabel(f"largest level [{unit}]")
    style.heading(figure, found.title if title is None else title)
    return figure

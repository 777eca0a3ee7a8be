"""Plot of percentiles of the variants' curves over frequency or speed, as bands within each other."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.units import RPM
from torsionnet.plot.study.study_axes import (
    axis_label,
    finite_values,
    is_wide,
    legend_below,
    log_axis,
    panel_title,
    write_in_empty_panel,
)
from torsionnet.study.shown_units import IN_SI, ShownUnits

if TYPE_CHECKING:
    from torsionnet.linear.frequency_response import FloatArray
    from torsionnet.study.answers.percentile_bands_answer import PercentileBandsResult

MOST_COLUMNS = 3
"""Largest number of panels of percentile bands side by side; narrower ones have no room for numbers along the axis."""
PANEL_HEIGHT = 2.3
"""Height in inches of a panel with the bands of percentiles of one configuration."""


def percentile_bands(result: PercentileBandsResult, *, units: ShownUnits = IN_SI, title: str | None = None) -> Figure:
    """Figure of percentiles of curves over frequency or speed as bands within each other, the middle one as a line.

    A panel for each configuration.

    Parameters
    ----------
    result : PercentileBandsResult
        Result of the answer ``percentile_bands`` of a study.
    units : ShownUnits, optional
        By default SI.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    count, quantity = len(result.lines), (result.quantity, result.measure.unit)
    columns = style.panel_columns(count, MOST_COLUMNS)
    rows = math.ceil(count / columns)
    figure = style.new_figure(style.WIDTH, 1.1 + PANEL_HEIGHT * rows)
    grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    panels = grid.ravel()[:count].tolist()
    over_speed = result.measure.over == "speed"
    points = result.measure.points * RPM if over_speed else result.measure.points
    scale = units.scale(*quantity)
    for axes, (case, lines) in zip(panels, result.lines.items(), strict=True):
        _bands(axes, points, lines * scale, result.percentiles)
        if count > 1:
            panel_title(axes, case, style.WIDTH / columns - 0.5)
    for axes in grid.ravel()[count:]:
        axes.remove()
    for axes in grid[:, 0]:
        axes.set_ylabel(axis_label(quantity[0], units.unit(*quantity), PANEL_HEIGHT))
    every = finite_values(result.lines.values()) * scale
    if is_wide(every):
        log_axis(panels[0], "y", every.min(), every.max())
    if points[0] > 0 and is_wide(points):
        log_axis(panels[0], "x", points[0], points[-1])
    panels[0].set_xlim(points[0], points[-1])
    for axes in panels[-columns:]:
        axes.set_xlabel("speed [r/min]" if over_speed else "frequency [Hz]")
        axes.tick_params(labelbottom=True)
    handles, labels = panels[0].get_legend_handles_labels()
    legend_below(figure, handles, labels)
    style.set_title(figure, result.title if title is None else title)
    return figure


def _bands(axes: Axes, points: FloatArray, lines: FloatArray, shares: tuple[float, ...]) -> None:
    pairs = len(shares) // 2
    for pair in range(pairs):
        label = f"{shares[pair]:g} to {shares[-1 - pair]:g} % of the variants"
        alpha = 0.18 + 0.3 * pair / max(pairs - 1, 1)
        axes.fill_between(
            points, lines[pair], lines[-1 - pair], color=style.PALETTE[0], alpha=alpha, linewidth=0, label=label
        )
    if len(shares) % 2:
        axes.plot(points, lines[pairs], color=style.PALETTE[0], linewidth=1.6, label=f"{shares[pairs]:g} % are below")
    if not len(finite_values([lines])):
        write_in_empty_panel(axes, "no variant has a value")
    style.style_axes(axes)

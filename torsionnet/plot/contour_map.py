"""A quantity over two parameters as contours."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

import torsionnet.plot.style as style
from torsionnet.core.errors import UsageError
from torsionnet.plot.study_axes import BEYOND, axis_label, titled

if TYPE_CHECKING:
    from torsionnet.study.answers.map_of_study import MapFound
    from torsionnet.study.answers.parameter_map import ParameterMap

LINES = 9
COLUMNS = 2


def contour_map(found: MapFound, *, title: str | None = None) -> Figure:
    """Contours of equal values with the same colours in all configurations; a limit of the quantity in red.

    Parameters
    ----------
    found : MapFound
        What the answer ``map`` of a study found.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        No point has a value.
    """
    every = np.concatenate([one.values.ravel() for one in found.maps.values()])
    if not np.isfinite(every).any():
        raise UsageError(f"{found.quantity[0]} has no value anywhere on the map")
    low, high = float(np.nanmin(every)), float(np.nanmax(every))
    levels = np.linspace(low, high if high > low else low + (abs(low) or 1.0) * 1e-9, 65)
    columns = min(COLUMNS, len(found.maps))
    rows = math.ceil(len(found.maps) / columns)
    figure = style.new_figure(style.WIDTH, 0.8 + rows * (3.6 if columns == 1 else 2.9))
    panels = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    for axes, (case, one) in zip(panels.ravel(), found.maps.items(), strict=False):
        filled = axes.contourf(one.x, one.y, one.values.T, levels=levels, cmap="viridis")
        filled.set_edgecolor("face")
        _lines(axes, one)
        _limits(axes, found, one)
        style.dress(axes)
        axes.grid(visible=False)
        if len(found.maps) > 1:
            titled(axes, case)
    for axes in panels.ravel()[len(found.maps) :]:
        axes.remove()
    for axes in panels[:, 0]:
        axes.set_ylabel(axis_label(*found.y))
    for axes in panels.ravel()[: len(found.maps)][-columns:]:
        axes.set_xlabel(axis_label(*found.x))
        axes.tick_params(labelbottom=True)
    bar = figure.colorbar(
        panels[0, 0].collections[0], ax=panels.ravel()[: len(found.maps)].tolist(), shrink=0.9, ticks=MaxNLocator(7)
    )
    which = "" if found.others == "fixed" else f", {found.others} over the others"
    bar.set_label(axis_label(found.quantity[0], found.quantity[1]) + which, fontsize=style.FONT)
    bar.ax.tick_params(labelsize=style.SMALL)
    style.heading(figure, found.title if title is None else title)
    return figure


def _lines(axes: Axes, one: ParameterMap) -> None:
    if np.nanmax(one.values) > np.nanmin(one.values):
        lines = axes.contour(one.x, one.y, one.values.T, levels=LINES, colors=style.PAPER, linewidths=0.8)
        axes.clabel(lines, fontsize=style.SMALL, fmt=style.plain)


def _limits(axes: Axes, found: MapFound, one: ParameterMap) -> None:
    if found.limit is None:
        return
    for side in (found.limit.below, found.limit.above):
        if side is not None and np.nanmin(one.values) < side < np.nanmax(one.values):
            axes.contour(one.x, one.y, one.values.T, levels=[side], colors=BEYOND, linewidths=2.2)

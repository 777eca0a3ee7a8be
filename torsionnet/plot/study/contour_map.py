"""Contour plot of a quantity of a study over two parameters, a panel with colours for each configuration."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

import torsionnet.plot.drawing.style as style
from torsionnet.base.number_text import screen_text, typeset_unit
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.plot.study.study_axes import (
    BEYOND_COLOR,
    EQUAL_VALUES,
    axis_ends,
    axis_label,
    break_text,
    finite_values,
    has_equal_factors,
    is_wide,
    label_with_remark,
    line_count,
    log_axis,
    panel_title,
    write_in_empty_panel,
)
from torsionnet.study.shown_units import IN_SI, ShownUnits

if TYPE_CHECKING:
    from torsionnet.study.answers.map_answer import MapResult, ParameterMap

MOST_CONTOUR_LINES = 9
"""Largest number of contour lines in a panel of a contour map; more would hide the colours."""
COLOURS = 64
"""Number of steps of colour in a contour map, fine enough to appear continuous."""
WIDE_RANGE = 100.0
"""Ratio of the largest to the smallest value from which steps of colours and of contour lines are equal factors."""
HEIGHTS = {1: 2.9, 2: 2.1, 3: 1.6, 4: 1.25}
"""Height in inches of a panel of a contour map without its labels, by the number of panels in a row."""
HEADING, TICKS, BAR, GAP = 0.5, 0.35, 0.75, 0.15
"""Sizes in inches of a contour map's title, numbers along an axis, bar of colours with numbers, and gap of panels."""
LABEL_LINE = 0.155
"""Height in inches of a line of a label of a contour map."""


def contour_map(
    result: MapResult, *, units: ShownUnits = IN_SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of contours of a quantity over two parameters, its value in colours, a panel for each configuration.

    A limit of the quantity in red.

    Colours are the same in all configurations. An axis is logarithmic if the values of its parameter have equal
    factors, the colours are if the values span decades.

    Parameters
    ----------
    result : MapResult
        Result of the answer ``map`` of a study.
    units : ShownUnits, optional
        By default SI.
    title : str, optional
    ax : sequence of Axes, optional
        Axes to draw into, one for each configuration; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    scale = units.scale(*result.quantity)
    every = scale * finite_values(chart.values for chart in result.maps.values())
    levels, norm = _levels(every)
    columns = style.panel_columns(len(result.maps))
    rows = math.ceil(len(result.maps) / columns)
    share_x, share_y = (_alike(getattr(chart, side) for chart in result.maps.values()) for side in "xy")
    labels = _Labels.within(result, units, columns, rows, apart=0.0 if share_y else TICKS)
    sheet, grid = style.grid_panels(
        style.WIDTH, labels.height, list(result.maps), ax, columns=columns, sharex=share_x, sharey=share_y
    )
    panels = sheet.panels
    for axes, (case, chart) in zip(panels, result.maps.items(), strict=True):
        _panel(axes, _axes_of(result, chart, units), scale * chart.values.T, levels, norm, labels.width)
        _limits(axes, result, _axes_of(result, chart, units), scale * chart.values.T, scale)
        if len(panels) > 1:
            panel_title(axes, case, labels.width)
    for axes in grid[:, 0]:
        axes.set_ylabel(labels.y)
    for axes in panels[-columns:]:
        axes.set_xlabel(labels.x)
        axes.tick_params(labelbottom=True)
    if len(every):
        _bar(sheet.figure, result, panels, ScalarMappable(norm, "viridis"), units, labels.bar)
    return sheet.titled(result.title if title is None else title)


@dataclass(frozen=True)
class _Labels:
    """Texts of the labels of a contour map's axes and bar of colours, with the sizes of panel and figure in inches.

    The labels are broken into lines that fit.
    """

    x: str
    y: str
    bar: str
    width: float
    height: float

    @classmethod
    def within(cls, result: MapResult, units: ShownUnits, columns: int, rows: int, *, apart: float) -> _Labels:
        """Labels and sizes in inches of a contour map whose panels stand in ``columns`` columns and ``rows`` rows.

        ``apart`` inches are kept for numbers along y between panels.
        """
        high = HEIGHTS[columns]
        y = axis_label(result.y[0], units.unit(*result.y), high)
        bar = label_with_remark(result.quantity[0], units.unit(*result.quantity), _besides(result), 0.8 * rows * high)
        sides = TICKS + LABEL_LINE * line_count([y]) + BAR + LABEL_LINE * line_count([bar])
        width = (style.WIDTH - sides) / columns - GAP - apart
        x = axis_label(result.x[0], units.unit(*result.x), width)
        titles = line_count(break_text(case, width) for case in result.maps) if len(result.maps) > 1 else 0
        below = LABEL_LINE * line_count([x]) * (2 if len(result.maps) % columns else 1)
        height = HEADING + rows * (high + TICKS + LABEL_LINE * titles) + below
        return cls(x, y, bar, width, height)


def _besides(result: MapResult) -> str:
    """Text of the remark beside the bar of colours of a contour map, or an empty text.

    The choice of the other parameters, and the meaning of blank fields.
    """
    over = "" if result.others == "fixed" else f"{result.others} over the others"
    blank = (
        "" if all(np.isfinite(chart.values).all() for chart in result.maps.values()) else "blank where there is none"
    )
    return ", ".join(filter(None, (over, blank)))


def _alike(points: Iterable[FloatArray]) -> bool:
    """Whether the parameter values on an axis of a contour map are the same in all configurations."""
    first, *others = points
    return all(np.array_equal(first, other) for other in others)


def _levels(every: FloatArray) -> tuple[FloatArray, Normalize]:
    low, high = axis_ends(every)
    if is_wide(every, WIDE_RANGE):
        return np.geomspace(low, high, COLOURS + 1), LogNorm(low, high)
    return np.linspace(low, high, COLOURS + 1), Normalize(low, high)


def _axes_of(result: MapResult, chart: ParameterMap, units: ShownUnits) -> tuple[FloatArray, FloatArray]:
    return chart.x * units.scale(*result.x), chart.y * units.scale(*result.y)


def _panel(
    axes: Axes,
    at: tuple[FloatArray, FloatArray],
    values: FloatArray,
    levels: FloatArray,
    norm: Normalize,
    width: float,
) -> None:
    for side, points in zip("xy", at, strict=True):
        if has_equal_factors(points):
            log_axis(axes, side, points[0], points[-1], width)
        else:
            (axes.xaxis if side == "x" else axes.yaxis).set_major_formatter(
                FuncFormatter(lambda at, _: style.tick_text(at))
            )
    # Rounding of the levels must not leave out the ends.
    filled = axes.contourf(*at, np.clip(values, levels[0], levels[-1]), levels=levels, norm=norm, cmap="viridis")
    filled.set_edgecolor("face")
    here = values[np.isfinite(values)]
    if not len(here):
        write_in_empty_panel(axes, "no point has a value")
    elif np.ptp(here) > EQUAL_VALUES * np.abs(here).max():
        lines = axes.contour(*at, values, levels=_contour_values(here), colors=style.PAPER, linewidths=0.8)
        axes.clabel(lines, fontsize=style.SMALL, fmt=style.tick_text)
    axes.set(xlim=(at[0][0], at[0][-1]), ylim=(at[1][0], at[1][-1]))
    style.style_axes(axes)
    axes.grid(visible=False)


def _contour_values(here: FloatArray) -> Any:
    """Values of the quantity, as an array in the unit of the values given, at which contour lines run.

    Round numbers, or powers of ten.
    """
    if not is_wide(here, WIDE_RANGE):
        return MaxNLocator(MOST_CONTOUR_LINES).tick_values(float(here.min()), float(here.max()))
    first, last = math.floor(math.log10(here.min())), math.ceil(math.log10(here.max()))
    return 10.0 ** np.arange(first, last + 1, max(1, (last - first) // MOST_CONTOUR_LINES))


def _limits(axes: Axes, result: MapResult, at: tuple[FloatArray, FloatArray], values: FloatArray, scale: float) -> None:
    here = values[np.isfinite(values)]
    if result.limit is None or not len(here):
        return
    for side in (result.limit.below, result.limit.above):
        if side is not None and here.min() < scale * side < here.max():
            axes.contour(*at, values, levels=[scale * side], colors=BEYOND_COLOR, linewidths=2.2)


def _bar(
    figure: Figure, result: MapResult, panels: list[Axes], colours: ScalarMappable, units: ShownUnits, label: str
) -> None:
    unit, scale = units.unit(*result.quantity), units.scale(*result.quantity)
    bar: Colorbar = figure.colorbar(colours, ax=panels, shrink=0.9)
    low, high = bar.ax.get_ylim()
    if bar.ax.get_yscale() == "log":
        style.log_ticks(bar.ax.yaxis, low, high)
        bar.ax.minorticks_off()
    else:
        bar.ax.yaxis.set_major_locator(MaxNLocator(7))
    bar.set_label(label, fontsize=style.FONT)
    bar.ax.tick_params(labelsize=style.SMALL)
    sides = [] if result.limit is None else [result.limit.below, result.limit.above]
    for side in sides:
        if side is None:
            continue
        # A limit beyond an end of the bar is named there.
        if low < side * scale < high:
            bar.ax.axhline(side * scale, color=BEYOND_COLOR, linewidth=2.2)
        else:
            text = f"limit {screen_text(side * scale, 4)}\n{typeset_unit(unit)}".rstrip()
            place, ends = (1.02, "bottom") if side * scale >= high else (-0.02, "top")
            bar.ax.text(
                0.0,
                place,
                text,
                transform=bar.ax.transAxes,
                ha="left",
                va=ends,
                fontsize=style.SMALL,
                color=BEYOND_COLOR,
            )

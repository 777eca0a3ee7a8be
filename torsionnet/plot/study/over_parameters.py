"""Plots of the quantities of a study over its parameters: contours over two of them, and scatter plots."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colorbar import Colorbar
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, MaxNLocator

import torsionnet.plot.drawing.style as style
from torsionnet.base.errors import UsageError
from torsionnet.base.number_text import screen_text, typeset_unit
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.plot.study.study_axes import (
    BEYOND_COLOR,
    EQUAL_VALUES,
    WITHIN_COLOR,
    axis_ends,
    axis_label,
    break_text,
    finite_values,
    has_equal_factors,
    is_wide,
    label_with_remark,
    legend_below,
    line_count,
    log_axis,
    panel_title,
    write_in_empty_panel,
)
from torsionnet.study.study import IN_SI, ShownUnits

if TYPE_CHECKING:
    from torsionnet.study.answers.map_and_scatter import (
        MapResult,
        ParallelCoordinatesResult,
        ParameterMap,
        ScatterResult,
    )


# Contour plot of a quantity of a study over two parameters, a panel with colours for each configuration.

MOST_CONTOUR_LINES = 9
"""Largest number of contour lines in a panel of a contour map; more would hide the colours."""
COLOURS = 64
"""Number of steps of colour in a contour map, fine enough to appear continuous."""
WIDE_CONTOURS = 100.0
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
    if is_wide(every, WIDE_CONTOURS):
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
    if not is_wide(here, WIDE_CONTOURS):
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


# Scatter plots of quantities over parameters, or densities if there are many points.

MANY_POINTS = 3000
"""Number of points from which on their density is drawn, as single points would cover each other."""
DENSITY_CELLS = 40
"""Number of cells of a density plot along each axis; more are finer and noisier."""
MOST_PARAMETERS = 8
"""Largest number of parameters drawn, those with the largest rank correlations; more panels would be too small."""
PANEL_WIDTH, PANEL_HEIGHT = 1.4, 1.6
"""Width and height in inches of a panel of the scatter plots."""
WIDE_RANGE = 30.0
"""Ratio of the largest to the smallest value from which an axis is logarithmic."""


def scatter_matrix(
    result: ScatterResult,
    configuration: str | None = None,
    *,
    units: ShownUnits = IN_SI,
    title: str | None = None,
    ax: GivenAxes = None,
) -> Figure:
    """Figure of scatter plots of every quantity (rows) over every parameter (columns), with rank correlations inside.

    Parameters
    ----------
    result : ScatterResult
        Result of the answer ``scatter`` of a study.
    configuration : str, optional
        By default all, distinguished by colours; densities are drawn of all together.
    units : ShownUnits, optional
        By default SI.
    title : str, optional
    ax : sequence of Axes, optional
        Axes to draw into, one for each quantity and parameter, row by row; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        No such configuration.
    """
    cases = list(result.points) if configuration is None else [configuration]
    if not set(cases) <= set(result.points):
        raise UsageError(
            f'there is no configuration "{configuration}"; there are {", ".join(result.points)}',
            kind="unknown-configuration",
        )
    shown = _strongest(result, cases)
    si = {**result.parameter_units, **result.units}
    scales = {name: units.scale(name, si[name]) for name in (*shown, *result.units)}
    columns = {name: {case: scale * result.points[case][name] for case in cases} for name, scale in scales.items()}
    width = max(style.WIDTH, PANEL_WIDTH * len(shown))
    shows = [f"{quantity} over {parameter}" for quantity in result.units for parameter in shown]
    height = 0.9 + PANEL_HEIGHT * len(result.units)
    sheet, panels = style.grid_panels(width, height, shows, ax, columns=len(shown), sharex="col", sharey="row")
    for row, quantity in zip(panels, result.units, strict=True):
        for axes, parameter in zip(row, shown, strict=True):
            _points(axes, columns[parameter], columns[quantity])
            _coefficient(axes, result, cases, parameter, quantity)
            style.style_axes(axes)
        _scale_axis(row[0], "y", columns[quantity])
        row[0].set_ylabel(axis_label(quantity, units.unit(quantity, si[quantity]), PANEL_HEIGHT))
    for axes, parameter in zip(panels[-1], shown, strict=True):
        _scale_axis(axes, "x", columns[parameter])
        axes.set_xlabel(axis_label(parameter, units.unit(parameter, si[parameter]), width / len(shown) - 0.2))
    handles, labels = panels[0][0].get_legend_handles_labels()
    if len(labels) > 1:
        legend_below(sheet, handles, labels, larger=3)
    return sheet.titled(result.title if title is None else title)


def _strongest(result: ScatterResult, cases: list[str]) -> list[str]:
    sizes = np.nan_to_num(
        np.max([np.abs(row.coefficients) for (case, _), row in result.correlations.items() if case in cases], axis=0)
    )
    kept = sorted(np.argsort(-sizes, kind="stable")[:MOST_PARAMETERS].tolist())
    return [list(result.parameter_units)[place] for place in kept]


def _points(axes: Axes, x: dict[str, FloatArray], y: dict[str, FloatArray]) -> None:
    across, up = (np.concatenate(list(by_case.values())) for by_case in (x, y))
    there = np.isfinite(across) & np.isfinite(up)
    if not there.any():
        write_in_empty_panel(axes, "no values")
    elif len(across) >= MANY_POINTS:
        bins = [_bins(samples[there]) for samples in (across, up)]
        axes.hist2d(across[there], up[there], bins=bins, cmap="Blues", cmin=1, rasterized=True)
    else:
        for number, case in enumerate(x):
            color = style.PALETTE[number % len(style.PALETTE)]
            axes.plot(
                x[case], y[case], _MARKS[number // len(style.PALETTE) % len(_MARKS)], markersize=2.5, alpha=0.6,
                color=color, label=case, markeredgewidth=0, rasterized=True,
            )  # fmt: skip


_MARKS = "o^s"
"""Marker letters of matplotlib by which configurations are told apart; the next one is used when all colours are."""


def _bins(values: FloatArray) -> FloatArray:
    low, high = axis_ends(values)
    return (np.geomspace if is_wide(values, WIDE_RANGE) else np.linspace)(low, high, DENSITY_CELLS + 1)


def _scale_axis(axes: Axes, side: str, columns: dict[str, FloatArray]) -> None:
    """Make an axis logarithmic if its values span decades, and give it room around values that are all the same."""
    values = finite_values(columns.values())
    ends = axis_ends(values)
    if is_wide(values, WIDE_RANGE):
        log_axis(axes, side, *ends)
    else:
        (axes.xaxis if side == "x" else axes.yaxis).set_major_locator(MaxNLocator(3))
    if len(values) and ends[0] < values.min():
        (axes.set_xlim if side == "x" else axes.set_ylim)(*ends)


def _coefficient(axes: Axes, result: ScatterResult, cases: list[str], parameter: str, quantity: str) -> None:
    place = list(result.parameter_units).index(parameter)
    values = np.array([result.correlations[case, quantity].coefficients[place] for case in cases])
    if np.isnan(values).all():
        return
    low, high = (round(float(value), 2) + 0.0 for value in (np.nanmin(values), np.nanmax(values)))
    text = f"{low:.2f}" if high - low < 0.01 else f"{low:.2f} to {high:.2f}"
    axes.text(
        0.97, 0.97, text, transform=axes.transAxes, ha="right", va="top", fontsize=style.SMALL,
        bbox={"facecolor": style.PAPER, "alpha": 0.75, "edgecolor": "none", "pad": 1.0},
    )  # fmt: skip


# Plot of variants in parallel coordinates, as lines across an axis for each parameter and quantity.

WIDE_AXIS = 100.0
"""Ratio of the largest to the smallest value from which an axis is logarithmic."""
TITLE_PAD = 15.0
"""Distance in points between the axes and a title, room for the values at the upper ends of the axes."""
AXIS_DISTANCE, TALL_PANEL, LOW_PANEL, MOST_TALL = 0.95, 2.6, 1.5, 4
"""Distance of axes, height of a tall and of a low panel, in inches, and largest number of configurations with tall
ones."""


def parallel_coordinates(
    result: ParallelCoordinatesResult,
    *,
    units: ShownUnits = IN_SI,
    title: str | None = None,
    ax: GivenAxes = None,
) -> Figure:
    """Figure of variants as lines across parallel axes of parameters and quantities, those beyond a limit in red.

    Each configuration has a panel; the ends of an axis are the extreme values in all configurations.

    Parameters
    ----------
    result : ParallelCoordinatesResult
        Result of the answer ``parallel_coordinates`` of a study.
    units : ShownUnits, optional
        By default SI.
    title : str, optional
    ax : sequence of Axes, optional
        Axes to draw into, one for each configuration; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    names = list(result.units)
    scales = {name: units.scale(name, si) for name, si in result.units.items()}
    every = {
        name: scales[name] * finite_values(variants[name] for variants in result.variants.values()) for name in names
    }
    width = max(style.WIDTH, AXIS_DISTANCE * len(names))
    height = TALL_PANEL if len(result.variants) <= MOST_TALL else LOW_PANEL
    sheet, _ = style.grid_panels(width, 1.2 + height * len(result.variants), list(result.variants), ax)
    panels = sheet.panels
    for axes, (case, columns) in zip(panels, result.variants.items(), strict=True):
        shares = np.column_stack([_heights(columns[name] * scales[name], every[name]) for name in names])
        _lines(axes, shares, result.beyond[case])
        _scales(axes, [axis_ends(every[name]) if len(every[name]) else None for name in names])
        if not np.isfinite(shares).any():
            write_in_empty_panel(axes, "no variant has a value")
        labels = [axis_label(name, units.unit(name, result.units[name]), width / len(names) - 0.1) for name in names]
        axes.set_xticks(range(len(names)), labels if axes is panels[-1] else [""] * len(names))
        axes.tick_params(axis="x", labelsize=style.SMALL, length=0, pad=14)
        if len(result.variants) > 1:
            panel_title(axes, case, width, pad=TITLE_PAD)
    if any(outside.any() for outside in result.beyond.values()):
        handles = [Line2D([], [], color=color) for color in (WITHIN_COLOR, BEYOND_COLOR)]
        legend_below(sheet, handles, ["within limits", "beyond a limit"])
    return sheet.titled(result.title if title is None else title)


def _heights(values: FloatArray, every: FloatArray) -> FloatArray:
    """Heights of values on one of the parallel axes, from 0 at its lower to 1 at its upper end, in the values' shape.

    Logarithmic if values are decades apart.
    """
    low, high = axis_ends(every)
    if is_wide(every, WIDE_AXIS):
        return np.asarray(np.log(values / low) / np.log(high / low))
    return (values - low) / (high - low)


def _lines(axes: Axes, shares: FloatArray, beyond: np.ndarray) -> None:
    places = np.arange(shares.shape[1])
    for which, color in ((~beyond, WITHIN_COLOR), (beyond, BEYOND_COLOR)):
        segments = [np.column_stack([places, row]) for row in shares[which]]
        alpha = min(0.7, 0.1 + 20 / max(len(segments), 1))
        axes.add_collection(LineCollection(segments, colors=color, alpha=alpha, linewidths=0.7, rasterized=True))
    axes.set_xlim(-0.3, len(places) - 0.7)
    axes.set_ylim(0, 1)


def _scales(axes: Axes, ends: list[tuple[float, float] | None]) -> None:
    """Draw the parallel axes as vertical lines with the values at both ends."""
    for place, pair in enumerate(ends):
        axes.axvline(place, color=style.INK, linewidth=0.9)
        texts = ("no values", "") if pair is None else tuple(screen_text(value, 4) for value in pair)
        for height, text, side in ((0, texts[0], "top"), (1, texts[1], "bottom")):
            axes.annotate(
                text, (place, height), xytext=(0, -3 if height == 0 else 3), textcoords="offset points",
                ha="center", va=side, fontsize=style.SMALL, color=style.MUTED, annotation_clip=False,
            )  # fmt: skip
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)

"""Scatter plots of quantities over parameters, or densities if there are many points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

import torsionnet.plot.drawing.style as style
from torsionnet.base.errors import UsageError
from torsionnet.base.number_text import screen_text
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.plot.study.study_axes import (
    BEYOND_COLOR,
    WITHIN_COLOR,
    axis_ends,
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
    from torsionnet.study.answers.scatter_answer import ParallelCoordinatesResult, ScatterResult


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

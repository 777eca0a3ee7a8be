"""Scatter plots of quantities over parameters, or densities if there are many points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

import torsionnet.plot.drawing.style as style
from torsionnet.base.errors import UsageError
from torsionnet.plot.study.study_axes import (
    axis_ends,
    axis_label,
    finite_values,
    is_wide,
    legend_below,
    log_axis,
    write_in_empty_panel,
)
from torsionnet.study.shown_units import IN_SI, ShownUnits

if TYPE_CHECKING:
    from torsionnet.linear.frequency_response import FloatArray
    from torsionnet.study.answers.scatter_answer import ScatterResult

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
    result: ScatterResult, configuration: str | None = None, *, units: ShownUnits = IN_SI, title: str | None = None
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
        raise UsageError(f'there is no configuration "{configuration}"; there are {", ".join(result.points)}')
    shown = _strongest(result, cases)
    si = {**result.parameter_units, **result.units}
    columns = {name: _columns(result, cases, name, units.scale(name, si[name])) for name in (*shown, *result.units)}
    width = max(style.WIDTH, PANEL_WIDTH * len(shown))
    figure = style.new_figure(width, 0.9 + PANEL_HEIGHT * len(result.units))
    panels = figure.subplots(len(result.units), len(shown), squeeze=False, sharex="col", sharey="row")
    for row, quantity in zip(panels, result.units, strict=True):
        for axes, parameter in zip(row, shown, strict=True):
            _points(axes, columns[parameter], columns[quantity])
            _coefficient(axes, result, cases, parameter, quantity)
            style.style_axes(axes)
        _scaled(row[0], "y", columns[quantity])
        row[0].set_ylabel(axis_label(quantity, units.unit(quantity, si[quantity]), PANEL_HEIGHT))
    for axes, parameter in zip(panels[-1], shown, strict=True):
        _scaled(axes, "x", columns[parameter])
        axes.set_xlabel(axis_label(parameter, units.unit(parameter, si[parameter]), width / len(shown) - 0.2))
    handles, labels = panels[0][0].get_legend_handles_labels()
    if len(labels) > 1:
        legend_below(figure, handles, labels, larger=3)
    style.set_title(figure, result.title if title is None else title)
    return figure


def _strongest(result: ScatterResult, cases: list[str]) -> list[str]:
    sizes = np.nan_to_num(
        np.max([np.abs(one.coefficients) for (case, _), one in result.correlations.items() if case in cases], axis=0)
    )
    kept = sorted(np.argsort(-sizes, kind="stable")[:MOST_PARAMETERS].tolist())
    return [list(result.parameter_units)[place] for place in kept]


def _columns(result: ScatterResult, cases: list[str], name: str, scale: float) -> dict[str, FloatArray]:
    return {case: scale * result.points[case][name] for case in cases}


def _points(axes: Axes, x: dict[str, FloatArray], y: dict[str, FloatArray]) -> None:
    across, up = (np.concatenate(list(one.values())) for one in (x, y))
    there = np.isfinite(across) & np.isfinite(up)
    if not there.any():
        write_in_empty_panel(axes, "no values")
    elif len(across) >= MANY_POINTS:
        bins = [_bins(one[there]) for one in (across, up)]
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


def _scaled(axes: Axes, side: str, columns: dict[str, FloatArray]) -> None:
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

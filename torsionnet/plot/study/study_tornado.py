"""Tornado plots: the effect of each parameter on the quantities of a study, or on frequencies and damping of modes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.errors import UsageError
from torsionnet.base.number_text import screen_text, typeset_unit, unit_in_brackets
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.plot.drawing.style import Bars, GivenAxes, draw_bars, fills_a_page, name_rows
from torsionnet.plot.study.study_axes import (
    EQUAL_VALUES,
    axis_label,
    bars_legend,
    break_text,
    panel_title,
    parameter_rows,
    study_bars,
    write_in_empty_panel,
)
from torsionnet.study.study import IN_SI, ShownUnits

if TYPE_CHECKING:
    from torsionnet.linear.sensitivity.sensitivities_of_modes import ModeSensitivities
    from torsionnet.study.answers.sensitivity_answers import SobolEstimates, SobolResult, Swings, TornadoResult


# Tornado plot of a study, with the effect of each parameter alone on the quantities.

# Matrices of colours with effects of parameters (rows) in configurations (columns), where bars need more room.

FIELD_WIDTH, FIELD_HEIGHT = 0.3, 0.24
"""Width and height in inches of a field of the matrix, for one parameter in one configuration."""
NAMES_WIDTH = 2.6
"""Width in inches of the names of parameters and the bar of colours together."""


@dataclass(frozen=True)
class ColourScale:
    """Scale of the colours of a matrix, with its label, name of matplotlib's colour map, and values at the ends."""

    label: str
    colours: str
    low: float
    high: float


def parameter_matrix(
    values: Mapping[str, FloatArray],
    parameters: Sequence[str],
    cases: Sequence[str],
    scales: Mapping[str, ColourScale],
    ax: GivenAxes,
) -> style.Sheet:
    """Sheet with a matrix for each quantity, effects in colours, parameters in rows, configurations in columns.

    Parameters
    ----------
    values : mapping
        Quantity -> effects, (n_parameters, n_cases); NaN fields stay grey.
    parameters, cases : sequence of str
    scales : mapping
        By quantity.
    ax : sequence of Axes, optional
        One for each quantity.
    """
    width = max(style.WIDTH, NAMES_WIDTH + FIELD_WIDTH * len(cases))
    height = 1.6 + len(values) * (0.9 + FIELD_HEIGHT * len(parameters))
    sheet, _ = style.grid_panels(width, height, list(values), ax, sharex=True)
    for axes, (quantity, matrix) in zip(sheet.panels, values.items(), strict=True):
        scale = scales[quantity]
        order = np.argsort(-np.nan_to_num(np.abs(matrix)).max(axis=1), kind="stable")
        axes.set_facecolor(style.FAINT)
        shown = axes.imshow(matrix[order], cmap=scale.colours, vmin=scale.low, vmax=scale.high, aspect="auto")
        parameter_rows(axes, [parameters[place] for place in order], width)
        axes.set_ylim(len(parameters) - 0.5, -0.5)
        axes.tick_params(labelsize=style.SMALL)
        panel_title(axes, quantity)
        bar = sheet.figure.colorbar(shown, ax=axes)
        bar.set_label(break_text(scale.label, max(1.2, FIELD_HEIGHT * len(parameters))), fontsize=style.SMALL)
        bar.ax.tick_params(labelsize=style.SMALL)
    sheet.panels[-1].set_xticks(range(len(cases)), cases, rotation=90, fontsize=style.SMALL)
    return sheet


MOST_PARAMETERS = 12
"""Largest number of parameters in a panel, those with the widest bars."""


def study_tornado(
    result: TornadoResult, *, units: ShownUnits = IN_SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of bars from a quantity's value at the low end of each parameter to that at its high end, widest on top.

    Parameters
    ----------
    result : TornadoResult
        Result of the answer ``tornado`` of a study.
    units : ShownUnits, optional
        By default SI.
    title : str, optional
    ax : sequence of Axes, optional
        Axes to draw into, one for each quantity and configuration; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    quantities, cases = list(result.units), list(result.spans)
    names = list(result.parameter_units)
    pairs = [(case, quantity) for quantity in quantities for case in cases]
    if fills_a_page(len(pairs), min(MOST_PARAMETERS, len(names))):
        return _matrix(result, units, ax).titled(result.title if title is None else title)
    shows = [f"{quantity}, {case}" if case else quantity for case, quantity in pairs]
    sheet, width = study_bars(shows, min(MOST_PARAMETERS, len(names)), names, ax)
    for axes, (case, quantity) in zip(sheet.panels, pairs, strict=True):
        scale, unit = units.scale(quantity, result.units[quantity]), units.unit(quantity, result.units[quantity])
        swings = result.swings[case, quantity]
        _bars(axes, swings, list(result.spans[case]), scale, width)
        axes.set_xlabel(axis_label(quantity, unit, width))
        middle = "" if np.isnan(swings.middle) else f"{screen_text(swings.middle * scale, 4)} in the middle"
        told = [*([case] if len(cases) > 1 else []), *([middle] if middle else [])]
        panel_title(axes, ": ".join(told), width - 0.4)
    bars_legend(sheet)
    return sheet.titled(result.title if title is None else title)


def _matrix(result: TornadoResult, units: ShownUnits, ax: GivenAxes) -> style.Sheet:
    """Sheet of quantities' changes from low to high end of parameters in colours, parameters by configurations.

    It stands for bars if there were too many panels.
    """
    names, cases = list(result.parameter_units), list(result.spans)
    changes, scales = {}, {}
    for quantity, si in result.units.items():
        swings = [result.swings[case, quantity] for case in cases]
        changes[quantity] = units.scale(quantity, si) * np.column_stack(
            [swing.at_high - swing.at_low for swing in swings]
        )
        most = float(np.abs(np.nan_to_num(changes[quantity])).max()) or 1.0
        label = f"change from low to high end {unit_in_brackets(typeset_unit(units.unit(quantity, si)))}".rstrip()
        scales[quantity] = ColourScale(label, "RdBu_r", -most, most)
    return parameter_matrix(changes, names, cases, scales, ax)


def _bars(axes: Axes, swings: Swings, names: list[str], scale: float, width: float) -> None:
    shown = swings.order[:MOST_PARAMETERS]
    style.style_axes(axes)
    parameter_rows(axes, [names[place] for place in shown], width)
    ends = np.array([swings.at_low[shown], swings.at_high[shown]])
    if not (np.abs(ends - swings.middle) > EQUAL_VALUES * abs(swings.middle)).any():
        write_in_empty_panel(axes, "no value" if np.isnan(swings.middle) else "moved by no parameter")
        axes.set_xticks([])
        return
    low, high = (ends - swings.middle) * scale
    bars = [
        Bars(low, style.PALETTE[5], "parameter at its low end", swings.middle * scale, alpha=0.9),
        Bars(high, style.PALETTE[1], "at its high end", swings.middle * scale, alpha=0.9),
    ]
    draw_bars(axes, len(shown), bars, line=style.INK, width=0.9)
    axes.locator_params(axis="x", nbins=4)


# Plot of Sobol indices, the shares of a quantity's variance due to parameters, as bars with confidence intervals.

BAR_HEIGHT = 0.36
"""Height of a bar as a share of the height of its row: two bars with a gap to the next row."""
AXIS_ENDS = -0.1, 1.15
"""Lower and upper end of the axis of Sobol indices, at which wider confidence intervals are cut off: indices lie
between 0 and 1."""


def sobol_indices(
    result: SobolResult, *, units: ShownUnits = IN_SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure with bars of the first-order and total Sobol indices of every parameter.

    A panel for each quantity and configuration.

    Parameters
    ----------
    result : SobolResult
        Result of the answer ``sobol_indices`` of a study.
    units : ShownUnits, optional
        Shares have none.
    title : str, optional
    ax : sequence of Axes, optional
        Axes to draw into, one for each quantity and configuration; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    del units
    cases = list(dict.fromkeys(case for case, _ in result.indices))
    rows = min(MOST_PARAMETERS, len(result.parameters))
    if fills_a_page(len(result.indices), rows):
        return _index_matrix(result, cases, ax).titled(result.title if title is None else title)
    shows = [f"{quantity}, {case}" if case else quantity for (case, quantity), _ in _by_quantity(result)]
    sheet, width = study_bars(shows, rows, result.parameters, ax)
    panels = sheet.panels
    for axes, ((case, quantity), estimates) in zip(panels, _by_quantity(result), strict=True):
        _index_bars(axes, estimates, result.parameters, width)
        panel_title(axes, f"{quantity}, {case}" if len(cases) > 1 else quantity, width - 0.4)
    columns = round(style.WIDTH / width)
    for axes in panels[-columns:]:
        axes.set_xlabel("share of the variance [-]")
    bars_legend(sheet, f", {100 * result.confidence:g} % interval")
    return sheet.titled(result.title if title is None else title)


def _index_matrix(result: SobolResult, cases: list[str], ax: GivenAxes) -> style.Sheet:
    """Sheet of matrices of the total Sobol indices in colours, parameters in rows, configurations in columns.

    First-order indices are left out.
    """
    quantities = list(dict.fromkeys(name for _, name in result.indices))
    totals = {name: np.column_stack([result.indices[case, name].total for case in cases]) for name in quantities}
    scale = ColourScale("total index [-]", "Blues", 0.0, 1.0)
    return parameter_matrix(totals, result.parameters, cases, dict.fromkeys(quantities, scale), ax)


def _by_quantity(result: SobolResult) -> list[tuple[tuple[str, str], SobolEstimates]]:
    names = list(dict.fromkeys(name for _, name in result.indices))
    return sorted(result.indices.items(), key=lambda pair: names.index(pair[0][1]))


def _index_bars(axes: Axes, shares: SobolEstimates, parameters: tuple[str, ...], width: float) -> None:
    order = np.argsort(-np.nan_to_num(shares.total, nan=-np.inf), kind="stable")[:MOST_PARAMETERS].tolist()
    style.style_axes(axes)
    parameter_rows(axes, [parameters[place] for place in order], width)
    axes.set_xlim(AXIS_ENDS)
    if not np.isfinite(shares.total).any():
        write_in_empty_panel(axes, "no variance to be shared")
        return
    bars = [
        Bars(values[order], color, label, height=BAR_HEIGHT, below=shift, intervals=(low[order], high[order]))
        for shift, color, values, low, high, label in (
            (-BAR_HEIGHT / 2, style.PALETTE[0], shares.first, shares.first_low, shares.first_high, "first order"),
            (BAR_HEIGHT / 2, style.PALETTE[1], shares.total, shares.total_low, shares.total_high, "total"),
        )
    ]
    draw_bars(axes, len(order), bars)


# Tornado plot of the sensitivity of natural frequencies and damping ratios to parameters, the largest on top.

MOST_MODES, MOST_BARS = 4, 12
"""Number of modes drawn unless others are asked for, and largest number of bars in a panel: as many as fit a page."""
SHORTEST_BAR = 5e-3
"""Sensitivity, relative to the largest one, up to which a parameter has no bar: its bar would not be seen."""
ROUNDING = 1e-9
"""Sensitivity in percent per percent up to which it is a rounding error of zero."""


def tornado(
    result: ModeSensitivities, *, mode: list[int] | None = None, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of bars, the percent of natural frequency and of damping ratio of modes per percent of each parameter.

    Parameters
    ----------
    result : ModeSensitivities
    mode : list of int, optional
        Numbers of modes as in their table; by default the first four, real poles among them.
    title : str, optional
    ax : sequence of Axes, optional
        Axes to draw into, for natural frequency and, if it has any, damping ratio of each mode; by default those of a
        new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import torsionnet as tn
    >>> result = tn.sensitivity.mode_sensitivities(tn.load("dmf_rig"))
    >>> len(tornado(result, mode=[1]).axes)
    2
    """
    known = [result.number(index) for index in range(len(result.poles))]
    have = [str(number) for number in known if number is not None]
    wrong = [number for number in mode or () if number not in known]
    if wrong or not known:
        there = f"there are {', '.join(have)}" if have else "there is none that vibrates"
        raise UsageError(f"there is no mode {wrong[0] if wrong else 1}; {there}", kind="unknown-mode")
    chosen = [known.index(number) for number in mode] if mode else list(range(len(known)))
    chosen = [place for place in chosen if _moves(result, place)][: len(chosen) if mode else MOST_MODES]
    if not chosen:
        raise UsageError(
            "there is nothing to draw: none of the parameters moves these modes; choose other modes or parameters",
            kind="missing-data",
        )
    # A parameter counts by what it moves most, over all modes drawn; the least are left out.
    size = (np.abs(result.relative_frequencies) + np.abs(result.relative_dampings))[chosen].max(axis=0)
    shown = [int(p) for p in np.argsort(-size)[:MOST_BARS] if size[p] > SHORTEST_BAR * size.max()]
    damped = any(np.abs(result.relative_dampings[place]).max() > ROUNDING for place in chosen)
    height = 1.2 + len(chosen) * (0.6 + 0.22 * len(shown))
    what = ("natural frequency", "damping ratio")[: 1 + damped]
    shows = [f"{quantity} of {result.name(place)}" for place in chosen for quantity in what]
    sheet, panels = style.grid_panels(style.WIDTH, height, shows, ax, columns=len(what))
    for row, place in zip(panels, chosen, strict=True):
        _slope_bars(row[0], result, result.relative_frequencies[place], shown, style.PALETTE[0])
        row[0].set_title(f"{result.name(place)}: {result.natural_frequencies[place]:.4g} Hz", fontsize=style.FONT)
        if damped:
            _damping(sheet, row[1], result, place, shown)
    for axes, quantity in zip(_lowest(panels), what, strict=True):
        axes.set_xlabel(f"{quantity} [% per %]")
    return sheet.titled(result.title if title is None else title)


def _moves(result: ModeSensitivities, mode: int) -> bool:
    slopes = np.abs(np.concatenate([result.relative_frequencies[mode], result.relative_dampings[mode]]))
    return bool(slopes.max(initial=0.0) > ROUNDING)


def _damping(sheet: style.Sheet, axes: Axes, result: ModeSensitivities, mode: int, shown: list[int]) -> None:
    """Draw bars with the sensitivity of the damping ratio of a mode to each parameter, in percent per percent.

    Remove the panel of a real pole or a mode without damping.
    """
    slopes = result.relative_dampings[mode]
    if np.abs(slopes[shown]).max(initial=0.0) <= ROUNDING:
        sheet.drop(axes)
        return
    _slope_bars(axes, result, slopes, shown, style.PALETTE[1])
    axes.set_title(f"damping ratio {100 * result.damping_ratios[mode]:.3g} %", fontsize=style.FONT)


def _lowest(panels: Any) -> list[Axes]:
    """List of the lowest panel left in each column of the figure."""
    return [[axes for axes in column if axes.figure is not None and axes.axison][-1] for column in panels.T]


def _slope_bars(axes: Axes, result: ModeSensitivities, slopes: FloatArray, shown: list[int], colour: str) -> None:
    """Draw bars with a mode's sensitivity to each parameter that moves it, in percent per percent, longest on top."""
    style.style_axes(axes)
    sizes = np.abs(slopes)
    falling = sorted(shown, key=lambda p: -float(f"{sizes[p]:.6g}"))  # equal ones in the order of the parameters
    longest = [p for p in falling if sizes[p] > max(SHORTEST_BAR * sizes[falling[0]], ROUNDING)]
    name_rows(axes, [result.parameters[p] for p in longest])
    draw_bars(axes, len(longest), [Bars(slopes[longest], colour)])

"""Plots of how results spread over the variants of a study, beside their limits, and of the worst variants."""

from __future__ import annotations

import math
import textwrap
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import torsionnet.plot.drawing.style as style
from torsionnet.base.number_text import screen_text, typeset_unit
from torsionnet.base.units import RPM
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.plot.study.study_axes import (
    BEYOND_COLOR,
    axis_label,
    finite_values,
    is_wide,
    legend_below,
    log_axis,
    panel_title,
    parameter_rows,
    text_rows,
    write_in_empty_panel,
)
from torsionnet.study.study import IN_SI, ShownUnits

if TYPE_CHECKING:
    from torsionnet.linear.frequency_response import FloatArray
    from torsionnet.study.answers.failure_probability import FailureProbabilityResult
    from torsionnet.study.answers.subset_sampling import RareEvent
    from torsionnet.study.answers.worst_case_answer import WorstCaseResult, WorstVariant
    from torsionnet.study.answers.yield_answer import LimitedValues, PercentileBandsResult, YieldResult


# Plots of how results spread over the variants of a study, beside their limits and over frequency.

# Plot of the distributions of quantities over all variants about their limits, with the shares of variants beyond.

SIDE_MARGIN = 0.05
"""Margin at each side of an axis, as a share of the range of all values and near limits."""
MOST_NAMES_INSIDE = 2
"""Largest number of configurations with which the legend stands within the axes; of more it stands beside them."""
LEGEND_LINE = 0.165
"""Height in inches of a line of the legend beside the plot of limit shares."""


def limit_shares(
    result: YieldResult, *, units: ShownUnits = IN_SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of histograms, percent of variants over a limited quantity, a curve per configuration, limits shaded.

    Parameters
    ----------
    result : YieldResult
        Result of the answer ``yield`` of a study.
    units : ShownUnits, optional
        By default SI.
    title : str, optional
    ax : sequence of Axes, optional
        Axes to draw into, one for each limited quantity; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    names = list(dict.fromkeys(distribution.quantity for distribution in result.distributions))
    cases = len(dict.fromkeys(distribution.configuration for distribution in result.distributions))
    height = 0.8 + max(2.4, 0.9 + LEGEND_LINE * cases) * len(names)
    sheet, _ = style.grid_panels(style.WIDTH, height, names, ax)
    for axes, name in zip(sheet.panels, names, strict=True):
        _panel(axes, result, [spread for spread in result.distributions if spread.quantity == name], units)
    return sheet.titled(result.title if title is None else title)


def _panel(axes: Axes, result: YieldResult, distributions: list[LimitedValues], units: ShownUnits) -> None:
    first = distributions[0]
    scale = units.scale(first.curve or first.quantity, first.unit)
    for number, distribution in enumerate(distributions):
        _drawn(axes, distribution, scale, number, _label(result, distribution))
    style.style_axes(axes)
    with_values = [distribution for distribution in distributions if distribution.counts.any()]
    if with_values:
        _set_value_axis(axes, first, scale, with_values, units)
        axes.set_ylim(bottom=0)
    else:
        write_in_empty_panel(axes, "no variant has a value")
        axes.set(xticks=[], yticks=[])
    axes.set_ylabel("variants [% per bin]")
    axes.set_xlabel(axis_label(first.quantity, units.unit(first.curve or first.quantity, first.unit)))
    if len(distributions) <= MOST_NAMES_INSIDE:
        axes.legend(fontsize=style.SMALL, frameon=False)
    else:
        style.legend_beside(axes)


def _label(result: YieldResult, distribution: LimitedValues) -> str:
    case, quantity = distribution.configuration, f" {distribution.quantity} "
    shares = (each.share for each in result.shares if each.configuration == case and quantity in f" {each.limit} ")
    share = next(shares, None)
    return case if share is None else f"{case}: {share.percent} beyond"


def _drawn(axes: Axes, distribution: LimitedValues, scale: float, number: int, label: str) -> None:
    """Draw a histogram of the variants' values in percent, or a vertical line if all variants have the same value."""
    look = style.line_style(number)
    if not distribution.counts.any():
        axes.plot([], [], label=label, **look)
    elif distribution.constant is not None:
        axes.plot([scale * distribution.constant] * 2, [0, 100], label=label, **look)
    else:
        density = distribution.counts / max(distribution.counts.sum(), 1) * 100
        axes.stairs(density, distribution.edges * scale, label=label, **look)


def _set_value_axis(
    axes: Axes, first: LimitedValues, scale: float, drawn: list[LimitedValues], units: ShownUnits
) -> None:
    """Set the ends of the value axis to all values and near limits, shade beyond limits, and name far limits."""
    low = scale * min(distribution.edges[0] for distribution in drawn)
    high = scale * max(distribution.edges[-1] for distribution in drawn)
    spread = high - low if any(distribution.constant is None for distribution in drawn) else max(abs(low), abs(high))
    sides = [None if side is None else side * scale for side in (first.above, first.below)]
    # A limit farther off than the values spread would squeeze them: it is named at the edge.
    near = [side for side in sides if side is not None and low - spread <= side <= high + spread]
    low, high = min([low, *near]), max([high, *near])
    axes.set_xlim(low - SIDE_MARGIN * (high - low), high + SIDE_MARGIN * (high - low))
    for side, end in zip(sides, (0, 1), strict=True):
        if side is None:
            continue
        if side in near:
            axes.axvline(side, color=BEYOND_COLOR, linewidth=1.4)
            axes.axvspan(*np.sort([side, axes.get_xlim()[end]]), color=BEYOND_COLOR, alpha=0.08, linewidth=0)
            continue
        unit = typeset_unit(units.unit(first.curve or first.quantity, first.unit))
        text = f"limit {screen_text(side, 4)} {unit}".rstrip()
        is_left = side < low
        axes.annotate(
            f"\N{LEFTWARDS ARROW} {text}" if is_left else f"{text} \N{RIGHTWARDS ARROW}",
            (0.0 if is_left else 1.0, 1.0), xycoords="axes fraction", xytext=(0, 2), textcoords="offset points",
            ha="left" if is_left else "right", va="bottom", fontsize=style.SMALL, color=BEYOND_COLOR,
        )  # fmt: skip


# Plot of small probabilities of failure with their confidence intervals, a row for each configuration.

LEAST_LOG_RATIO = 4.0
"""Ratio of the upper to the lower end of an axis below which it stays linear, as a log scale would hardly have a
number."""


def failure_probabilities(
    result: FailureProbabilityResult, *, units: ShownUnits = IN_SI, title: str | None = None, ax: Axes | None = None
) -> Figure:
    """Figure of probabilities that a limit is not kept, a row per configuration, with intervals.

    Points are hollow where not to be trusted.

    Parameters
    ----------
    result : FailureProbabilityResult
        Result of the answer ``failure_probability`` of a study.
    units : ShownUnits, optional
        Probabilities have none.
    title : str, optional
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    del units
    events = list(result.events.items())
    ends = [
        side
        for _, event in events
        for side in (event.low, event.high, event.probability)
        if np.isfinite(side) and side > 0
    ]
    sheet, axes = style.one_panel(1.3 + 0.34 * len(events), ax)
    for place, (_, event) in enumerate(events):
        _drawn_probabilities(axes, place, event)
    if ends:
        low, high = min(ends) / 1.5, max(ends) * 1.5
        axes.set_xlim(low, high)
        if high > LEAST_LOG_RATIO * low:
            log_axis(axes, "x", low, high)
    else:
        axes.set_xticks([])
    text_rows(axes, [case for case, _ in events], style.WIDTH)
    words = textwrap.fill(f"probability of {typeset_unit(result.beyond)} [-]", style.WIDEST_TITLE)
    axes.set_xlabel(f"{words}\n{100 * result.confidence:g} % interval")
    return sheet.titled(result.title if title is None else title)


def _drawn_probabilities(axes: Axes, place: int, event: RareEvent) -> None:
    color = BEYOND_COLOR if event.doubts else style.PALETTE[0]
    if np.isfinite(event.low):
        axes.hlines(place, event.low, event.high, color=color, linewidth=2.0)
    if event.probability:
        axes.plot(event.probability, place, "o", color=color, markerfacecolor=style.PAPER if event.doubts else color)
    else:
        axes.text(
            0.02, place, "no failure was met", transform=axes.get_yaxis_transform(), fontsize=style.SMALL,
            color=style.MUTED, va="center",
        )  # fmt: skip


# Plot of percentiles of the variants' curves over frequency or speed, as bands within each other.

MOST_COLUMNS = 3
"""Largest number of panels of percentile bands side by side; narrower ones have no room for numbers along the axis."""
PANEL_HEIGHT = 2.3
"""Height in inches of a panel with the bands of percentiles of one configuration."""


def percentile_bands(
    result: PercentileBandsResult, *, units: ShownUnits = IN_SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of percentiles of curves over frequency or speed as bands within each other, the middle one as a line.

    A panel for each configuration.

    Parameters
    ----------
    result : PercentileBandsResult
        Result of the answer ``percentile_bands`` of a study.
    units : ShownUnits, optional
        By default SI.
    title : str, optional
    ax : sequence of Axes, optional
        Axes to draw into, one for each configuration; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    count, quantity = len(result.lines), (result.quantity, result.measure.unit)
    columns = style.panel_columns(count, MOST_COLUMNS)
    height = 1.1 + PANEL_HEIGHT * math.ceil(count / columns)
    sheet, grid = style.grid_panels(
        style.WIDTH, height, list(result.lines), ax, columns=columns, sharex=True, sharey=True
    )
    panels = sheet.panels
    over_speed = result.measure.over == "speed"
    points = result.measure.points * RPM if over_speed else result.measure.points
    scale = units.scale(*quantity)
    for axes, (case, lines) in zip(panels, result.lines.items(), strict=True):
        _bands(axes, points, lines * scale, result.percentiles)
        if count > 1:
            panel_title(axes, case, style.WIDTH / columns - 0.5)
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
    legend_below(sheet, handles, labels)
    return sheet.titled(result.title if title is None else title)


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


# Plot of worst cases, extreme values of a quantity, and the parameter values within tolerances that cause them.

COLORS = {"largest": style.PALETTE[1], "smallest": style.PALETTE[0]}
MOST_PANELS = 4
"""Largest number of configurations that each have a row of panels in the plot of worst cases; more share one table of
places."""
ROW = 0.26
"""Height in inches of a row for one parameter in the plot of worst cases."""
PLACES = {"v": "at the lower bound", "^": "at the upper bound", "o": "between"}
HALF_WIDTH = style.WIDTH / 2  # inches


def worst_variants(
    result: WorstCaseResult, *, units: ShownUnits = IN_SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of a quantity as given and in the worst case on the left, and parameters within tolerances on the right.

    Parameters
    ----------
    result : WorstCaseResult
        Result of the answer ``worst_case`` of a study.
    units : ShownUnits, optional
        By default SI.
    title : str, optional
    ax : sequence of Axes, optional
        Axes to draw into, for values and parameters, of each configuration where these have rows of their own; by
        default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    cases = list(dict.fromkeys(variant.configuration for variant in result.variants))
    names = list(result.parameter_units)
    sheet = (_panels if len(cases) <= MOST_PANELS else _worst_sheet)(result, cases, names, units, ax)
    directions = dict.fromkeys(variant.direction for variant in result.variants)
    marks = [Line2D([], [], color=style.MUTED, linewidth=1.0)]
    marks += [Line2D([], [], color=COLORS[direction], linewidth=6.0) for direction in directions]
    texts = ["as given", *(f"{direction} value" for direction in directions)]
    if len(cases) > MOST_PANELS:
        marks += [Line2D([], [], marker=mark, color=style.MUTED, linestyle="none") for mark in PLACES]
        texts += PLACES.values()
    legend_below(sheet, marks, texts)
    return sheet.titled(result.title if title is None else title)


def _panels(
    result: WorstCaseResult, cases: list[str], names: list[str], units: ShownUnits, ax: GivenAxes
) -> style.Sheet:
    """Sheet of worst cases, a row for each configuration with a panel of values and a panel of parameters."""
    lines = max(axis_label(name, "", HALF_WIDTH / 2).count("\n") + 1 for name in names)
    height = max(1.0, 0.5 + ROW * (lines + 1) / 2 * len(names))
    shows = [f"{what} of {case}" if case else what for case in cases for what in (result.quantity, "parameters")]
    sheet, panels = style.grid_panels(style.WIDTH, 1.1 + len(cases) * height, shows, ax, columns=2, sharex="col")
    for row, case in zip(panels, cases, strict=True):
        here = [variant for variant in result.variants if variant.configuration == case]
        _values(row[0], here, 0, units.scale(result.quantity, result.unit))
        text_rows(row[0], [case], HALF_WIDTH)
        row[0].set_ylim(0.6, -0.9)
        _places(row[1], here, names)
    panels[-1][0].set_xlabel(axis_label(result.quantity, units.unit(result.quantity, result.unit), HALF_WIDTH))
    panels[-1][1].set_xlabel("within the tolerance")
    panels[-1][1].set_xticks([0, 0.5, 1], ["lower", "middle", "upper"])
    return sheet


def _worst_sheet(
    result: WorstCaseResult, cases: list[str], names: list[str], units: ShownUnits, ax: GivenAxes
) -> style.Sheet:
    """Sheet of worst cases with a panel of values, a panel of parameters, and a row per configuration and direction.

    The value, and marks for the places of parameters.
    """
    width, shows = max(style.WIDTH, HALF_WIDTH + 0.45 * len(names)), [result.quantity, "parameters"]
    sheet, _ = style.grid_panels(width, 1.9 + 0.38 * len(cases), shows, ax, columns=2, sharey=True)
    values, places = sheet.panels
    for number, case in enumerate(cases):
        here = [variant for variant in result.variants if variant.configuration == case]
        _values(values, here, number, units.scale(result.quantity, result.unit), texts=False)
        for variant in here:
            level = number + (0.0 if len(here) == 1 else -0.2 if variant.direction == "largest" else 0.2)
            _strip(places, list(_shares(variant, names)), level, variant.direction)
    text_rows(values, cases, HALF_WIDTH)
    places.tick_params(labelleft=False)
    values.set_xlabel(axis_label(result.quantity, units.unit(result.quantity, result.unit), HALF_WIDTH))
    width = (sheet.width - HALF_WIDTH) / len(names)
    lines = [axis_label(name, "", max(width, 1.2)) for name in names]
    places.set_xticks(range(len(names)), lines, rotation=90 if max(map(len, names)) > MOST_PANELS else 0)
    places.set_xlim(-0.6, len(names) - 0.4)
    style.style_axes(places)
    places.set_xlabel("within the tolerance")
    return sheet


def _strip(axes: Axes, shares: list[float], level: float, direction: str) -> None:
    for place, share in enumerate(shares):
        mark = "v" if share < AT_BOUND else "^" if share > 1 - AT_BOUND else "o"
        axes.plot(place, level, mark, color=COLORS[direction], markersize=5, markeredgewidth=0)


AT_BOUND = 1e-3
"""Distance of a parameter from an end of its tolerance, as a share of the tolerance, below which it counts as there."""


def _values(axes: Axes, here: list[WorstVariant], row: int, scale: float, *, texts: bool = True) -> None:
    style.style_axes(axes)
    if all(np.isnan(variant.value) for variant in here):
        write_in_empty_panel(axes, "no value")
        return
    axes.plot([here[0].nominal * scale] * 2, [row - 0.4, row + 0.4], color=style.MUTED, linewidth=1.0)
    for variant in here:
        axes.barh(row, (variant.value - variant.nominal) * scale, left=variant.nominal * scale, height=0.5,
                  color=COLORS[variant.direction])  # fmt: skip
    axes.margins(x=0.15)
    if not texts:
        return
    for variant in here[:1] if len({screen_text(variant.value, 4) for variant in here}) == 1 else here:
        side = "left" if len(here) > 1 and variant.direction == "largest" else "right" if len(here) > 1 else "center"
        axes.annotate(
            screen_text(variant.value * scale, 4), (variant.value * scale, row - 0.3), ha=side, va="bottom",
            fontsize=style.SMALL, color=style.INK,
        )  # fmt: skip


def _shares(variant: WorstVariant, names: list[str]) -> list[float]:
    """List of the places of parameters within their tolerances, from 0 at the lower to 1 at the upper end."""
    ends = [(variant.variant[name], *variant.tolerance[name]) for name in names]
    return [(value - low) / (high - low) if high > low else 0.5 for value, low, high in ends]


def _places(axes: Axes, here: list[WorstVariant], names: list[str]) -> None:
    style.style_axes(axes)
    for variant in here:
        axes.plot(_shares(variant, names), range(len(names)), "^" if variant.direction == "largest" else "v",
                  color=COLORS[variant.direction], markersize=7, clip_on=False)  # fmt: skip
    parameter_rows(axes, names, HALF_WIDTH)
    axes.set_xlim(-0.03, 1.03)

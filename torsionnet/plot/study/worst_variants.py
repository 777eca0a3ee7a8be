"""Plot of worst cases, extreme values of a quantity, and the parameter values within tolerances that cause them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import torsionnet.plot.drawing.style as style
from torsionnet.base.number_text import screen_text
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.plot.study.study_axes import axis_label, legend_below, parameter_rows, text_rows, write_in_empty_panel
from torsionnet.study.shown_units import IN_SI, ShownUnits

if TYPE_CHECKING:
    from torsionnet.study.answers.worst_case_answer import WorstCaseResult, WorstVariant

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

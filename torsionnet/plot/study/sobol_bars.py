"""Sobol indices as bars with their intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.plot.drawing.bars import Bars, draw_bars, fills_a_page
from torsionnet.plot.study.parameter_matrix import ColourScale, parameter_matrix
from torsionnet.plot.study.study_axes import bar_key, named_rows, say, study_bars, titled
from torsionnet.study.shown_units import IN_SI, ShownUnits

if TYPE_CHECKING:
    from torsionnet.study.answers.sobol_indices import SobolEstimates, SobolFound

HEIGHT = 0.36
MOST_PARAMETERS = 12
WITHIN = -0.1, 1.15
"""What is drawn of intervals: shares lie between 0 and 1."""


def sobol_indices(found: SobolFound, *, units: ShownUnits = IN_SI, title: str | None = None) -> Figure:
    """First-order and total index of every parameter, the largest on top; a panel for each quantity and configuration.

    Parameters
    ----------
    found : SobolFound
        What the answer ``sobol_indices`` of a study found.
    units : ShownUnits, optional
        Shares have none.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    del units
    cases = list(dict.fromkeys(case for case, _ in found.indices))
    rows = min(MOST_PARAMETERS, len(found.parameters))
    if fills_a_page(len(found.indices), rows):
        figure = _matrix(found, cases)
        style.set_title(figure, found.title if title is None else title)
        return figure
    figure, panels, width = study_bars(len(found.indices), rows, found.parameters)
    for axes, ((case, quantity), one) in zip(panels, _by_quantity(found), strict=True):
        _bars(axes, one, found.parameters, width)
        titled(axes, f"{quantity}, {case}" if len(cases) > 1 else quantity, width - 0.4)
    columns = round(style.WIDTH / width)
    for axes in panels[-columns:]:
        axes.set_xlabel("share of the variance [-]")
    bar_key(figure, panels, f", {100 * found.confidence:g} % interval")
    style.set_title(figure, found.title if title is None else title)
    return figure


def _matrix(found: SobolFound, cases: list[str]) -> Figure:
    """Total indices alone."""
    quantities = list(dict.fromkeys(name for _, name in found.indices))
    totals = {name: np.column_stack([found.indices[case, name].total for case in cases]) for name in quantities}
    scale = ColourScale("total index [-]", "Blues", 0.0, 1.0)
    return parameter_matrix(totals, found.parameters, cases, dict.fromkeys(quantities, scale))


def _by_quantity(found: SobolFound) -> list[tuple[tuple[str, str], SobolEstimates]]:
    names = list(dict.fromkeys(name for _, name in found.indices))
    return sorted(found.indices.items(), key=lambda one: names.index(one[0][1]))


def _bars(axes: Axes, one: SobolEstimates, parameters: tuple[str, ...], width: float) -> None:
    order = np.argsort(-np.nan_to_num(one.total, nan=-np.inf), kind="stable")[:MOST_PARAMETERS].tolist()
    style.style_axes(axes)
    named_rows(axes, [parameters[place] for place in order], width)
    axes.set_xlim(WITHIN)
    if not np.isfinite(one.total).any():
        say(axes, "no variance to be shared")
        return
    bars = [
        Bars(values[order], color, label, height=HEIGHT, below=shift, intervals=(low[order], high[order]))
        for shift, color, values, low, high, label in (
            (-HEIGHT / 2, style.PALETTE[0], one.first, one.first_low, one.first_high, "first order"),
            (HEIGHT / 2, style.PALETTE[1], one.total, one.total_low, one.total_high, "total"),
        )
    ]
    draw_bars(axes, len(order), bars)

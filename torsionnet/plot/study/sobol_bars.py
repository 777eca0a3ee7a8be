"""Plot of Sobol indices, the shares of a quantity's variance due to parameters, as bars with confidence intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.plot.drawing.bars import Bars, draw_bars, fills_a_page
from torsionnet.plot.study.parameter_matrix import ColourScale, parameter_matrix
from torsionnet.plot.study.study_axes import bars_legend, panel_title, parameter_rows, study_bars, write_in_empty_panel
from torsionnet.study.shown_units import IN_SI, ShownUnits

if TYPE_CHECKING:
    from torsionnet.study.answers.sobol_indices import SobolEstimates, SobolResult

BAR_HEIGHT = 0.36
"""Height of a bar as a share of the height of its row: two bars with a gap to the next row."""
MOST_PARAMETERS = 12
"""Largest number of parameters in a panel, those with the largest total Sobol indices."""
AXIS_ENDS = -0.1, 1.15
"""Lower and upper end of the axis of Sobol indices, at which wider confidence intervals are cut off: indices lie
between 0 and 1."""


def sobol_indices(result: SobolResult, *, units: ShownUnits = IN_SI, title: str | None = None) -> Figure:
    """Figure with bars of the first-order and total Sobol indices of every parameter.

    A panel for each quantity and configuration.

    Parameters
    ----------
    result : SobolResult
        Result of the answer ``sobol_indices`` of a study.
    units : ShownUnits, optional
        Shares have none.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    del units
    cases = list(dict.fromkeys(case for case, _ in result.indices))
    rows = min(MOST_PARAMETERS, len(result.parameters))
    if fills_a_page(len(result.indices), rows):
        figure = _index_matrix(result, cases)
        style.set_title(figure, result.title if title is None else title)
        return figure
    figure, panels, width = study_bars(len(result.indices), rows, result.parameters)
    for axes, ((case, quantity), one) in zip(panels, _by_quantity(result), strict=True):
        _index_bars(axes, one, result.parameters, width)
        panel_title(axes, f"{quantity}, {case}" if len(cases) > 1 else quantity, width - 0.4)
    columns = round(style.WIDTH / width)
    for axes in panels[-columns:]:
        axes.set_xlabel("share of the variance [-]")
    bars_legend(figure, panels, f", {100 * result.confidence:g} % interval")
    style.set_title(figure, result.title if title is None else title)
    return figure


def _index_matrix(result: SobolResult, cases: list[str]) -> Figure:
    """Figure of matrices of the total Sobol indices in colours, parameters in rows, configurations in columns.

    First-order indices are left out.
    """
    quantities = list(dict.fromkeys(name for _, name in result.indices))
    totals = {name: np.column_stack([result.indices[case, name].total for case in cases]) for name in quantities}
    scale = ColourScale("total index [-]", "Blues", 0.0, 1.0)
    return parameter_matrix(totals, result.parameters, cases, dict.fromkeys(quantities, scale))


def _by_quantity(result: SobolResult) -> list[tuple[tuple[str, str], SobolEstimates]]:
    names = list(dict.fromkeys(name for _, name in result.indices))
    return sorted(result.indices.items(), key=lambda one: names.index(one[0][1]))


def _index_bars(axes: Axes, one: SobolEstimates, parameters: tuple[str, ...], width: float) -> None:
    order = np.argsort(-np.nan_to_num(one.total, nan=-np.inf), kind="stable")[:MOST_PARAMETERS].tolist()
    style.style_axes(axes)
    parameter_rows(axes, [parameters[place] for place in order], width)
    axes.set_xlim(AXIS_ENDS)
    if not np.isfinite(one.total).any():
        write_in_empty_panel(axes, "no variance to be shared")
        return
    bars = [
        Bars(values[order], color, label, height=BAR_HEIGHT, below=shift, intervals=(low[order], high[order]))
        for shift, color, values, low, high, label in (
            (-BAR_HEIGHT / 2, style.PALETTE[0], one.first, one.first_low, one.first_high, "first order"),
            (BAR_HEIGHT / 2, style.PALETTE[1], one.total, one.total_low, one.total_high, "total"),
        )
    ]
    draw_bars(axes, len(order), bars)

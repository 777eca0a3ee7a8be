"""Sobol indices as bars with their intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.plot.study.parameter_matrix import ColourScale, parameter_matrix
from torsionnet.plot.study.study_axes import bar_panels, key_below, named_rows, say, takes_a_page, titled
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
    if takes_a_page(len(found.indices), rows):
        figure = _matrix(found, cases)
        style.heading(figure, found.title if title is None else title)
        return figure
    figure, panels, width = bar_panels(len(found.indices), rows, found.parameters)
    for axes, ((case, quantity), one) in zip(panels, _by_quantity(found), strict=True):
        _bars(axes, one, found.parameters, width)
        titled(axes, f"{quantity}, {case}" if len(cases) > 1 else quantity, width - 0.4)
    columns = round(style.WIDTH / width)
    for axes in panels[-columns:]:
        axes.set_xlabel("share of the variance [-]")
    handles, labels = next(
        ((handles, labels) for axes in panels for handles, labels in [axes.get_legend_handles_labels()] if labels),
        ((), ()),
    )
    if labels:
        key_below(figure, handles, [f"{label}, {100 * found.confidence:g} % interval" for label in labels])
    style.heading(figure, found.title if title is None else title)
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
    style.dress(axes)
    named_rows(axes, [parameters[place] for place in order], width)
    axes.set_xlim(WITHIN)
    if not np.isfinite(one.total).any():
        say(axes, "no variance to be shared")
        return
    for shift, color, values, low, high, label in (
        (-HEIGHT / 2, style.PALETTE[0], one.first, one.first_low, one.first_high, "first order"),
        (HEIGHT / 2, style.PALETTE[1], one.total, one.total_low, one.total_high, "total"),
    ):
        places = [place + shift for place in range(len(order))]
        axes.barh(places, values[order], height=HEIGHT, color=color, label=label)
        axes.hlines(places, low[order], high[order], color=style.INK, linewidth=1.0)
    axes.axvline(0, color=style.MUTED, linewidth=0.8)

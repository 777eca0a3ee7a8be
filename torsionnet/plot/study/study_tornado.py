"""Tornado plot of a study, with the effect of each parameter alone on the quantities."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.number_text import screen_text, typeset_unit, unit_in_brackets
from torsionnet.plot.drawing.bars import Bars, draw_bars, fills_a_page
from torsionnet.plot.study.parameter_matrix import ColourScale, parameter_matrix
from torsionnet.plot.study.study_axes import (
    EQUAL_VALUES,
    axis_label,
    bars_legend,
    panel_title,
    parameter_rows,
    study_bars,
    write_in_empty_panel,
)
from torsionnet.study.shown_units import IN_SI, ShownUnits

if TYPE_CHECKING:
    from torsionnet.study.answers.tornado_answer import Swings, TornadoResult

MOST_PARAMETERS = 12
"""Largest number of parameters in a panel, those with the widest bars."""


def study_tornado(result: TornadoResult, *, units: ShownUnits = IN_SI, title: str | None = None) -> Figure:
    """Figure of bars from a quantity's value at the low end of each parameter to that at its high end, widest on top.

    Parameters
    ----------
    result : TornadoResult
        Result of the answer ``tornado`` of a study.
    units : ShownUnits, optional
        By default SI.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    quantities, cases = list(result.units), list(result.spans)
    names = list(result.parameter_units)
    pairs = [(case, quantity) for quantity in quantities for case in cases]
    if fills_a_page(len(pairs), min(MOST_PARAMETERS, len(names))):
        figure = _matrix(result, units)
        style.set_title(figure, result.title if title is None else title)
        return figure
    figure, panels, width = study_bars(len(pairs), min(MOST_PARAMETERS, len(names)), names)
    for axes, (case, quantity) in zip(panels, pairs, strict=True):
        scale, unit = units.scale(quantity, result.units[quantity]), units.unit(quantity, result.units[quantity])
        one = result.swings[case, quantity]
        _bars(axes, one, list(result.spans[case]), scale, width)
        axes.set_xlabel(axis_label(quantity, unit, width))
        middle = "" if np.isnan(one.middle) else f"{screen_text(one.middle * scale, 4)} in the middle"
        told = [*([case] if len(cases) > 1 else []), *([middle] if middle else [])]
        panel_title(axes, ": ".join(told), width - 0.4)
    bars_legend(figure, panels)
    style.set_title(figure, result.title if title is None else title)
    return figure


def _matrix(result: TornadoResult, units: ShownUnits) -> Figure:
    """Figure of quantities' changes from low to high end of parameters in colours, parameters by configurations.

    It stands for bars if there were too many panels.
    """
    names, cases = list(result.parameter_units), list(result.spans)
    changes, scales = {}, {}
    for quantity, si in result.units.items():
        swings = [result.swings[case, quantity] for case in cases]
        changes[quantity] = units.scale(quantity, si) * np.column_stack([one.at_high - one.at_low for one in swings])
        most = float(np.abs(np.nan_to_num(changes[quantity])).max()) or 1.0
        label = f"change from low to high end {unit_in_brackets(typeset_unit(units.unit(quantity, si)))}".rstrip()
        scales[quantity] = ColourScale(label, "RdBu_r", -most, most)
    return parameter_matrix(changes, names, cases, scales)


def _bars(axes: Axes, one: Swings, names: list[str], scale: float, width: float) -> None:
    shown = one.order[:MOST_PARAMETERS]
    style.style_axes(axes)
    parameter_rows(axes, [names[place] for place in shown], width)
    ends = np.array([one.at_low[shown], one.at_high[shown]])
    if not (np.abs(ends - one.middle) > EQUAL_VALUES * abs(one.middle)).any():
        write_in_empty_panel(axes, "no value" if np.isnan(one.middle) else "moved by no parameter")
        axes.set_xticks([])
        return
    low, high = (ends - one.middle) * scale
    bars = [
        Bars(low, style.PALETTE[5], "parameter at its low end", one.middle * scale, alpha=0.9),
        Bars(high, style.PALETTE[1], "at its high end", one.middle * scale, alpha=0.9),
    ]
    draw_bars(axes, len(shown), bars, line=style.INK, width=0.9)
    axes.locator_params(axis="x", nbins=4)

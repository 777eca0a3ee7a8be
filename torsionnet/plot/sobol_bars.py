"""Sobol indices as bars with their intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

import torsionnet.plot.style as style
from torsionnet.plot.study_axes import key, titled

if TYPE_CHECKING:
    from torsionnet.study.answers.sobol_indices import SobolFound

HEIGHT = 0.36


def sobol_indices(found: SobolFound, *, title: str | None = None) -> Figure:
    """First-order and total index of every parameter, the largest on top; a panel for each quantity and configuration.

    Parameters
    ----------
    found : SobolFound
        What the answer ``sobol_indices`` of a study found.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    quantities = list(dict.fromkeys(name for _, name in found.indices))
    cases = list(dict.fromkeys(case for case, _ in found.indices))
    height = 0.9 + len(quantities) * (0.6 + 0.36 * len(found.parameters))
    figure = style.new_figure(style.WIDTH, height)
    panels = figure.subplots(len(quantities), len(cases), squeeze=False, sharex=True)
    for row, quantity in zip(panels, quantities, strict=True):
        for axes, case in zip(row, cases, strict=True):
            one = found.indices[case, quantity]
            order = np.argsort(-one.total, kind="stable").tolist()
            for shift, color, values, low, high, label in (
                (-HEIGHT / 2, style.PALETTE[0], one.first, one.first_low, one.first_high, "first order"),
                (HEIGHT / 2, style.PALETTE[1], one.total, one.total_low, one.total_high, "total"),
            ):
                places = [place + shift for place in range(len(order))]
                axes.barh(places, values[order], height=HEIGHT, color=color, label=label)
                axes.hlines(places, low[order], high[order], color=style.INK, linewidth=1.0)
            style.dress(axes)
            axes.axvline(0, color=style.MUTED, linewidth=0.8)
            axes.set_yticks(range(len(order)), [found.parameters[place] for place in order])
            axes.invert_yaxis()
            titled(axes, f"{quantity}, {case}" if len(cases) > 1 else quantity)
    for axes in panels[-1]:
        axes.set_xlabel(f"share of the variance [-], {100 * found.confidence:g} % intervals")
    key(panels[0][-1])
    style.heading(figure, found.title if title is None else title)
    return figure

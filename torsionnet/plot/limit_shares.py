"""Values of quantities over their limits, and the shares beyond."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.style as style
from torsionnet.plot.study_axes import BEYOND, axis_label, key

if TYPE_CHECKING:
    from torsionnet.study.answers.limited_values import LimitedValues
    from torsionnet.study.answers.yield_found import YieldFound

ROOM = 0.05
MOST_AWAY = 1.0
"""Of the width of all values: a limit farther off than this is only told of."""


def limit_shares(found: YieldFound, *, title: str | None = None) -> Figure:
    """How the variants of each configuration lie about every limit; what is beyond is shaded.

    Parameters
    ----------
    found : YieldFound
        What the answer ``yield`` of a study found.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    names = list(dict.fromkeys(one.quantity for one in found.distributions))
    figure = style.new_figure(style.WIDTH, 0.8 + 2.4 * len(names))
    panels = figure.subplots(len(names), 1, squeeze=False)[:, 0]
    for axes, name in zip(panels, names, strict=True):
        _panel(axes, found, [one for one in found.distributions if one.quantity == name])
    style.heading(figure, found.title if title is None else title)
    return figure


def _panel(axes: Axes, found: YieldFound, distributions: list[LimitedValues]) -> None:
    first = distributions[0]
    for number, one in enumerate(distributions):
        share = next(
            (each.share for each in found.shares
             if each.configuration == one.configuration and each.limit.startswith(f"{one.quantity} ")), None,
        )  # fmt: skip
        beyond = "" if share is None else f": {share.percent} beyond"
        density = one.counts / max(one.counts.sum(), 1) * 100
        axes.stairs(density, one.edges, label=f"{one.configuration}{beyond}", **style.line_style(number))
    low = min(one.edges[0] for one in distributions)
    high = max(one.edges[-1] for one in distributions)
    limits = [side for side in (first.above, first.below) if side is not None]
    near = [side for side in limits if low - MOST_AWAY * (high - low) <= side <= high + MOST_AWAY * (high - low)]
    low, high = min([low, *near]), max([high, *near])
    axes.set_xlim(low - ROOM * (high - low), high + ROOM * (high - low))
    for side, end in ((first.above, 0), (first.below, 1)):
        if side in near and side is not None:
            axes.axvline(side, color=BEYOND, linewidth=1.4)
            axes.axvspan(*np.sort([side, axes.get_xlim()[end]]), color=BEYOND, alpha=0.08, linewidth=0)
    style.dress(axes)
    axes.set_ylim(bottom=0)
    axes.set_ylabel("variants [% per bin]")
    axes.set_xlabel(axis_label(first.quantity, first.unit))
    key(axes)

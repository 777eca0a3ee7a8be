"""What each parameter alone does to the quantities of a study."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.style as style
from torsionnet.core.number_text import on_screen, typeset_unit
from torsionnet.plot.study_axes import axis_label, key, titled

if TYPE_CHECKING:
    from torsionnet.study.answers.one_at_a_time import Swings
    from torsionnet.study.answers.tornado_of_study import TornadoFound

MOST_PARAMETERS = 12


def study_tornado(found: TornadoFound, *, title: str | None = None) -> Figure:
    """Bars from the value at the low end of each parameter to that at its high end, the widest on top.

    Parameters
    ----------
    found : TornadoFound
        What the answer ``tornado`` of a study found.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    quantities, cases = list(found.units), list(found.spans)
    rows = min(MOST_PARAMETERS, len(found.parameter_units))
    figure = style.new_figure(max(style.WIDTH, 2.6 * len(cases)), 0.9 + len(quantities) * (0.9 + 0.3 * rows))
    panels = figure.subplots(len(quantities), len(cases), squeeze=False)
    for row, quantity in zip(panels, quantities, strict=True):
        for axes, case in zip(row, cases, strict=True):
            names = list(found.spans[case])
            _bars(axes, found.swings[case, quantity], names)
            axes.set_xlabel(axis_label(quantity, found.units[quantity]))
            middle = (
                f"{on_screen(found.swings[case, quantity].middle, 4)} {typeset_unit(found.units[quantity])}".rstrip()
            )
            titled(axes, f"{case}: {middle} in the middle" if len(cases) > 1 else f"{middle} in the middle")
    key(panels[0][0])
    style.heading(figure, found.title if title is None else title)
    return figure


def _bars(axes: Axes, one: Swings, names: list[str]) -> None:
    shown = one.order[:MOST_PARAMETERS]
    for values, color, label in (
        (one.at_low, style.PALETTE[5], "low end"),
        (one.at_high, style.PALETTE[1], "high end"),
    ):
        widths = values[shown] - one.middle
        axes.barh(range(len(shown)), widths, left=one.middle, color=color, height=0.7, alpha=0.9, label=label)
    axes.axvline(one.middle, color=style.INK, linewidth=0.9)
    axes.set_yticks(range(len(shown)), [names[place] for place in shown])
    axes.invert_yaxis()
    style.dress(axes)
    axes.locator_params(axis="x", nbins=5)

"""Worst cases: how far the quantity goes, and where the parameters are then."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.style as style
from torsionnet.core.number_text import on_screen
from torsionnet.plot.study_axes import axis_label, key

if TYPE_CHECKING:
    from torsionnet.study.answers.worst_case_found import WorstCaseFound, WorstVariant

COLORS = {"largest": style.PALETTE[1], "smallest": style.PALETTE[0]}


def worst_variants(found: WorstCaseFound, *, title: str | None = None) -> Figure:
    """Left the value as given and the worst; right each parameter between the bounds of its tolerance.

    Parameters
    ----------
    found : WorstCaseFound
        What the answer ``worst_case`` of a study found.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    cases = list(dict.fromkeys(one.configuration for one in found.variants))
    names = list(found.parameter_units)
    figure = style.new_figure(style.WIDTH, 1.1 + len(cases) * (0.5 + 0.26 * len(names)))
    panels = figure.subplots(len(cases), 2, squeeze=False, sharex="col")
    for row, case in zip(panels, cases, strict=True):
        here = [one for one in found.variants if one.configuration == case]
        _values(row[0], here, case)
        _places(row[1], here, names)
    panels[-1][0].set_xlabel(axis_label(found.quantity, found.unit))
    panels[-1][1].set_xlabel("within the tolerance")
    panels[-1][1].set_xticks([0, 0.5, 1], ["lower", "middle", "upper"])
    key(panels[0][0])
    style.heading(figure, found.title if title is None else title)
    return figure


def _values(axes: Axes, here: list[WorstVariant], case: str) -> None:
    axes.axvline(here[0].nominal, color=style.MUTED, linewidth=1.0, label="as given")
    for one in here:
        axes.barh(0, one.value - one.nominal, left=one.nominal, height=0.5, color=COLORS[one.direction],
                  label=one.direction)  # fmt: skip
        axes.annotate(
            on_screen(one.value, 4), (one.value, 0.3), ha="center", va="bottom", fontsize=style.SMALL, color=style.INK
        )
    axes.set_yticks([0], [case])
    axes.set_ylim(-0.6, 0.9)
    axes.margins(x=0.15)
    style.dress(axes)


def _places(axes: Axes, here: list[WorstVariant], names: list[str]) -> None:
    for one in here:
        shares = [
            (one.variant[name] - low) / (high - low) if high > low else 0.5
            for name in names
            for low, high in [one.tolerance[name]]
        ]
        axes.plot(shares, range(len(names)), "^" if one.direction == "largest" else "v", color=COLORS[one.direction],
                  markersize=7, clip_on=False)  # fmt: skip
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.set_xlim(-0.03, 1.03)
    style.dress(axes)

"""Plot of small probabilities of failure with their confidence intervals, a row for each configuration."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.number_text import typeset_unit
from torsionnet.plot.study.study_axes import BEYOND_COLOR, log_axis, text_rows
from torsionnet.study.shown_units import IN_SI, ShownUnits

if TYPE_CHECKING:
    from torsionnet.study.answers.failure_probability import FailureProbabilityResult
    from torsionnet.study.answers.rare_event import RareEvent

LEAST_LOG_RATIO = 4.0
"""Ratio of the upper to the lower end of an axis below which it stays linear, as a log scale would hardly have a
number."""


def failure_probabilities(
    result: FailureProbabilityResult, *, units: ShownUnits = IN_SI, title: str | None = None
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

    Returns
    -------
    matplotlib.figure.Figure
    """
    del units
    events = list(result.events.items())
    ends = [
        side for _, one in events for side in (one.low, one.high, one.probability) if np.isfinite(side) and side > 0
    ]
    figure = style.new_figure(style.WIDTH, 1.3 + 0.34 * len(events))
    axes = figure.subplots()
    style.style_axes(axes)
    for place, (_, one) in enumerate(events):
        _drawn_probabilities(axes, place, one)
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
    style.set_title(figure, result.title if title is None else title)
    return figure


def _drawn_probabilities(axes: Axes, place: int, one: RareEvent) -> None:
    color = BEYOND_COLOR if one.doubts else style.PALETTE[0]
    if np.isfinite(one.low):
        axes.hlines(place, one.low, one.high, color=color, linewidth=2.0)
    if one.probability:
        axes.plot(one.probability, place, "o", color=color, markerfacecolor=style.PAPER if one.doubts else color)
    else:
        axes.text(
            0.02, place, "no failure was met", transform=axes.get_yaxis_transform(), fontsize=style.SMALL,
            color=style.MUTED, va="center",
        )  # fmt: skip

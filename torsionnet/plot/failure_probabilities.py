"""Small probabilities with their intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

import torsionnet.plot.style as style
from torsionnet.core.errors import UsageError
from torsionnet.core.number_text import typeset_unit
from torsionnet.plot.study_axes import BEYOND

if TYPE_CHECKING:
    from torsionnet.study.answers.failure_probability import FailureFound


def failure_probabilities(found: FailureFound, *, title: str | None = None) -> Figure:
    """Probability that a limit is not kept in each configuration; hollow where it is not to be trusted.

    Parameters
    ----------
    found : FailureFound
        What the answer ``failure_probability`` of a study found.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        No failure was met in any configuration.
    """
    events = list(found.events.items())
    known = [one.probability for _, one in events if one.probability > 0]
    if not known:
        raise UsageError("no failure was met; there is no probability to draw")
    figure = style.new_figure(style.WIDTH, 1.1 + 0.34 * len(events))
    axes = figure.subplots()
    for place, (_, one) in enumerate(events):
        color = BEYOND if one.doubts else style.PALETTE[0]
        if np.isfinite(one.low):
            axes.hlines(place, one.low, one.high, color=color, linewidth=2.0)
        if one.probability:
            axes.plot(one.probability, place, "o", color=color, markerfacecolor=style.PAPER if one.doubts else color)
        else:
            axes.text(min(known), place, "none met", fontsize=style.SMALL, color=style.MUTED, va="center")
    ends = [
        side for _, one in events for side in (one.low, one.high, one.probability) if np.isfinite(side) and side > 0
    ]
    axes.set_xscale("log")
    axes.set_xlim(min(ends) / 1.5, max(ends) * 1.5)
    style.log_ticks(axes.xaxis, min(ends) / 1.5, max(ends) * 1.5)
    axes.set_yticks(range(len(events)), [case for case, _ in events])
    axes.set_ylim(len(events) - 0.5, -0.5)
    axes.set_xlabel(f"probability of {typeset_unit(found.beyond)} [-], {100 * found.confidence:g} % interval")
    style.dress(axes)
    style.heading(figure, found.title if title is None else title)
    return figure

"""Percentiles of curves over frequency or speed as bands."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.style as style
from torsionnet.core.units import RPM
from torsionnet.plot.study_axes import axis_label, key, titled

if TYPE_CHECKING:
    from torsionnet.study.answers.percentile_bands_of_study import BandsFound

WIDE = 10
"""Ratio of the largest to the smallest value, or point, from which an axis has equal factors."""


def percentile_bands(found: BandsFound, *, title: str | None = None) -> Figure:
    """The outer percentiles as bands, one within the other, the middle one as a line; a panel for each configuration.

    Parameters
    ----------
    found : BandsFound
        What the answer ``percentile_bands`` of a study found.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = style.new_figure(style.WIDTH, 0.8 + 2.3 * len(found.lines))
    panels = figure.subplots(len(found.lines), 1, squeeze=False, sharex=True, sharey=True)[:, 0]
    over_speed = found.measure.over == "speed"
    points = found.measure.points / RPM if over_speed else found.measure.points
    for axes, (case, lines) in zip(panels, found.lines.items(), strict=True):
        _bands(axes, points, lines, found.percentiles)
        if len(found.lines) > 1:
            titled(axes, case)
        axes.set_ylabel(axis_label(found.quantity, found.measure.unit))
    every = np.concatenate([lines.ravel() for lines in found.lines.values()])
    known = every[np.isfinite(every)]
    if len(known) and known.min() > 0 and known.max() > WIDE * known.min():
        panels[0].set_yscale("log")
        for axes in panels:
            style.log_ticks(axes.yaxis, known.min(), known.max())
    if points[0] > 0 and points[-1] > WIDE * points[0]:
        panels[0].set_xscale("log")
        style.log_ticks(panels[-1].xaxis, points[0], points[-1])
    panels[-1].set_xlim(points[0], points[-1])
    panels[-1].set_xlabel("speed [r/min]" if over_speed else "frequency [Hz]")
    key(panels[0])
    style.heading(figure, found.title if title is None else title)
    return figure


def _bands(axes: Axes, points: np.ndarray, lines: np.ndarray, shares: tuple[float, ...]) -> None:
    pairs = len(shares) // 2
    for pair in range(pairs):
        label = f"{shares[pair]:g} to {shares[-1 - pair]:g} %"
        alpha = 0.18 + 0.3 * pair / max(pairs - 1, 1)
        axes.fill_between(
            points, lines[pair], lines[-1 - pair], color=style.PALETTE[0], alpha=alpha, linewidth=0, label=label
        )
    if len(shares) % 2:
        axes.plot(points, lines[pairs], color=style.PALETTE[0], linewidth=1.6, label=f"{shares[pairs]:g} %")
    style.dress(axes)

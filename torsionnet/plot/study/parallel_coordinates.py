"""Plot of variants in parallel coordinates, as lines across an axis for each parameter and quantity."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import torsionnet.plot.drawing.style as style
from torsionnet.base.number_text import screen_text
from torsionnet.plot.study.study_axes import (
    BEYOND_COLOR,
    WITHIN_COLOR,
    axis_ends,
    axis_label,
    finite_values,
    is_wide,
    legend_below,
    panel_title,
    write_in_empty_panel,
)
from torsionnet.study.shown_units import IN_SI, ShownUnits

if TYPE_CHECKING:
    from torsionnet.linear.frequency_response import FloatArray
    from torsionnet.study.answers.parallel_coordinates_answer import ParallelCoordinatesResult

WIDE_AXIS = 100.0
"""Ratio of the largest to the smallest value from which an axis is logarithmic."""
TITLE_PAD = 15.0
"""Distance in points between the axes and a title, room for the values at the upper ends of the axes."""
AXIS_DISTANCE, TALL_PANEL, LOW_PANEL, MOST_TALL = 0.95, 2.6, 1.5, 4
"""Distance of axes, height of a tall and of a low panel, in inches, and largest number of configurations with tall
ones."""


def parallel_coordinates(
    result: ParallelCoordinatesResult, *, units: ShownUnits = IN_SI, title: str | None = None
) -> Figure:
    """Figure of variants as lines across parallel axes of parameters and quantities, those beyond a limit in red.

    Each configuration has a panel; the ends of an axis are the extreme values in all configurations.

    Parameters
    ----------
    result : ParallelCoordinatesResult
        Result of the answer ``parallel_coordinates`` of a study.
    units : ShownUnits, optional
        By default SI.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    names = list(result.units)
    scales = {name: units.scale(name, si) for name, si in result.units.items()}
    every = {name: scales[name] * finite_values(one[name] for one in result.variants.values()) for name in names}
    width = max(style.WIDTH, AXIS_DISTANCE * len(names))
    height = TALL_PANEL if len(result.variants) <= MOST_TALL else LOW_PANEL
    figure = style.new_figure(width, 1.2 + height * len(result.variants))
    panels = figure.subplots(len(result.variants), 1, squeeze=False)[:, 0]
    for axes, (case, columns) in zip(panels, result.variants.items(), strict=True):
        shares = np.column_stack([_shares(columns[name] * scales[name], every[name]) for name in names])
        _lines(axes, shares, result.beyond[case])
        _scales(axes, [axis_ends(every[name]) if len(every[name]) else None for name in names])
        if not np.isfinite(shares).any():
            write_in_empty_panel(axes, "no variant has a value")
        labels = [axis_label(name, units.unit(name, result.units[name]), width / len(names) - 0.1) for name in names]
        axes.set_xticks(range(len(names)), labels if axes is panels[-1] else [""] * len(names))
        axes.tick_params(axis="x", labelsize=style.SMALL, length=0, pad=14)
        if len(result.variants) > 1:
            panel_title(axes, case, width, pad=TITLE_PAD)
    if any(outside.any() for outside in result.beyond.values()):
        handles = [Line2D([], [], color=color) for color in (WITHIN_COLOR, BEYOND_COLOR)]
        legend_below(figure, handles, ["within limits", "beyond a limit"])
    style.set_title(figure, result.title if title is None else title)
    return figure


def _shares(values: FloatArray, every: FloatArray) -> FloatArray:
    """Heights of values on one of the parallel axes, from 0 at its lower to 1 at its upper end, in the values' shape.

    Logarithmic if values are decades apart.
    """
    low, high = axis_ends(every)
    if is_wide(every, WIDE_AXIS):
        return np.asarray(np.log(values / low) / np.log(high / low))
    return (values - low) / (high - low)


def _lines(axes: Axes, shares: FloatArray, beyond: np.ndarray) -> None:
    places = np.arange(shares.shape[1])
    for which, color in ((~beyond, WITHIN_COLOR), (beyond, BEYOND_COLOR)):
        segments = [np.column_stack([places, row]) for row in shares[which]]
        alpha = min(0.7, 0.1 + 20 / max(len(segments), 1))
        axes.add_collection(LineCollection(segments, colors=color, alpha=alpha, linewidths=0.7, rasterized=True))
    axes.set_xlim(-0.3, len(places) - 0.7)
    axes.set_ylim(0, 1)


def _scales(axes: Axes, ends: list[tuple[float, float] | None]) -> None:
    """Draw the parallel axes as vertical lines with the values at both ends."""
    for place, pair in enumerate(ends):
        axes.axvline(place, color=style.INK, linewidth=0.9)
        texts = ("no values", "") if pair is None else tuple(screen_text(value, 4) for value in pair)
        for height, text, side in ((0, texts[0], "top"), (1, texts[1], "bottom")):
            axes.annotate(
                text, (place, height), xytext=(0, -3 if height == 0 else 3), textcoords="offset points",
                ha="center", va=side, fontsize=style.SMALL, color=style.MUTED, annotation_clip=False,
            )  # fmt: skip
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)

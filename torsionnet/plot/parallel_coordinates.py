"""Variants as lines across axes, those beyond a limit in red."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import torsionnet.plot.style as style
from torsionnet.core.number_text import on_screen
from torsionnet.plot.study_axes import BEYOND, WITHIN, axis_label, titled

if TYPE_CHECKING:
    from torsionnet.study.answers.parallel_coordinates_of_study import ParallelFound


def parallel_coordinates(found: ParallelFound, *, title: str | None = None) -> Figure:
    """An axis for every parameter and quantity, over its values in all configurations; a panel for each of these.

    Parameters
    ----------
    found : ParallelFound
        What the answer ``parallel_coordinates`` of a study found.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    names = list(found.units)
    ends = {name: _ends(found, name) for name in names}
    figure = style.new_figure(max(style.WIDTH, 0.9 * len(names)), 0.9 + 2.6 * len(found.variants))
    panels = figure.subplots(len(found.variants), 1, squeeze=False)[:, 0]
    for axes, (case, columns) in zip(panels, found.variants.items(), strict=True):
        shares = np.column_stack([(columns[name] - ends[name][0]) / (ends[name][1] - ends[name][0]) for name in names])
        _lines(axes, shares, found.beyond[case])
        _scales(axes, ends)
        axes.set_xticks(range(len(names)), [axis_label(name, found.units[name]) for name in names])
        axes.tick_params(axis="x", labelsize=style.SMALL, length=0, pad=14)
        if len(found.variants) > 1:
            titled(axes, case)
    handles = [
        Line2D([], [], color=WITHIN, label="within limits"),
        Line2D([], [], color=BEYOND, label="beyond a limit"),
    ]
    if any(outside.any() for outside in found.beyond.values()):
        figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=style.SMALL, frameon=False)
    style.heading(figure, found.title if title is None else title)
    return figure


def _ends(found: ParallelFound, name: str) -> tuple[float, float]:
    every = np.concatenate([columns[name] for columns in found.variants.values()])
    known = every[np.isfinite(every)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    return (low, high) if high > low else (low - 0.5 * (abs(low) or 1.0), high + 0.5 * (abs(high) or 1.0))


def _lines(axes: Axes, shares: np.ndarray, beyond: np.ndarray) -> None:
    places = np.arange(shares.shape[1])
    for which, color in ((~beyond, WITHIN), (beyond, BEYOND)):
        segments = [np.column_stack([places, row]) for row in shares[which]]
        alpha = min(0.7, 0.1 + 20 / max(len(segments), 1))
        axes.add_collection(LineCollection(segments, colors=color, alpha=alpha, linewidths=0.7, rasterized=True))
    axes.set_xlim(-0.3, len(places) - 0.7)
    axes.set_ylim(0, 1)


def _scales(axes: Axes, ends: dict[str, tuple[float, float]]) -> None:
    """Each axis with the values at its ends."""
    for place, (low, high) in enumerate(ends.values()):
        axes.axvline(place, color=style.INK, linewidth=0.9)
        for height, value, side in ((0, low, "top"), (1, high, "bottom")):
            axes.annotate(
                on_screen(value, 5), (place, height), xytext=(0, -3 if height == 0 else 3), textcoords="offset points",
                ha="center", va=side, fontsize=style.SMALL, color=style.MUTED, annotation_clip=False,
            )  # fmt: skip
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)

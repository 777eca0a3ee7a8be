"""Panels of horizontal bars, one below the other with names beside them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

import torsionnet.plot.drawing.style as style

BARS, ROW = 1.5, 0.26
"""Inches that bars take to the right of their names, and one below the other."""
FEW_PANELS, MOST_BARS = 6, 100


@dataclass(frozen=True)
class Bars:
    """A bar in every row: how long, where each begins, how thick in rows, how far below the middle of its row."""

    lengths: ArrayLike
    color: str
    label: str = ""
    start: float = 0.0
    height: float = 0.7
    below: float = 0.0
    alpha: float | None = None
    intervals: tuple[ArrayLike, ArrayLike] | None = None
    """Lower and upper ends of the lines drawn over the bars."""


def draw_bars(axes: Axes, rows: int, bars: Sequence[Bars], *, line: str = style.MUTED, width: float = 0.8) -> None:
    """Bars in so many rows, and the line they begin at."""
    for one in bars:
        places = [row + one.below for row in range(rows)]
        axes.barh(
            places, one.lengths, left=one.start, height=one.height, color=one.color, alpha=one.alpha,
            label=one.label or None,
        )  # fmt: skip
        if one.intervals is not None:
            axes.hlines(places, *one.intervals, color=style.INK, linewidth=1.0)
    axes.axvline(bars[0].start, color=line, linewidth=width)


def name_rows(axes: Axes, names: Sequence[str]) -> None:
    """Names beside the rows, the first on top."""
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(max(len(names), 1) - 0.4, -0.6)


def takes_a_page(count: int, rows: int) -> bool:
    """Whether so many panels of bars are more than one looks at."""
    return count > FEW_PANELS and count * (rows + 2) > MOST_BARS


def bar_panels(count: int, rows: int, longest: float) -> tuple[Figure, list[Axes], float]:
    """Panels of horizontal bars with names beside them, as many in a row as leave room for both.

    Parameters
    ----------
    count, rows : int
        Panels, and bars in each.
    longest : float
        Inches of the longest name.

    Returns
    -------
    figure, panels : Figure, list of Axes
    width : float
        Of a panel with its names, in inches.
    """
    columns = style.panel_columns(count, max(1, int(style.WIDTH / (BARS + min(longest, style.WIDTH / 3)))))
    lines = math.ceil(count / columns)
    figure = style.new_figure(style.WIDTH, 0.9 + lines * (0.8 + ROW * max(rows, 2)))
    grid = figure.subplots(lines, columns, squeeze=False).ravel()
    for axes in grid[count:]:
        axes.remove()
    return figure, grid[:count].tolist(), style.WIDTH / columns

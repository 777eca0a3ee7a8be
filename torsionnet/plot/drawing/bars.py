"""Panels with horizontal bars one below the other, and the names of their rows beside them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

import torsionnet.plot.drawing.style as style

BARS, ROW = 1.5, 0.26
"""Width in inches of the bars of a panel beside their names, and height in inches of a row."""
FEW_PANELS, MOST_BARS = 6, 100
"""Number of panels up to which they always make one picture, and number of rows of bars up to which more panels do:
about one page."""


@dataclass(frozen=True)
class Bars:
    """Bars of one colour, one in every row, with lengths and start in units of the axis, height and offset in rows."""

    lengths: ArrayLike
    color: str
    label: str = ""
    start: float = 0.0
    height: float = 0.7
    below: float = 0.0
    alpha: float | None = None
    intervals: tuple[ArrayLike, ArrayLike] | None = None
    """Arrays of the lower and of the upper ends, in units of the axis, of the interval lines drawn over the bars."""


def draw_bars(axes: Axes, rows: int, bars: Sequence[Bars], *, line: str = style.MUTED, width: float = 0.8) -> None:
    """Draw bars in ``rows`` rows of the axes, and a vertical line at which the bars begin."""
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
    """Write names beside the rows of bars of a panel, the first name on top."""
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(max(len(names), 1) - 0.4, -0.6)


def fills_a_page(count: int, rows: int) -> bool:
    """Whether ``count`` panels of ``rows`` bars are more than can be read as one picture."""
    return count > FEW_PANELS and count * (rows + 2) > MOST_BARS


def bar_panels(count: int, rows: int, longest: float) -> tuple[Figure, list[Axes], float]:
    """Figure, list of its panels for horizontal bars, and width in inches of a panel with the names of its bars.

    As many panels stand side by side as leave room for bars and names.

    Parameters
    ----------
    count, rows : int
        Number of panels, and of bars in each.
    longest : float
        Width of the longest name in inches.

    Returns
    -------
    figure, panels : Figure, list of Axes
    width : float
        Width in inches of a panel with its names.
    """
    columns = style.panel_columns(count, max(1, int(style.WIDTH / (BARS + min(longest, style.WIDTH / 3)))))
    lines = math.ceil(count / columns)
    figure = style.new_figure(style.WIDTH, 0.9 + lines * (0.8 + ROW * max(rows, 2)))
    grid = figure.subplots(lines, columns, squeeze=False).ravel()
    for axes in grid[count:]:
        axes.remove()
    return figure, grid[:count].tolist(), style.WIDTH / columns

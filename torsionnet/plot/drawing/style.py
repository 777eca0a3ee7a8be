"""Style of all pictures, with the palette, dashes of lines, sizes of texts, and ticks of axes.

Matplotlib's global settings are left alone.
"""

from __future__ import annotations

import io
import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, MultipleLocator, NullFormatter
from numpy.typing import ArrayLike

import torsionnet.plot.drawing.pieces as colors
from torsionnet.base.packages import DOTS_PER_INCH
from torsionnet.linear.assembly.rows import FloatArray

PALETTE = colors.PALETTE
DASHES: tuple[Any, ...] = ("-", (0, (6, 2)), (0, (2, 1.5)), (0, (7, 2, 1.5, 2)), (0, (7, 2, 1.5, 2, 1.5, 2)))
LIMIT_COLOR = "#B00020"
"""Red, as a hexadecimal code, that is kept for limits, so that no curve has it."""
INK, MUTED, FAINT, PAPER = colors.INK, colors.MUTED, colors.FAINT, colors.PAPER
FONT, SMALL, TITLE = 9.0, 8.0, 11.0
WIDTH = 7.2
"""Width of a figure in inches: the text width of a page."""

STYLE: dict[str, Any] = {
    "figure.figsize": (WIDTH, 4.0), "figure.constrained_layout.use": True, "figure.facecolor": PAPER,
    "axes.prop_cycle": cycler(color=PALETTE[: len(DASHES)], linestyle=DASHES), "lines.linewidth": 1.6,
    "axes.grid": True, "grid.color": FAINT, "grid.linewidth": 0.7, "axes.axisbelow": True,
    "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": MUTED,
    "axes.labelsize": FONT, "axes.labelcolor": INK, "axes.titlesize": FONT, "axes.titlecolor": INK,
    "xtick.labelsize": SMALL, "ytick.labelsize": SMALL, "xtick.color": MUTED, "ytick.color": MUTED,
    "xtick.labelcolor": INK, "ytick.labelcolor": INK, "legend.frameon": False, "legend.fontsize": SMALL,
}  # fmt: skip
"""Settings of matplotlib by name, with the style of the pictures, for a user's own figures:
``plt.style.use(plot.STYLE)``."""

FEW_DECADES = 2.5
"""Number of decades of a log axis below which the axis has ticks at 1, 2 and 5 times powers of ten; over more they
would overlap."""
FEW_PHASES, MANY_PHASES = 270, 900
"""Ranges of phase in degrees up to which an axis has ticks every 45, and every 90 degrees; beyond, every 180."""


WIDEST_TITLE = 84
"""Largest number of characters in a line of a figure's title: as many as fit the width of a figure."""


def panel_columns(count: int, most: int = 4) -> int:
    """Number of columns in which ``count`` panels stand on a page: 1, 2, 3 up to nine panels, then 4."""
    return min(most, next(columns for columns, up_to in ((1, 1), (2, 4), (3, 9), (4, math.inf)) if count <= up_to))


class NotebookFigure(Figure):
    """Figure of matplotlib that a notebook shows by itself, without pyplot and ``%matplotlib inline``."""

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=DOTS_PER_INCH)
        return buffer.getvalue()


def new_figure(width: float, height: float) -> Figure:
    """Empty figure, in no window, of a width and height in inches, with matplotlib's constrained layout."""
    return NotebookFigure(figsize=(width, height), layout="constrained", facecolor=PAPER)


def bare_figure(width: float, height: float) -> Figure:
    """Empty figure of a width and height in inches without a layout engine.

    Axes stay where they are put, whatever a user's settings.
    """
    figure = NotebookFigure(figsize=(width, height), facecolor=PAPER)
    figure.set_layout_engine("none")
    return figure


def one_panel(height: float) -> tuple[Figure, Axes]:
    """Figure of the usual width and a height in inches with one panel in the common style, and this panel."""
    figure, (panel,) = stacked_panels(height, [1])
    return figure, panel


def stacked_panels(height: float, shares: Sequence[float]) -> tuple[Figure, list[Axes]]:
    """Figure of the usual width with panels in the common style one below the other, and the panels from top to bottom.

    Their horizontal axis is the same; ``shares`` are their heights in parts of the figure's, which is in inches.
    """
    figure = new_figure(WIDTH, height)
    panels = figure.subplots(len(shares), 1, sharex=True, squeeze=False, gridspec_kw={"height_ratios": shares})[:, 0]
    for panel in panels:
        style_axes(panel)
    return figure, panels.tolist()


def legend_beside(axes: Axes) -> None:
    """Draw the legend of the axes to their right."""
    axes.legend(fontsize=SMALL, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def legend_below(figure: Figure, columns: int, *entries: Sequence[Any], **look: Any) -> None:
    """Draw the legend of a figure below its panels: of all that has a label, or of handles and their names."""
    figure.legend(*entries, loc="outside lower center", ncols=columns, frameon=False, fontsize=SMALL, **look)


def line_style(index: int) -> dict[str, Any]:
    """Colour, dashes and width of a curve by its number, as keyword arguments of matplotlib.

    Colour and dashes both change, so that a print in grey can be read.
    """
    styles = [(PALETTE[i % len(PALETTE)], DASHES[(i + i // len(PALETTE)) % len(DASHES)]) for i in range(35)]
    color, dashes = styles[index % len(styles)]
    return {"color": color, "linestyle": dashes, "linewidth": 1.6}


def paired_style(first: int, second: int, sizes: tuple[int, int]) -> dict[str, Any]:
    """Keyword arguments of matplotlib for a curve with two numbers, one for its colour, the other for its dashes.

    The first number is for the colour and the second for the dashes, or they are exchanged.

    ``sizes`` are the counts of both. They are exchanged if there are too few dashes; if one count is 1, colour and
    dashes change together.

    >>> one, other = paired_style(0, 0, (2, 3)), paired_style(0, 1, (2, 3))
    >>> one["color"] == other["color"], one["linestyle"] == other["linestyle"]
    (True, False)
    """
    if min(sizes) == 1:
        return line_style(max(first, second))
    if sizes[1] > len(DASHES) >= sizes[0]:
        first, second, sizes = second, first, (sizes[1], sizes[0])
    if sizes[0] > len(PALETTE) or sizes[1] > len(DASHES):
        return line_style(first * sizes[1] + second)
    return {"color": PALETTE[first], "linestyle": DASHES[second], "linewidth": 1.6}


def style_axes(axes: Axes) -> None:
    """Give axes the common style, with a light grid, no frame, and ticks and labels in the common sizes."""
    axes.grid(visible=True, which="major", color=FAINT, linewidth=0.7)
    axes.set_axisbelow(True)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(MUTED)
    axes.tick_params(which="both", labelsize=SMALL, color=MUTED, labelcolor=INK)
    axes.xaxis.label.set(fontsize=FONT, color=INK)
    axes.yaxis.label.set(fontsize=FONT, color=INK)


def log_ticks(axis: Axis, low: float, high: float) -> None:
    """Set ticks with plain numbers on a log axis: 1, 2, 5 over few decades, powers of ten over many."""
    few = 0 < low < high and math.log10(high / low) < FEW_DECADES
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,), numticks=20 if few else 9))
    axis.set_major_formatter(FuncFormatter(lambda value, _: tick_text(value)))
    axis.set_minor_formatter(NullFormatter())


def phase_ticks(axes: Axes, low: float, high: float) -> None:
    """Set ticks of a phase axis at multiples of 45, 90 or 180 degrees, and its limits at such multiples."""
    span = high - low
    step = 45 if span <= FEW_PHASES else 90 if span <= MANY_PHASES else 180
    bottom, top = step * math.floor(low / step + 1e-6), step * math.ceil(high / step - 1e-6)
    if bottom == top:
        bottom, top = bottom - step, top + step
    axes.set_ylim(bottom - 0.1 * step, top + 0.1 * step)
    axes.yaxis.set_major_locator(MultipleLocator(step * (math.ceil(span / step / 12) or 1)))


def tick_text(value: float) -> str:
    """Text of the number at a tick of an axis, with an exponent below 1e-4 and from 1e5 on."""
    return f"{value:g}" if 1e-4 <= abs(value) < 1e5 or value == 0 else f"{value:.0e}".replace("e-0", "e-")


def set_title(figure: Figure, title: str) -> None:
    """Set the title of a figure, folded into lines no wider than the figure."""
    if title:
        lines = [textwrap.fill(line, WIDEST_TITLE) for line in title.splitlines()]
        figure.suptitle("\n".join(lines), fontsize=TITLE, color=INK)


# Panels with horizontal bars one below the other, and the names of their rows beside them.

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


def draw_bars(axes: Axes, rows: int, bars: Sequence[Bars], *, line: str = MUTED, width: float = 0.8) -> None:
    """Draw bars in ``rows`` rows of the axes, and a vertical line at which the bars begin."""
    for one in bars:
        places = [row + one.below for row in range(rows)]
        axes.barh(
            places, one.lengths, left=one.start, height=one.height, color=one.color, alpha=one.alpha,
            label=one.label or None,
        )  # fmt: skip
        if one.intervals is not None:
            axes.hlines(places, *one.intervals, color=INK, linewidth=1.0)
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
    columns = panel_columns(count, max(1, int(WIDTH / (BARS + min(longest, WIDTH / 3)))))
    lines = math.ceil(count / columns)
    figure = new_figure(WIDTH, 0.9 + lines * (0.8 + ROW * max(rows, 2)))
    grid = figure.subplots(lines, columns, squeeze=False).ravel()
    for axes in grid[count:]:
        axes.remove()
    return figure, grid[:count].tolist(), WIDTH / columns


# Axis of speeds, with room around a steady speed, whose small changes would fill the panel else.

STEADY_SHARE = 1e-3
"""Span of speeds over the largest up to which they count as one: a governor leaves so much, a run-up far more."""
ROOM = 0.01
"""Share of a steady speed that its axis shows on either side, wide enough for ticks of whole numbers."""
MOST_STEPS = 4
"""Most steps between ticks of the axis of a steady speed, as panels side by side are narrow."""


def is_steady(speeds: FloatArray) -> bool:
    """Whether speeds are one speed but for what a governor leaves, so that a line through them would not be seen.

    Examples
    --------
    >>> is_steady(np.array([929.9999, 930.0001])), is_steady(np.array([870.0, 990.0]))
    (True, False)
    """
    return bool(np.ptp(speeds) <= STEADY_SHARE * np.abs(speeds).max())


def curve_mark(speeds: FloatArray) -> dict[str, Any]:
    """Marks of matplotlib for a curve over speed: dashes where all its points lie at one speed, else none."""
    return {"marker": "_", "markersize": 24, "markeredgewidth": 1.3} if is_steady(speeds) else {}


def fit_speeds(axes: Axes, rpm: FloatArray) -> None:
    """Show speeds in rpm as plain numbers, and a steady one in the middle of its axis."""
    axes.ticklabel_format(axis="x", useOffset=False)
    if is_steady(rpm):
        middle = float(np.mean(rpm))
        axes.set_xlim(middle - ROOM * abs(middle), middle + ROOM * abs(middle))
        axes.xaxis.set_major_locator(MaxNLocator(MOST_STEPS))

"""Style of all pictures, with the palette, dashes of lines, sizes of texts, and ticks of axes.

Matplotlib's global settings are left alone.
"""

from __future__ import annotations

import io
import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, MultipleLocator, NullFormatter
from numpy.typing import ArrayLike, NDArray

import torsionnet.plot.drawing.pieces as colors
from torsionnet.base.errors import UsageError
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


GivenAxes: TypeAlias = Axes | Sequence[Axes] | NDArray[Any] | None
"""Axes that a user gives to a plot, one for each panel, as ``plt.subplots`` makes them; None: a figure of its own."""


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


@dataclass(frozen=True)
class Sheet:
    """Panels of a plot with their figure: one of its own, or that of axes that were given.

    The figure of given axes keeps its size, title and layout: title and legend of the plot stand in the axes.
    """

    figure: Figure
    panels: list[Any]
    is_given: bool = False
    before: tuple[tuple[Any, ...], ...] = ()
    """Legends and titles that the given axes had, which are not this plot's."""

    @classmethod
    def of_given(cls, panels: list[Axes]) -> Sheet:
        """Sheet of axes that were given."""
        root = panels[0].get_figure(root=True) if panels else new_figure(WIDTH, 1.0)
        assert root is not None
        return cls(root, panels, is_given=True, before=tuple(map(_dress, panels)))

    @property
    def width(self) -> float:
        """Width of the figure in inches; of given axes the usual one, as theirs is known only when they are drawn."""
        return WIDTH if self.is_given else float(self.figure.get_figwidth())

    def legend(self, columns: int, *entries: Sequence[Any], above: bool = False, **look: Any) -> None:
        """Draw a legend below the panels, or above, of all that has a label, or of handles and their names.

        In given axes it stands in the first panel.
        """
        look |= {"frameon": False, "fontsize": SMALL}
        if not self.is_given:
            look["loc"] = "outside upper center" if above else "outside lower center"
            self.figure.legend(*entries, ncols=columns, **look)
        elif self.panels:
            self.panels[0].legend(*entries, **look)

    def label_all(self, *, x: str = "", y: str = "", **look: Any) -> None:
        """Write a label of the horizontal or vertical axes of all panels; below the last or beside the first given."""
        if self.is_given:
            self.panels[-1].set_xlabel(x or self.panels[-1].get_xlabel(), **look)
            self.panels[0].set_ylabel(y or self.panels[0].get_ylabel(), **look)
            return
        for label, text in ((self.figure.supxlabel, x), (self.figure.supylabel, y)):
            if text:
                label(text, **look)

    def drop(self, panel: Axes) -> None:
        """Remove a panel that has nothing to show; of given axes only what they show."""
        if self.is_given:
            panel.set_axis_off()
        else:
            panel.remove()

    def titled(self, title: str) -> Figure:
        """Write the title above all panels, or above the first of given axes, and return the figure."""
        lines = "\n".join(textwrap.fill(line, WIDEST_TITLE) for line in title.splitlines())
        look: dict[str, Any] = {"fontsize": TITLE, "color": INK}
        if not self.is_given:
            if lines:
                self.figure.suptitle(lines, **look)
            return self.figure
        for panel, (legend, *_) in zip(self.panels, self.before, strict=True):
            drawn = panel.get_legend()
            if drawn is not None and drawn is not legend:  # beside or below a panel there may be another one
                drawn.set_bbox_to_anchor(None)
                drawn.set_loc("best")
        if lines and self.panels:
            first, titles = self.panels[0], self.before[0][1:]
            own = [side for side, text in zip(SIDES, titles, strict=True) if first.get_title(side) not in ("", text)]
            side = own[0] if own else "center"
            first.set_title("\n".join([lines, *map(first.get_title, own)]), loc=side, **look)
        return self.figure


SIDES = ("center", "left", "right")
"""Places of the titles that axes of matplotlib may have."""


def _dress(panel: Any) -> tuple[Any, ...]:
    return (panel.get_legend(), *map(panel.get_title, SIDES))


def given_panels(ax: GivenAxes, shows: Sequence[str]) -> list[Axes]:
    """List of the axes that were given for panels that show something, one for each; else a usage error."""
    panels = list(np.ravel(np.array(ax, dtype=object)))
    wrong = next((panel for panel in panels if not isinstance(panel, Axes)), None)
    if wrong is not None:
        raise UsageError(
            f"ax= takes axes of matplotlib, one for each panel, not {type(wrong).__name__}", kind="wrong-form"
        )
    if len(panels) != len(shows):
        needed = "one panel" if len(shows) == 1 else f"{len(shows)} panels"
        what = f" ({', '.join(shows)})" if any(shows) else ""
        raise UsageError(f"this plot has {needed}{what}, one axes for each; ax= has {len(panels)}", kind="wrong-count")
    return panels


def grid_panels(
    width: float, height: float, shows: Sequence[str], ax: GivenAxes = None, *, columns: int = 1, **layout: Any
) -> tuple[Sheet, Any]:
    """Sheet with a panel for each name of what it shows, row by row, and array of its axes, (rows, columns).

    Width and height of the figure are in inches; ``layout`` goes to ``Figure.subplots``. Places without a panel hold
    None. Given axes share those of their axis that panels of the figure would share.
    """
    rows = -(-len(shows) // columns)
    if ax is None:
        figure = new_figure(width, height)
        grid = figure.subplots(rows, columns, squeeze=False, **layout) if rows else np.empty((0, columns), object)
        for extra in grid.ravel()[len(shows) :]:
            extra.remove()
        return Sheet(figure, grid.ravel()[: len(shows)].tolist()), grid
    panels = given_panels(ax, shows)
    grid = np.array([*panels, *[None] * (rows * columns - len(panels))], dtype=object).reshape(rows, columns)
    for side in ("sharex", "sharey"):
        how = layout.get(side, False)
        for place, panel in enumerate(panels):
            row, column = divmod(place, columns)
            first: Any = grid[0 if how in (True, "col") else row, 0 if how in (True, "row") else column]
            share_axis(panel, first, side)
    return Sheet.of_given(panels), grid


def share_axis(panel: Axes, first: Axes, side: str) -> None:
    """Have given axes share an axis with the first, ``sharex`` or ``sharey``, unless they do."""
    shared = panel.get_shared_x_axes() if side == "sharex" else panel.get_shared_y_axes()
    if panel is not first and not shared.joined(panel, first):
        try:
            getattr(panel, side)(first)
        except ValueError:
            raise UsageError(
                "panels of this plot share an axis, and the axes in ax= already share it with others; give other axes",
                kind="contradicting-values",
            ) from None


def mosaic_panels(height: float, mosaic: Sequence[Sequence[str]], ax: GivenAxes = None, **layout: Any) -> Sheet:
    """Sheet of the usual width with styled panels of unequal size; ``mosaic`` has what each shows, as a table.

    ``layout`` goes to ``Figure.subplot_mosaic``.
    """
    if ax is None:
        figure = new_figure(WIDTH, height)
        rows: Any = [list(row) for row in mosaic]
        sheet = Sheet(figure, list(figure.subplot_mosaic(rows, **layout).values()))
    else:
        shows = list(dict.fromkeys(name for row in mosaic for name in row))
        sheet = Sheet.of_given(given_panels(ax, shows))
    for panel in sheet.panels:
        style_axes(panel)
    return sheet


def one_panel(height: float, ax: GivenAxes = None) -> tuple[Sheet, Axes]:
    """Sheet of the usual width and a height in inches with one panel in the common style, and this panel."""
    sheet, (panel,) = stacked_panels(height, [""], ax)
    return sheet, panel


def stacked_panels(
    height: float, shows: Sequence[str], ax: GivenAxes = None, *, shares: Sequence[float] | None = None
) -> tuple[Sheet, list[Axes]]:
    """Sheet of the usual width with panels in the common style one below the other, and these from top to bottom.

    Their horizontal axis is the same; ``shares`` are their heights in parts of the figure's, which is in inches.
    """
    ratios = {"height_ratios": shares or [1] * len(shows)}
    sheet, _ = grid_panels(WIDTH, height, shows, ax, sharex=True, gridspec_kw=ratios)
    for panel in sheet.panels:
        style_axes(panel)
    return sheet, sheet.panels


def legend_beside(axes: Axes) -> None:
    """Draw the legend of the axes to their right."""
    axes.legend(fontsize=SMALL, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))


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

    >>> first, other = paired_style(0, 0, (2, 3)), paired_style(0, 1, (2, 3))
    >>> first["color"] == other["color"], first["linestyle"] == other["linestyle"]
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
    # A phase that is a multiple but for rounding needs no further tick.
    bottom, top = step * math.floor(low / step + 1e-6), step * math.ceil(high / step - 1e-6)
    if bottom == top:
        bottom, top = bottom - step, top + step
    axes.set_ylim(bottom - 0.1 * step, top + 0.1 * step)
    axes.yaxis.set_major_locator(MultipleLocator(step * (math.ceil(span / step / 12) or 1)))


def tick_text(value: float) -> str:
    """Text of the number at a tick of an axis, with an exponent below 1e-4 and from 1e5 on."""
    return f"{value:g}" if 1e-4 <= abs(value) < 1e5 or value == 0 else f"{value:.0e}".replace("e-0", "e-")


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
    for group in bars:
        places = [row + group.below for row in range(rows)]
        axes.barh(
            places, group.lengths, left=group.start, height=group.height, color=group.color, alpha=group.alpha,
            label=group.label or None,
        )  # fmt: skip
        if group.intervals is not None:
            axes.hlines(places, *group.intervals, color=INK, linewidth=1.0)
    axes.axvline(bars[0].start, color=line, linewidth=width)


def name_rows(axes: Axes, names: Sequence[str]) -> None:
    """Write names beside the rows of bars of a panel, the first name on top."""
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(max(len(names), 1) - 0.4, -0.6)


def fills_a_page(count: int, rows: int) -> bool:
    """Whether ``count`` panels of ``rows`` bars are more than can be read as one picture."""
    return count > FEW_PANELS and count * (rows + 2) > MOST_BARS


def bar_panels(shows: Sequence[str], rows: int, longest: float, ax: GivenAxes = None) -> tuple[Sheet, float]:
    """Sheet with panels for horizontal bars, and width in inches of a panel with the names of its bars.

    As many panels stand side by side as leave room for bars and names.

    Parameters
    ----------
    shows : sequence of str
        What each panel shows.
    rows : int
        Number of bars in each.
    longest : float
        Width of the longest name in inches.
    ax : sequence of Axes, optional
        Axes that were given.
    """
    columns = panel_columns(len(shows), max(1, int(WIDTH / (BARS + min(longest, WIDTH / 3)))))
    height = 0.9 + math.ceil(len(shows) / columns) * (0.8 + ROW * max(rows, 2))
    sheet, _ = grid_panels(WIDTH, height, shows, ax, columns=columns)
    return sheet, WIDTH / columns


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

"""Labels broken into lines, logarithmic axes, legends and rows of bars that the plots of studies have in common."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator
from numpy.typing import ArrayLike, NDArray

import torsionnet.plot.drawing.style as style
from torsionnet.base.number_text import typeset_unit, unit_in_brackets
from torsionnet.plot.drawing.labels import symbol
from torsionnet.plot.drawing.pieces import text_width
from torsionnet.plot.drawing.style import GivenAxes, bar_panels, name_rows
from torsionnet.plot.schematics.drawing_plan import wrap_text
from torsionnet.plot.schematics.outlines import POINTS_PER_INCH

WITHIN_COLOR, BEYOND_COLOR = style.PALETTE[0], style.LIMIT_COLOR
DECADE = 10.0
"""Ratio of the largest to the smallest value on an axis of a study's plot above which the axis is logarithmic."""
EQUAL_VALUES = 1e-9
"""Relative difference up to which values count as equal, because rounding errors can explain it."""
EQUAL_FACTORS = 1e-6
"""Relative difference of logarithmic steps up to which ascending values count as having equal factors; texts of values
are rounded that far."""
AXIS_TEXT_ROLE = "sensor"
"""Role of schematic texts, a name in ``ROLES``, whose font is as large as that of an axis, to measure labels with."""
WORD_BREAKS = "=.-/"
"""Characters behind which a long word is broken in preference to a break between two letters."""
KEY_WIDTH = 0.45
"""Width in inches that a label of a legend needs beside its text, for the sample of the curve and gaps."""


def symbol_or_text(name: str) -> str:
    r"""Text of a name, set as mathtext if the name is a symbol; dollars in other names are kept as dollars.

    >>> print(symbol_or_text("k_1"), symbol_or_text("a price in $"))
    $k_{\mathrm{1}}$ a price in \$
    """
    return as_symbol if (as_symbol := symbol(name)) != name else _without_math(name)


def axis_label(name: str, unit: str, inches: float = math.inf) -> str:
    """Text of the label of an axis with a name and its unit, broken into lines of a width in inches.

    >>> axis_label("stiffness_of_the_coupling", "N*m/rad", 1.4).splitlines()
    ['stiffness_of_the_', 'coupling', '[N·m/rad]']
    """
    behind = unit_in_brackets(typeset_unit(unit))
    if _width(f"{name} {behind}") <= inches:
        return f"{symbol_or_text(name)} {behind}".rstrip()
    name = symbol_or_text(name) if _width(name) <= inches else break_text(name, inches)
    return f"{name}\n{behind}" if behind else name


def label_with_remark(name: str, unit: str, more: str, inches: float) -> str:
    """Text of the label of an axis with a name, its unit and a remark, broken into lines of a width in inches.

    >>> label_with_remark("theta", "rad", "largest over the others", 2.0).splitlines()[1:]
    ['largest over the others']
    """
    label = axis_label(name, unit, inches)
    if not more:
        return label
    whole = f"{name} {unit_in_brackets(typeset_unit(unit))}, {more}"
    return f"{label}, {more}" if _width(whole) <= inches else f"{label}\n{break_text(more, inches)}"


def line_count(texts: Iterable[str]) -> int:
    """Largest number of lines that any of several labels has."""
    return max((text.count("\n") + 1 for text in texts if text), default=0)


def break_text(text: str, inches: float) -> str:
    """Text broken into lines of a width in inches at underscores, commas and spaces, or within long words.

    >>> break_text("torsional stiffness", 0.8).splitlines()
    ['torsional', 'stiffness']
    """
    if _width(text) <= inches:
        return _without_math(text)
    lines: list[str] = []
    for word in text.replace(",", ", ").split():
        if lines and _width(f"{lines[-1]} {word}") <= inches:
            lines[-1] += f" {word}"
        else:
            lines += [
                part
                for piece in wrap_text(word, AXIS_TEXT_ROLE, inches * POINTS_PER_INCH)
                for part in _cut(piece, inches)
            ]
    return _without_math("\n".join(lines))


def _cut(word: str, inches: float) -> list[str]:
    """List of the parts of a long word, each within a width in inches, cut behind punctuation where there is any."""
    parts = [""]
    for letter in word:
        if parts[-1] and _width(parts[-1] + letter) > inches:
            place = max(parts[-1].rfind(mark) for mark in WORD_BREAKS) + 1 or len(parts[-1])
            parts[-1:] = [parts[-1][:place], parts[-1][place:]]
        parts[-1] += letter
    return parts


def _without_math(text: str) -> str:
    return text.replace("$", r"\$")


def _width(text: str) -> float:
    """Width in inches of a text in the font of an axis."""
    return text_width(text.replace("$", "S"), AXIS_TEXT_ROLE) / POINTS_PER_INCH


def panel_title(axes: Axes, text: str, inches: float = math.inf, *, pad: float | None = None) -> None:
    """Set the title of one of several panels, broken to a width in inches."""
    axes.set_title(break_text(text, inches), fontsize=style.FONT, color=style.INK, pad=pad)


def legend_below(sheet: style.Sheet, handles: Sequence[Artist], labels: Sequence[str], *, larger: float = 1.0) -> None:
    """Draw a legend below all panels, in as many columns as its labels leave room for."""
    widest = max(map(_width, labels)) + KEY_WIDTH
    columns = max(1, min(len(labels), int(sheet.width / widest)))
    sheet.legend(columns, handles, labels, markerscale=larger)


def write_in_empty_panel(axes: Axes, text: str) -> None:
    """Write a text in the middle of a panel that has nothing to draw."""
    axes.text(
        0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", fontsize=style.SMALL, color=style.MUTED
    )


def finite_values(values: Iterable[ArrayLike]) -> NDArray[np.float64]:
    """Finite values of several arrays as one array, shape (n,)."""
    every = np.concatenate([np.ravel(np.asarray(array, dtype=float)) for array in values])
    return np.asarray(every[np.isfinite(every)])


def axis_ends(values: NDArray[np.float64]) -> tuple[float, float]:
    """Lowest and highest of finite values as the two ends of an axis, moved apart if all values are equal."""
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    size = max(abs(low), abs(high))
    if high - low > EQUAL_VALUES * size:
        return low, high
    return (low - 0.1 * size, high + 0.1 * size) if size else (-1.0, 1.0)


def is_wide(values: NDArray[np.float64], ratio: float = DECADE) -> bool:
    """Whether values are all above 0 and span more than a ratio, so that an axis should be logarithmic."""
    return bool(len(values) and values.min() > 0 and values.max() > ratio * values.min())


def has_equal_factors(values: NDArray[np.float64]) -> bool:
    """Whether neighbours in ascending values differ by equal factors, and not by equal steps.

    >>> [has_equal_factors(np.array(values)) for values in ([1.0, 2.0, 4.0, 8.0], [1.0, 2.0, 3.0], [1.0, 8.0])]
    [True, False, False]
    """
    if len(values) < 3 or values.min() <= 0:
        return False
    return bool(np.ptp(np.diff(np.log(values))) < EQUAL_FACTORS * np.ptp(np.log(values)))


def log_axis(axes: Axes, side: str, low: float, high: float, inches: float = math.inf) -> None:
    """Make the axis ``"x"`` or ``"y"`` logarithmic, with as many ticks as it has room for in its width in inches."""
    axis = axes.xaxis if side == "x" else axes.yaxis
    (axes.set_xscale if side == "x" else axes.set_yscale)("log")
    style.log_ticks(axis, low, high)
    decades = math.log10(high / low) if 0 < low < high else 0.0
    if side == "x" and decades > 1 and _width(style.tick_text(high)) > math.log10(2) / decades * inches:
        axis.set_major_locator(LogLocator(numticks=max(2, int(inches / _width(style.tick_text(high))))))


def study_bars(shows: Sequence[str], rows: int, names: Sequence[str], ax: GivenAxes) -> tuple[style.Sheet, float]:
    """Sheet with panels for bars of a study, and width in inches of a panel with its names."""
    return bar_panels(shows, rows, max(map(_width, names), default=0.0), ax)


def bars_legend(sheet: style.Sheet, behind: str = "") -> None:
    """Draw the legend of all panels with the labels of the first panel that has any, each followed by ``behind``."""
    legends = (axes.get_legend_handles_labels() for axes in sheet.panels)
    handles, labels = next(((handles, labels) for handles, labels in legends if labels), ((), ()))
    if labels:
        legend_below(sheet, handles, [f"{label}{behind}" for label in labels])


def parameter_rows(axes: Axes, names: Sequence[str], width: float) -> None:
    """Write the names of parameters beside the rows of a panel, the first on top."""
    name_rows(axes, [axis_label(name, "", width / 2) for name in names])


def text_rows(axes: Axes, texts: Sequence[str], width: float) -> None:
    """Write texts, as names of configurations, beside the rows of a panel, the first on top."""
    name_rows(axes, [break_text(text, width / 2) for text in texts])

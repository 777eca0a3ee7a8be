"""What pictures of studies have in common: labels with units, axes that suit their values, panels that fit a page."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from numpy.typing import ArrayLike, NDArray

import torsionnet.plot.drawing.style as style
from torsionnet.core.number_text import typeset_unit, unit_in_brackets
from torsionnet.plot.drawing.bars import bar_panels, name_rows
from torsionnet.plot.drawing.labels import symbol
from torsionnet.plot.drawing.pieces import text_width
from torsionnet.plot.schematic.texts import wrap_text

LIMIT_COLOR = "#B00020"
WITHIN, BEYOND = style.PALETTE[0], LIMIT_COLOR
INCH = 72.0
DECADE = 10.0
"""Ratio of the largest to the smallest value from which an axis has equal factors."""
ALIKE = 1e-9
"""Of themselves: values that differ by less are one value, and rounding."""
EVEN = 1e-6
"""By how much steps or factors may differ and still be equal."""
ROLE = "sensor"
"""Whose font is as large as that of an axis."""
MARKS = "=.-/"
"""Behind which a long word is broken before it is between two letters."""
KEY = 0.45
"""Inches in front of a label and behind it in a legend."""


def shown_name(name: str) -> str:
    r"""A name as a symbol, if it is that of one; what is no symbol stays as it is, dollars among it.

    >>> print(shown_name("k_1"), shown_name("a price in $"))
    $k_{\mathrm{1}}$ a price in \$
    """
    return found if (found := symbol(name)) != name else _without_math(name)


def axis_label(name: str, unit: str, inches: float = math.inf) -> str:
    """A name with its unit, in as many lines as the room takes.

    >>> axis_label("stiffness_of_the_coupling", "N*m/rad", 1.4).splitlines()
    ['stiffness_of_the_', 'coupling', '[N·m/rad]']
    """
    behind = unit_in_brackets(typeset_unit(unit))
    if _width(f"{name} {behind}") <= inches:
        return f"{shown_name(name)} {behind}".rstrip()
    name = shown_name(name) if _width(name) <= inches else broken(name, inches)
    return f"{name}\n{behind}" if behind else name


def label_with(name: str, unit: str, more: str, inches: float) -> str:
    """A name with its unit and what is said of it besides, in as many lines as the room takes.

    >>> label_with("theta", "rad", "largest over the others", 2.0).splitlines()[1:]
    ['largest over the others']
    """
    label = axis_label(name, unit, inches)
    if not more:
        return label
    whole = f"{name} {unit_in_brackets(typeset_unit(unit))}, {more}"
    return f"{label}, {more}" if _width(whole) <= inches else f"{label}\n{broken(more, inches)}"


def lines_of(texts: Iterable[str]) -> int:
    """Lines that the longest of some labels has."""
    return max((text.count("\n") + 1 for text in texts if text), default=0)


def broken(text: str, inches: float) -> str:
    """A text in lines of a width: at underscores, commas and spaces, and anywhere where there are none of them.

    >>> broken("torsional stiffness", 0.8).splitlines()
    ['torsional', 'stiffness']
    """
    if _width(text) <= inches:
        return _without_math(text)
    lines: list[str] = []
    for word in text.replace(",", ", ").split():
        if lines and _width(f"{lines[-1]} {word}") <= inches:
            lines[-1] += f" {word}"
        else:
            lines += [part for piece in wrap_text(word, ROLE, inches * INCH) for part in _cut(piece, inches)]
    return _without_math("\n".join(lines))


def _cut(word: str, inches: float) -> list[str]:
    """A word without a place to break in parts of a width, behind one of its marks where it has any."""
    parts = [""]
    for letter in word:
        if parts[-1] and _width(parts[-1] + letter) > inches:
            place = max(parts[-1].rfind(mark) for mark in MARKS) + 1 or len(parts[-1])
            parts[-1:] = [parts[-1][:place], parts[-1][place:]]
        parts[-1] += letter
    return parts


def _without_math(text: str) -> str:
    return text.replace("$", r"\$")


def _width(text: str) -> float:
    """Inches."""
    return text_width(text.replace("$", "S"), ROLE) / INCH


def titled(axes: Axes, text: str, inches: float = math.inf, *, pad: float | None = None) -> None:
    """A short title over one of several panels, some points above it."""
    axes.set_title(broken(text, inches), fontsize=style.FONT, color=style.INK, pad=pad)


def key(axes: Axes, *, columns: int = 1) -> None:
    """A legend without a frame, where best it stands."""
    axes.legend(fontsize=style.SMALL, frameon=False, ncols=columns)


def key_beside(axes: Axes) -> None:
    """A legend to the right of the axes, where it covers nothing."""
    axes.legend(fontsize=style.SMALL, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def key_below(figure: Figure, handles: Sequence[Artist], labels: Sequence[str], *, larger: float = 1.0) -> None:
    """A legend below all panels, in as many columns as its labels leave room for."""
    widest = max(map(_width, labels)) + KEY
    columns = max(1, min(len(labels), int(figure.get_figwidth() / widest)))
    figure.legend(
        handles, labels, loc="outside lower center", ncols=columns, fontsize=style.SMALL, frameon=False,
        markerscale=larger,
    )  # fmt: skip


def say(axes: Axes, text: str) -> None:
    """What stands in a panel in which there is nothing to draw."""
    axes.text(
        0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", fontsize=style.SMALL, color=style.MUTED
    )


def known(values: Iterable[ArrayLike]) -> NDArray[np.float64]:
    """All finite values of several arrays, (n,)."""
    every = np.concatenate([np.ravel(np.asarray(one, dtype=float)) for one in values])
    return np.asarray(every[np.isfinite(every)])


def ends_of(values: NDArray[np.float64]) -> tuple[float, float]:
    """Lowest and highest of finite values, some way apart even where they are all alike."""
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    size = max(abs(low), abs(high))
    if high - low > ALIKE * size:
        return low, high
    return (low - 0.1 * size, high + 0.1 * size) if size else (-1.0, 1.0)


def is_wide(values: NDArray[np.float64], ratio: float = DECADE) -> bool:
    """Whether values are all above 0 and so far apart that their factors tell more than their differences."""
    return bool(len(values) and values.min() > 0 and values.max() > ratio * values.min())


def in_factors(values: NDArray[np.float64]) -> bool:
    """Whether rising values have equal factors, and not equal steps.

    >>> in_factors(np.geomspace(1, 8, 4)), in_factors(np.linspace(1, 8, 4)), in_factors(np.array([1.0, 8.0]))
    (True, False, False)
    """
    if len(values) < 3 or values.min() <= 0:
        return False
    return bool(np.ptp(np.diff(np.log(values))) < EVEN * np.ptp(np.log(values)))


def by_factors(axes: Axes, side: str, low: float, high: float, inches: float = math.inf) -> None:
    """Make the axis ``"x"`` or ``"y"`` logarithmic, with ticks as they are read best and as many as it has room for."""
    axis = axes.xaxis if side == "x" else axes.yaxis
    (axes.set_xscale if side == "x" else axes.set_yscale)("log")
    style.log_ticks(axis, low, high)
    decades = math.log10(high / low) if 0 < low < high else 0.0
    if side == "x" and decades > 1 and _width(style.tick_text(high)) > math.log10(2) / decades * inches:
        axis.set_major_locator(LogLocator(numticks=max(2, int(inches / _width(style.tick_text(high))))))


def study_bars(count: int, rows: int, names: Sequence[str]) -> tuple[Figure, list[Axes], float]:
    """Panels of bars with names beside them, and how wide one is, in inches."""
    return bar_panels(count, rows, max(map(_width, names), default=0.0))


def bar_key(figure: Figure, panels: Iterable[Axes], behind: str = "") -> None:
    """A legend of all panels from the first that has labels, each with what stands ``behind`` it."""
    found = (axes.get_legend_handles_labels() for axes in panels)
    handles, labels = next(((handles, labels) for handles, labels in found if labels), ((), ()))
    if labels:
        key_below(figure, handles, [f"{label}{behind}" for label in labels])


def named_rows(axes: Axes, names: Sequence[str], width: float) -> None:
    """Parameters at the rows of a panel of bars, the first on top."""
    name_rows(axes, [axis_label(name, "", width / 2) for name in names])


def told_rows(axes: Axes, texts: Sequence[str], width: float) -> None:
    """The same of configurations, which are no symbols."""
    name_rows(axes, [broken(text, width / 2) for text in texts])

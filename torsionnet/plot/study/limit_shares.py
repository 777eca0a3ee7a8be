"""Values of quantities over their limits, and the shares beyond."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.core.number_text import screen_text, typeset_unit
from torsionnet.plot.study.study_axes import BEYOND, axis_label, key, key_beside, say
from torsionnet.study.shown_units import IN_SI, ShownUnits

if TYPE_CHECKING:
    from torsionnet.study.answers.draws_beyond import LimitedValues
    from torsionnet.study.answers.yield_answer import YieldFound

ROOM = 0.05
"""Of the width of all values and of the limits that are no farther off than that width; others are only told of."""
FEW = 2
"""Configurations whose names have room within the picture."""
LINE = 0.165
"""Inches of a line of the key."""


def limit_shares(found: YieldFound, *, units: ShownUnits = IN_SI, title: str | None = None) -> Figure:
    """How the variants of each configuration lie about every limit; what is beyond is shaded.

    Parameters
    ----------
    found : YieldFound
        What the answer ``yield`` of a study found.
    units : ShownUnits, optional
        By default SI.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    names = list(dict.fromkeys(one.quantity for one in found.distributions))
    cases = len(dict.fromkeys(one.configuration for one in found.distributions))
    figure = style.new_figure(style.WIDTH, 0.8 + max(2.4, 0.9 + LINE * cases) * len(names))
    panels = figure.subplots(len(names), 1, squeeze=False)[:, 0]
    for axes, name in zip(panels, names, strict=True):
        _panel(axes, found, [one for one in found.distributions if one.quantity == name], units)
    style.set_title(figure, found.title if title is None else title)
    return figure


def _panel(axes: Axes, found: YieldFound, distributions: list[LimitedValues], units: ShownUnits) -> None:
    first = distributions[0]
    scale = units.scale(first.curve or first.quantity, first.unit)
    for number, one in enumerate(distributions):
        _drawn(axes, one, scale, number, _label(found, one))
    style.style_axes(axes)
    with_values = [one for one in distributions if one.counts.any()]
    if with_values:
        _ends(axes, first, scale, with_values, units)
        axes.set_ylim(bottom=0)
    else:
        say(axes, "no variant has a value")
        axes.set(xticks=[], yticks=[])
    axes.set_ylabel("variants [% per bin]")
    axes.set_xlabel(axis_label(first.quantity, units.unit(first.curve or first.quantity, first.unit)))
    (key if len(distributions) <= FEW else key_beside)(axes)


def _label(found: YieldFound, one: LimitedValues) -> str:
    share = next(
        (each.share for each in found.shares
         if each.configuration == one.configuration and f" {one.quantity} " in f" {each.limit} "), None,
    )  # fmt: skip
    return one.configuration if share is None else f"{one.configuration}: {share.percent} beyond"


def _drawn(axes: Axes, one: LimitedValues, scale: float, number: int, label: str) -> None:
    """A histogram; where all values are the same, a line at that value."""
    look = style.line_style(number)
    if not one.counts.any():
        axes.plot([], [], label=label, **look)
    elif one.constant is not None:
        axes.plot([scale * one.constant] * 2, [0, 100], label=label, **look)
    else:
        density = one.counts / max(one.counts.sum(), 1) * 100
        axes.stairs(density, one.edges * scale, label=label, **look)


def _ends(axes: Axes, first: LimitedValues, scale: float, drawn: list[LimitedValues], units: ShownUnits) -> None:
    """Room for all values and the limits near them; what is beyond shaded, and limits farther off told of."""
    low = scale * min(one.edges[0] for one in drawn)
    high = scale * max(one.edges[-1] for one in drawn)
    spread = high - low if any(one.constant is None for one in drawn) else max(abs(low), abs(high))
    sides = [None if side is None else side * scale for side in (first.above, first.below)]
    near = [side for side in sides if side is not None and low - spread <= side <= high + spread]
    low, high = min([low, *near]), max([high, *near])
    axes.set_xlim(low - ROOM * (high - low), high + ROOM * (high - low))
    for side, end in zip(sides, (0, 1), strict=True):
        if side is None:
            continue
        if side in near:
            axes.axvline(side, color=BEYOND, linewidth=1.4)
            axes.axvspan(*np.sort([side, axes.get_xlim()[end]]), color=BEYOND, alpha=0.08, linewidth=0)
            continue
        unit = typeset_unit(units.unit(first.curve or first.quantity, first.unit))
        text = f"limit {screen_text(side, 4)} {unit}".rstrip()
        is_left = side < low
        axes.annotate(
            f"\N{LEFTWARDS ARROW} {text}" if is_left else f"{text} \N{RIGHTWARDS ARROW}",
            (0.0 if is_left else 1.0, 1.0), xycoords="axes fraction", xytext=(0, 2), textcoords="offset points",
            ha="left" if is_left else "right", va="bottom", fontsize=style.SMALL, color=BEYOND,
        )  # fmt: skip

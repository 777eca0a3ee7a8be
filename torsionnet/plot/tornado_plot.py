"""Tornado plot of the sensitivity of natural frequencies and damping ratios to parameters, the largest on top."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.plot.drawing.style import Bars, GivenAxes, draw_bars, name_rows

if TYPE_CHECKING:
    from torsionnet.linear.sensitivity.sensitivities_of_modes import ModeSensitivities

MOST_MODES, MOST_PARAMETERS = 4, 12
"""Number of modes drawn unless others are asked for, and largest number of bars in a panel: as many as fit a page."""
SHORTEST_BAR = 5e-3
"""Sensitivity, relative to the largest one, up to which a parameter has no bar: its bar would not be seen."""
ROUNDING = 1e-9
"""Sensitivity in percent per percent up to which it is a rounding error of zero."""


def tornado(
    result: ModeSensitivities, *, mode: list[int] | None = None, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of bars, the percent of natural frequency and of damping ratio of modes per percent of each parameter.

    Parameters
    ----------
    result : ModeSensitivities
    mode : list of int, optional
        Numbers of modes as in their table; by default the first four, real poles among them.
    title : str, optional
    ax : sequence of Axes, optional
        Axes to draw into, for natural frequency and, if it has any, damping ratio of each mode; by default those of a
        new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import torsionnet as tn
    >>> result = tn.sensitivity.mode_sensitivities(tn.load("dmf_rig"))
    >>> len(tornado(result, mode=[1]).axes)
    2
    """
    known = [result.number(index) for index in range(len(result.poles))]
    have = [str(number) for number in known if number is not None]
    wrong = [number for number in mode or () if number not in known]
    if wrong or not known:
        there = f"there are {', '.join(have)}" if have else "there is none that vibrates"
        raise UsageError(f"there is no mode {wrong[0] if wrong else 1}; {there}", kind="unknown-mode")
    chosen = [known.index(number) for number in mode] if mode else list(range(len(known)))
    chosen = [place for place in chosen if _moves(result, place)][: len(chosen) if mode else MOST_MODES]
    if not chosen:
        raise UsageError(
            "there is nothing to draw: none of the parameters moves these modes; choose other modes or parameters",
            kind="missing-data",
        )
    # A parameter counts by what it moves most, over all modes drawn; the least are left out.
    size = (np.abs(result.relative_frequencies) + np.abs(result.relative_dampings))[chosen].max(axis=0)
    shown = [int(p) for p in np.argsort(-size)[:MOST_PARAMETERS] if size[p] > SHORTEST_BAR * size.max()]
    damped = any(np.abs(result.relative_dampings[place]).max() > ROUNDING for place in chosen)
    height = 1.2 + len(chosen) * (0.6 + 0.22 * len(shown))
    what = ("natural frequency", "damping ratio")[: 1 + damped]
    shows = [f"{quantity} of {result.name(place)}" for place in chosen for quantity in what]
    sheet, panels = style.grid_panels(style.WIDTH, height, shows, ax, columns=len(what))
    for row, place in zip(panels, chosen, strict=True):
        _bars(row[0], result, result.relative_frequencies[place], shown, style.PALETTE[0])
        row[0].set_title(f"{result.name(place)}: {result.natural_frequencies[place]:.4g} Hz", fontsize=style.FONT)
        if damped:
            _damping(sheet, row[1], result, place, shown)
    for axes, quantity in zip(_lowest(panels), what, strict=True):
        axes.set_xlabel(f"{quantity} [% per %]")
    return sheet.titled(result.title if title is None else title)


def _moves(result: ModeSensitivities, mode: int) -> bool:
    slopes = np.abs(np.concatenate([result.relative_frequencies[mode], result.relative_dampings[mode]]))
    return bool(slopes.max(initial=0.0) > ROUNDING)


def _damping(sheet: style.Sheet, axes: Axes, result: ModeSensitivities, mode: int, shown: list[int]) -> None:
    """Draw bars with the sensitivity of the damping ratio of a mode to each parameter, in percent per percent.

    Remove the panel of a real pole or a mode without damping.
    """
    slopes = result.relative_dampings[mode]
    if np.abs(slopes[shown]).max(initial=0.0) <= ROUNDING:
        sheet.drop(axes)
        return
    _bars(axes, result, slopes, shown, style.PALETTE[1])
    axes.set_title(f"damping ratio {100 * result.damping_ratios[mode]:.3g} %", fontsize=style.FONT)


def _lowest(panels: Any) -> list[Axes]:
    """List of the lowest panel left in each column of the figure."""
    return [[axes for axes in column if axes.figure is not None and axes.axison][-1] for column in panels.T]


def _bars(axes: Axes, result: ModeSensitivities, slopes: FloatArray, shown: list[int], colour: str) -> None:
    """Draw bars with a mode's sensitivity to each parameter that moves it, in percent per percent, longest on top."""
    style.style_axes(axes)
    sizes = np.abs(slopes)
    falling = sorted(shown, key=lambda p: -float(f"{sizes[p]:.6g}"))  # equal ones in the order of the parameters
    longest = [p for p in falling if sizes[p] > max(SHORTEST_BAR * sizes[falling[0]], ROUNDING)]
    name_rows(axes, [result.parameters[p] for p in longest])
    draw_bars(axes, len(longest), [Bars(slopes[longest], colour)])

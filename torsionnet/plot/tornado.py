"""Tornado plot: what moves natural frequencies and damping ratios, the strongest on top."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.style as style
from torsionnet.core.errors import UsageError
from torsionnet.response.frequency_response import FloatArray

if TYPE_CHECKING:
    from torsionnet.solve.sensitivity import ModeSensitivities

MOST_MODES, MOST_PARAMETERS = 4, 12
FAINTEST = 5e-3
NOTHING = 1e-9
"""Percent per percent that rounding makes of none."""


def tornado(found: ModeSensitivities, *, modes: list[int] | None = None, title: str | None = None) -> Figure:
    """Percent of natural frequency and of damping ratio per percent of each parameter.

    Parameters
    ----------
    found : ModeSensitivities
    modes : list of int, optional
        Numbers of modes as in their table, where rigid-body modes count; by default the first four vibrations.
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import torsionnet as tn
    >>> found = tn.sensitivity.mode_sensitivities(tn.load("dmf_rig"))
    >>> len(tornado(found, modes=[1]).axes)
    2
    """
    known = [found.number(index) for index in range(len(found.poles))]
    wrong = [number for number in modes or () if number not in known]
    if wrong or not known:
        have = f"there are {', '.join(map(str, known))}" if known else "there is none that vibrates"
        raise UsageError(f"there is no mode {wrong[0] if wrong else 1}; {have}")
    chosen = [known.index(number) for number in modes or known]
    chosen = [mode for mode in chosen if _moves(found, mode)][: len(chosen) if modes else MOST_MODES]
    if not chosen:
        raise UsageError("none of the parameters moves these modes")
    size = (np.abs(found.relative_frequencies) + np.abs(found.relative_dampings))[chosen].max(axis=0)
    shown = [int(p) for p in np.argsort(-size)[:MOST_PARAMETERS] if size[p] > FAINTEST * size.max()]
    damped = any(np.abs(found.relative_dampings[mode]).max() > NOTHING for mode in chosen)
    figure = style.new_figure(style.WIDTH, 1.2 + len(chosen) * (0.6 + 0.22 * len(shown)))
    panels = figure.subplots(len(chosen), 2 if damped else 1, squeeze=False, sharey=True)
    for row, mode in zip(panels, chosen, strict=True):
        _bars(row[0], found.relative_frequencies[mode, shown], style.PALETTE[0])
        row[0].set_yticks(range(len(shown)), [found.parameters[p] for p in shown])
        row[0].set_title(_title(found, mode), fontsize=style.FONT)
        if damped:
            _damping(row[1], found, mode, shown)
    panels[0][0].invert_yaxis()  # all panels share the axis: once for all of them
    for axes, what in zip(_lowest(panels), ("natural frequency", "damping ratio"), strict=False):
        axes.set_xlabel(f"{what} [% per %]")
    style.heading(figure, found.title if title is None else title)
    return figure


def _moves(found: ModeSensitivities, mode: int) -> bool:
    slopes = np.abs(np.concatenate([found.relative_frequencies[mode], found.relative_dampings[mode]]))
    return bool(slopes.max(initial=0.0) > NOTHING)


def _title(found: ModeSensitivities, mode: int) -> str:
    what = "real pole, " if found.poles[mode].imag == 0 else ""
    return f"mode {found.number(mode)}: {what}{found.natural_frequencies[mode]:.4g} Hz"


def _damping(axes: Axes, found: ModeSensitivities, mode: int, shown: list[int]) -> None:
    """The bars of the damping ratio; a real pole or a mode without damping has none, and no panel."""
    slopes = found.relative_dampings[mode, shown]
    if np.abs(slopes).max(initial=0.0) <= NOTHING:
        axes.remove()
        return
    _bars(axes, slopes, style.PALETTE[1])
    axes.set_title(f"damping ratio {100 * found.damping_ratios[mode]:.3g} %", fontsize=style.FONT)


def _lowest(panels: Any) -> list[Axes]:
    """The lowest panel of each column that is there."""
    return [[axes for axes in column if axes.figure is not None][-1] for column in panels.T]


def _bars(axes: Axes, values: FloatArray, colour: str) -> None:
    style.dress(axes)
    axes.barh(range(len(values)), values, color=colour, height=0.7)
    axes.axvline(0, color=style.MUTED, linewidth=0.8)

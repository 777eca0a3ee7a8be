"""Tornado plot: what moves natural frequencies and damping ratios, the strongest on top."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from torsionnet.errors import UsageError
from torsionnet.report import style
from torsionnet.response.frequency_response import FloatArray

if TYPE_CHECKING:
    from torsionnet.sensitivity import ModeSensitivities

MOST_MODES, MOST_PARAMETERS = 4, 12
FAINTEST = 5e-3


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
        msg = f"there is no mode {wrong[0] if wrong else 1}; {have}"
        raise UsageError(msg)
    chosen = [known.index(number) for number in modes or known[:MOST_MODES]]
    size = (np.abs(found.relative_frequencies) + np.abs(found.relative_dampings))[chosen].max(axis=0)
    shown = [int(p) for p in np.argsort(-size)[:MOST_PARAMETERS] if size[p] > FAINTEST * size.max()]
    figure = style.new_figure(style.WIDTH, 1.2 + len(chosen) * (0.6 + 0.22 * len(shown)))
    panels = figure.subplots(len(chosen), 2, squeeze=False, sharey=True)
    for row, mode in zip(panels, chosen, strict=True):
        _bars(row[0], found.relative_frequencies[mode, shown], style.PALETTE[0])
        _bars(row[1], found.relative_dampings[mode, shown], style.PALETTE[1])
        row[0].set_yticks(range(len(shown)), [found.parameters[p] for p in shown])
        zeta = 100 * found.damping_ratios[mode]
        row[0].set_title(f"mode {found.number(mode)}: {found.natural_frequencies[mode]:.4g} Hz", fontsize=style.FONT)
        real = found.poles[mode].imag == 0
        row[1].set_title("real pole" if real else f"damping ratio {zeta:.3g} %", fontsize=style.FONT)
    panels[0][0].invert_yaxis()  # all panels share the axis: once for all of them
    panels[-1][0].set_xlabel("natural frequency [% per %]")
    panels[-1][1].set_xlabel("damping ratio [% per %]")
    style.heading(figure, found.title if title is None else title)
    return figure


def _bars(axes: Axes, values: FloatArray, colour: str) -> None:
    style.dress(axes)
    axes.barh(range(len(values)), values, color=colour, height=0.7)
    axes.axvline(0, color=style.MUTED, linewidth=0.8)

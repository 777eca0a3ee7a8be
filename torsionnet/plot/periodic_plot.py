"""Plot of periodic motions over frequency or speed, unstable parts dashed, with the places where branches turn."""

from __future__ import annotations

from itertools import groupby, pairwise
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.plot.drawing.labels import axis_label, axis_unit
from torsionnet.plot.drawing.style import GivenAxes

if TYPE_CHECKING:
    from torsionnet.motion.periodic.periodic_result import FoundMotion, PeriodicResponse

TURNS = {"fold": "o", "doubling": "D", "symmetry": "^", "second frequency": "s"}
"""Marker of matplotlib of each kind of place at which a branch turns."""


def periodic_response(
    response: PeriodicResponse, *, conventions: Conventions = SI, title: str | None = None, ax: GivenAxes = None
) -> Figure:
    """Figure of the peak to peak of every output over frequency or speed, branch by branch; what is unstable is dashed.

    Dotted parts are those whose stability is not determined. Circles are folds, diamonds doublings, triangles where
    lopsided motions begin, squares onsets of a second frequency.

    Parameters
    ----------
    response : PeriodicResponse
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the model.
    ax : sequence of Axes, optional
        Axes to draw into, one for each output; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    names = [channel.name for channel in response.outputs]
    sheet, panels = style.stacked_panels(1.2 + 2.6 * len(names), names, ax)
    for place, (panel, channel) in enumerate(zip(panels, response.outputs, strict=True)):
        sizes = [float(motion.highest[place] - motion.lowest[place]) for motion in response.motions]
        scale, unit = axis_unit(channel.unit, max(sizes, default=0.0), conventions)
        # Each branch in its colour: stable parts as lines, unstable ones dashed, undetermined ones dotted.
        for number, group in groupby(response.motions, key=lambda motion: motion.branch):
            _draw_branch(panel, response, list(group), number, (place, scale))
        panel.set_ylabel(axis_label(f"{channel.name}, peak to peak", unit, 40))
        panel.set_ylim(bottom=0)
    panels[-1].set_xlabel("speed [rpm]" if response.over == "speed" else "frequency [Hz]")
    if len(response.ways) > 1:
        sheet.legend(min(len(response.ways), 3))
    return sheet.titled(f"{response.title}: periodic motions" if title is None else title)


def _draw_branch(
    panel: Axes, response: PeriodicResponse, motions: list[FoundMotion], number: int, shown: tuple[int, float]
) -> None:
    place, scale = shown
    color = style.PALETTE[number % len(style.PALETTE)]
    line = _with_ends(response, motions)
    at = np.array([response.shown(motion.at) for motion in line])
    sizes = np.array([scale * float(motion.highest[place] - motion.lowest[place]) for motion in line])
    label: str | None = f"branch {number + 1}: {response.ways[number]}"
    if len(line) == 1:
        panel.plot(at, sizes, ".", color=color, label=label)
    first = 0
    # One line for all steps of a style: in lines shorter than a dash, dashes would not show.
    for dashes, steps in groupby(_dashes(motion, other) for motion, other in pairwise(line)):
        last = first + len(list(steps))
        panel.plot(
            at[first : last + 1], sizes[first : last + 1], color=color, linewidth=1.6, linestyle=dashes, label=label
        )
        first, label = last, None
    for kind, marker in TURNS.items():
        turns = [i for i, motion in enumerate(line) if motion.turn == kind and motion.branch == number]
        panel.plot(at[turns], sizes[turns], marker, color=color, markersize=5, fillstyle="none")


def _with_ends(response: PeriodicResponse, motions: list[FoundMotion]) -> list[FoundMotion]:
    """Motions of a branch with the doublings at which it begins and ends; the same of branches that double nothing.

    It ends at one where no other branch begins, if no place asked for lies between.
    """
    first, last = motions[0], motions[-1]
    doublings = [doubling for doubling in response.turns("doubling") if 2 * doubling.periods == first.periods]
    begins = {doubling: _begun(response, doubling) for doubling in doublings}
    own = [doubling for doubling in doublings if begins[doubling] == first.branch]
    places = {motion.at for motion in response.motions if not motion.turn}
    ends = [
        doubling
        for doubling in doublings
        if begins[doubling] is None and not any(min(at := doubling.at, last.at) < p < max(at, last.at) for p in places)
    ]
    return [*own, *motions, *sorted(ends, key=lambda doubling: abs(doubling.at - last.at))[:1]]


def _begun(response: PeriodicResponse, doubling: FoundMotion) -> int | None:
    """Number of the branch that begins at a doubling; None of one where none begins."""
    way = f"doubled at {response.shown(doubling.at):.8g} {response.unit}"
    return response.ways.index(way) if way in response.ways else None


def _dashes(motion: FoundMotion, other: FoundMotion) -> str:
    """Line style between two motions: where one lies on the edge of stability the other decides."""
    states = [each.is_stable for each in (motion, other) if not each.on_edge]
    if any(state is False for state in states):
        return "--"
    return ":" if not states or None in states else "-"

"""Plot of a vibration over time while the speed changes, with the limits that its half range has to keep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.linear.frequency_response import Channel
from torsionnet.machinery.passage.passage_response import PassageResponse
from torsionnet.machinery.passage.vibration_cycles import cycles_above, envelopes
from torsionnet.plot.drawing.torque_units import axis_unit
from torsionnet.plot.histories import thin_out
from torsionnet.signals.recording import FloatArray

LIMIT_DASHES = ("-", (0, (6, 2)), (0, (2, 1.5)))
"""Line styles of matplotlib for the limits drawn over a passage, in the order of the limits."""
MOST_CYCLES_DRAWN = 100
"""Number of cycles of a vibration up to which it is drawn as a line: more of them on the width of a page run into one
area, of which the envelope says more."""
BAND_ALPHA = 0.3
"""Opacity of the area between the envelopes, through which the grid and the limits can be seen."""


def passage_response(
    run: PassageResponse | Sequence[PassageResponse],
    output: str | None = None,
    *,
    limits: Mapping[str, ArrayLike] | Sequence[Mapping[str, ArrayLike]] | None = None,
    conventions: Conventions = SI,
    title: str | None = None,
) -> Figure:
    """Figure of a vibration over time while the speed changes, with half range, limits in red, and the speed below.

    Of many cycles the area between the upper and the lower envelope is drawn, largest and smallest value in each cycle.
    Several passages stand beside each other, with one axis for their values and each with its own time.

    Parameters
    ----------
    run : PassageResponse or sequence of these
        Several of one output have the same unit, such as a quick and a slow passage of one range.
    output : str, optional
        By default the first.
    limits : mapping, or sequence of these, optional
        Name -> allowed half range in the SI unit of the output, one or (n_t,); of several passages one for each.
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the first response.

    Returns
    -------
    matplotlib.figure.Figure
    """
    runs = [run] if isinstance(run, PassageResponse) else list(run)
    given = [limits] * len(runs) if limits is None or isinstance(limits, Mapping) else list(limits)
    passages = [_Passage.of(one, output, lines or {}) for one, lines in zip(runs, given, strict=True)]
    channel = passages[0].channel
    scale, unit = axis_unit(channel.unit, max(one.largest for one in passages), conventions)
    figure = style.new_figure(style.WIDTH, 4.0 if len(passages) == 1 else 3.4)
    panels = figure.subplots(2, len(passages), sharex="col", sharey="row", height_ratios=[3, 1], squeeze=False)
    for place, one in enumerate(passages):
        panel, below = panels[:, place]
        _draw(panel, one, scale)
        style.style_axes(below)
        below.plot(one.run.times, one.run.rpm, color=style.INK, linewidth=1.4)
        below.set_xlabel("time [s]")
        below.set_xlim(one.run.times[0], one.run.times[-1])
    panels[0, 0].set_ylabel(f"{channel.name} [{unit}]")
    panels[1, 0].set_ylabel("speed [rpm]")
    if len(passages) == 1:
        panels[0, 0].legend(fontsize=style.SMALL, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    else:
        looks, names = panels[0, 0].get_legend_handles_labels()
        figure.legend(looks, names, fontsize=style.SMALL, frameon=False, loc="outside upper center", ncols=len(names))
    figure.align_ylabels(list(panels[:, 0]))
    style.set_title(figure, runs[0].title if title is None else title)
    return figure


@dataclass(frozen=True, eq=False)
class _Passage:
    """Output, values, envelopes and limits of one drawn passage, arrays of shape (n_t,), all in SI."""

    run: PassageResponse
    channel: Channel
    values: FloatArray
    limits: Mapping[str, FloatArray]

    @classmethod
    def of(cls, run: PassageResponse, output: str | None, limits: Mapping[str, ArrayLike]) -> _Passage:
        place = run.output(output or run.outputs[0].name)
        lines = {name: np.broadcast_to(np.asarray(line, dtype=float), run.times.shape) for name, line in limits.items()}
        known = {name: line for name, line in lines.items() if np.isfinite(line).any()}
        return cls(run, run.outputs[place], run.values[:, place], known)

    @property
    def largest(self) -> float:
        return max([float(np.abs(self.values).max()), *(float(np.nanmax(line)) for line in self.limits.values())])


def _draw(panel: Axes, one: _Passage, scale: float) -> None:
    """Draw the vibration of a passage, or the area between its envelopes, its half range, and limits on both sides."""
    style.style_axes(panel)
    run = one.run
    if cycles_above(one.values, 0.0) <= MOST_CYCLES_DRAWN:
        panel.plot(*thin_out(run.times, one.values * scale), color=style.PALETTE[0], linewidth=0.6, label="vibration")
    else:
        middle, low, high = envelopes(run.angles, one.values, run.cycle)
        times = np.interp(middle, run.angles, run.times)
        panel.fill_between(
            times, low * scale, high * scale, color=style.PALETTE[0], alpha=BAND_ALPHA, linewidth=0, label="vibration"
        )
        for edge in (low, high):
            panel.plot(*thin_out(times, edge * scale), color=style.PALETTE[0], linewidth=0.8)
    times, sizes = run.envelope(one.channel.name)
    panel.plot(*thin_out(times, sizes * scale), color=style.INK, linewidth=1.6, label="half range in a cycle")
    for number, (name, line) in enumerate(one.limits.items()):
        dashes = LIMIT_DASHES[number % len(LIMIT_DASHES)]
        for sign in (1, -1):
            panel.plot(
                run.times, sign * line * scale, color=style.LIMIT_COLOR, linestyle=dashes, linewidth=1.4,
                label=name if sign > 0 else None,
            )  # fmt: skip

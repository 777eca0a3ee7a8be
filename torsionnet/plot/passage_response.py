"""Plot of a vibration over time while the speed changes, with the limits that its half range has to keep."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

import torsionnet.plot.drawing.style as style
from torsionnet.plot.drawing.torque_units import axis_unit
from torsionnet.plot.histories import thin_out
from torsionnet.response import Conventions
from torsionnet.response.conventions import SI
from torsionnet.response.passage_response import PassageResponse

LIMIT_DASHES = ("-", (0, (6, 2)), (0, (2, 1.5)))
"""Line styles of matplotlib for the limits drawn over a passage, in the order of the limits."""


def passage_response(
    run: PassageResponse,
    output: str | None = None,
    *,
    limits: Mapping[str, ArrayLike] | None = None,
    conventions: Conventions = SI,
    title: str | None = None,
) -> Figure:
    """Figure of a vibration over time while the speed changes, with half range, limits in red, and the speed below.

    Parameters
    ----------
    run : PassageResponse
    output : str, optional
        By default the first.
    limits : mapping, optional
        Name -> allowed half range in the SI unit of the output, one or (n_t,).
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the response.

    Returns
    -------
    matplotlib.figure.Figure
    """
    place = run.output(output or run.outputs[0].name)
    channel, values = run.outputs[place], run.values[:, place]
    lines = {name: np.broadcast_to(np.asarray(line, dtype=float), run.times.shape) for name, line in
             (limits or {}).items() if np.isfinite(line).any()}  # fmt: skip
    known = [float(np.nanmax(line)) for line in lines.values() if np.isfinite(line).any()]
    scale, unit = axis_unit(channel.unit, max([float(np.abs(values).max()), *known]), conventions)
    figure = style.new_figure(style.WIDTH, 4.0)
    panel, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
    style.style_axes(panel)
    style.style_axes(below)
    panel.plot(*thin_out(run.times, values * scale), color=style.PALETTE[0], linewidth=0.6, label="vibration")
    times, sizes = run.envelope(channel.name)
    panel.plot(times, sizes * scale, color=style.INK, linewidth=1.6, label="half range in a cycle")
    for number, (name, line) in enumerate(lines.items()):
        dashes = LIMIT_DASHES[number % len(LIMIT_DASHES)]
        for sign in (1, -1):
            panel.plot(
                run.times, sign * line * scale, color=style.LIMIT_COLOR, linestyle=dashes, linewidth=1.4,
                label=name if sign > 0 else None,
            )  # fmt: skip
    panel.set_ylabel(f"{channel.name} [{unit}]")
    panel.legend(fontsize=style.SMALL, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    below.plot(run.times, run.rpm, color=style.INK, linewidth=1.4)
    below.set_ylabel("speed [rpm]")
    below.set_xlabel("time [s]")
    below.set_xlim(run.times[0], run.times[-1])
    figure.align_ylabels([panel, below])
    style.set_title(figure, run.title if title is None else title)
    return figure

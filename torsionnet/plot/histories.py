"""Plot of the signals of a recording over time, a panel for each signal, with long signals thinned out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.plot.drawing.torque_units import axis_unit
from torsionnet.signals.recording import FloatArray, Recording

MOST_POINTS = 4000
"""Number of points of a curve above which a signal is thinned out: more than the width of a page in dots."""


def time_histories(
    recording: Recording,
    names: str | Sequence[str] | None = None,
    *,
    conventions: Conventions = SI,
    title: str | None = None,
) -> Figure:
    """Figure of the signals of a recording over time in s, a panel for each, one below the other.

    Of long records the smallest and largest value of every section are drawn, so that no peak is lost. The speed of a
    shaft that never turns back is drawn in rpm.

    Parameters
    ----------
    recording : Recording
    names : str or sequence of str, optional
        By default all signals.
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the recording.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import torsionnet as tn
    >>> record = tn.load("dmf_rig").simulate("theta_1", {"T_M": np.ones(200)}, 1e3)
    >>> [axes.get_ylabel() for axes in time_histories(record, conventions=tn.Conventions(angle="deg")).axes]
    ['T_M [N·m]', 'theta_1 [deg]']
    """
    chosen = recording if names is None else recording.select([names] if isinstance(names, str) else names)
    if not len(chosen):
        raise UsageError("the recording has no samples to plot")
    figure = style.new_figure(style.WIDTH, 1.0 + 1.5 * len(chosen.signals))
    panels = figure.subplots(len(chosen.signals), 1, sharex=True, squeeze=False)[:, 0]
    for number, (panel, signal) in enumerate(zip(panels, chosen, strict=True)):
        style.style_axes(panel)
        largest = float(np.nanmax(np.abs(signal.values), initial=0.0))
        scale, unit = axis_unit(signal.unit, largest, conventions) if signal.unit else (1.0, "unit unknown")
        if signal.unit == "rad/s" and np.nanmin(signal.values) * np.nanmax(signal.values) > 0:
            scale, unit = RPM, "rpm"
        time, values = thin_out(chosen.time, signal.values * scale)
        panel.plot(time, values, color=style.PALETTE[number % len(style.PALETTE)], linewidth=0.7)
        panel.set_ylabel(f"{signal.name} [{unit}]")
    panels[-1].set_xlabel("time [s]")
    panels[-1].set_xlim(chosen.time[0], chosen.time[-1])
    figure.align_ylabels(list(panels))
    style.set_title(figure, recording.title if title is None else title)
    return figure


def thin_out(time: FloatArray, values: FloatArray, most: int = MOST_POINTS) -> tuple[FloatArray, FloatArray]:
    """Arrays of the times in s, and of the values in the signal's unit, of a signal reduced to about ``most`` points.

    Smallest and largest value of every section.

    >>> thin_out(np.arange(8.0), np.array([0, 1, 0, -1, 0, 0, 5, 0.0]), most=4)[1].tolist()
    [-1.0, 1.0, 0.0, 5.0]
    """
    if len(values) <= most:
        return time, values
    length = -(-len(values) // (most // 2))
    whole = len(values) // length * length
    parts = values[:whole].reshape(-1, length)
    low, high = np.nanmin(parts, axis=1), np.nanmax(parts, axis=1)
    starts = time[:whole:length]
    pairs = np.column_stack([low, high]).ravel()
    return np.concatenate([np.repeat(starts, 2), time[whole:]]), np.concatenate([pairs, values[whole:]])

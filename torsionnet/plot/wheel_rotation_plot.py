"""Plot of the speed of toothed wheels over time, and of what counter and teeth leave of the angle uncertain."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.units import RPM
from torsionnet.plot.histories import thin_out
from torsionnet.signals.rotation.wheel_rotation import WheelRotation


def wheel_rotations(wheels: Sequence[WheelRotation], *, title: str = "") -> Figure:
    """Figure of the speeds of wheels in rpm over time, and below of the standard deviation of their angles in deg.

    Thin lines are the share that times of pulses have: counter and jitter. The rest is that of the places of teeth.

    Parameters
    ----------
    wheels : sequence of WheelRotation
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from torsionnet.signals.rotation.pulse_channel import PulseChannel
    >>> from torsionnet.signals import Wheel, wheel_rotation
    >>> channel = PulseChannel("n1", np.round(np.arange(6000) / 601.3, 6), tick=1e-6)
    >>> [axes.get_ylabel() for axes in wheel_rotations([wheel_rotation(channel, Wheel(teeth=60))]).axes]
    ['speed [rpm]', 'deviation of angle [deg]']
    """
    figure = style.new_figure(style.WIDTH, 4.5)
    above, below = figure.subplots(2, 1, sharex=True)
    for number, wheel in enumerate(wheels):
        colour = style.PALETTE[number % len(style.PALETTE)]
        above.plot(*thin_out(wheel.times, wheel.speeds * RPM), color=colour, linewidth=0.7, label=wheel.name)
        times, deviation = thin_out(wheel.times, np.degrees(wheel.angle_deviation))
        below.plot(times, deviation, color=colour, linewidth=1.8, label="" if number else "total")
        of_times = np.degrees(wheel.deviations.time * np.abs(wheel.speeds))
        if of_times.any():
            label = "" if number else "share of counter and jitter"
            below.plot(*thin_out(wheel.times, of_times), color=colour, linewidth=0.7, label=label)
    if any(line.get_ydata().max(initial=0.0) > 0 for line in below.lines):
        below.set_yscale("log")
    above.set_ylabel("speed [rpm]")
    below.set_ylabel("deviation of angle [deg]")
    below.set_xlabel("time [s]")
    below.set_xlim(min(one.times[0] for one in wheels), max(one.times[-1] for one in wheels))
    for axes in (above, below):
        style.style_axes(axes)
    above.legend(loc="best")
    below.legend(loc="best")
    figure.align_ylabels([above, below])
    style.set_title(figure, title)
    return figure

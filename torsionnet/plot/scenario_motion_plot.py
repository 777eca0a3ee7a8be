"""Plot of the motion under a scenario over time, with the events marked."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.plot.histories import time_histories
from torsionnet.signals.motion_event import MotionEvent
from torsionnet.signals.recording import Recording

MOST_LINES = 200
"""Events that are marked by lines; more would cover the curves, and a motion that rattles has thousands."""
MOST_LABELS = 4
"""Events up to which each is named at its line, as their texts would overlap."""


def scenario_motion(
    recording: Recording,
    names: str | Sequence[str] | None = None,
    *,
    conventions: Conventions = SI,
    title: str | None = None,
) -> Figure:
    """Figure of the signals of a simulated motion over time in s, a panel for each, with lines at its events.

    Few events are named; of many the first 200 are marked.

    Parameters
    ----------
    recording : Recording
        Of :meth:`torsionnet.Drivetrain.simulate`.
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
    >>> fault = tn.load("turbine_generator_ssr").simulate("T_LPB_G", scenario="two_phases", sampling_rate=2e3)
    >>> [axes.get_ylabel() for axes in scenario_motion(fault).axes]
    ['torque on generator\\n[MN·m]', 'T_LPB_G\\n[kN·m]']
    """
    figure = time_histories(recording, names, conventions=conventions, title=title)
    panels = figure.axes
    for panel in panels:  # on two lines, as names of torques on nodes are as long as a panel is high
        name, _, unit = panel.get_ylabel().rpartition(" [")
        panel.set_ylabel(f"{name}\n[{unit}")
    for event in recording.events[:MOST_LINES]:
        for panel in panels:
            panel.axvline(event.time, color=style.MUTED, linewidth=0.6, linestyle=(0, (3, 2)), zorder=0.5)
    if len(recording.events) <= MOST_LABELS:
        for event in recording.events:
            _label(figure, event)
    return figure


def _label(figure: Figure, event: MotionEvent) -> None:
    """Name an event above the first panel, towards the side where there is more room."""
    panel = figure.axes[0]
    low, high = panel.get_xlim()
    on_right = event.time < (low + high) / 2
    panel.annotate(
        f"{event.element}: {event.what}",
        (event.time, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(0, 2),
        textcoords="offset points",
        ha="left" if on_right else "right",
        va="bottom",
        fontsize=style.SMALL,
        color=style.INK,
    )

"""Plot of the signals of a recording over time, a panel for each signal, with long signals thinned out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import Channel
from torsionnet.machinery.passage.passage_response import PassageResponse, cycles_above
from torsionnet.plot.drawing.labels import axis_unit
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.signals.recording import FloatArray, MotionEvent, Recording

MOST_POINTS = 4000
"""Number of points of a curve above which a signal is thinned out: more than the width of a page in dots."""


def time_histories(
    recording: Recording,
    names: str | Sequence[str] | None = None,
    *,
    conventions: Conventions = SI,
    title: str | None = None,
    ax: GivenAxes = None,
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
    ax : sequence of Axes, optional
        Axes to draw into, one for each signal; by default those of a new figure.

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
    return _histories(recording, names, conventions, ax).titled(recording.title if title is None else title)


def _histories(
    recording: Recording, names: str | Sequence[str] | None, conventions: Conventions, ax: GivenAxes
) -> style.Sheet:
    """Sheet with a panel for each signal of a recording over time, without title."""
    chosen = recording if names is None else recording.select([names] if isinstance(names, str) else names)
    if not len(chosen):
        raise UsageError("the recording has no samples to plot", kind="missing-data")
    shows = [signal.name for signal in chosen.signals]
    sheet, panels = style.stacked_panels(1.0 + 1.5 * len(shows), shows, ax)
    for number, (panel, signal) in enumerate(zip(panels, chosen, strict=True)):
        largest = float(np.nanmax(np.abs(signal.values), initial=0.0))
        scale, unit = axis_unit(signal.unit, largest, conventions) if signal.unit else (1.0, "unit unknown")
        if signal.unit == "rad/s" and np.nanmin(signal.values) * np.nanmax(signal.values) > 0:
            scale, unit = RPM, "rpm"
        time, values = thin_out(chosen.time, signal.values * scale)
        panel.plot(time, values, color=style.PALETTE[number % len(style.PALETTE)], linewidth=0.7)
        panel.set_ylabel(f"{signal.name} [{unit}]")
    panels[-1].set_xlabel("time [s]")
    panels[-1].set_xlim(chosen.time[0], chosen.time[-1])
    sheet.figure.align_ylabels(panels)
    return sheet


def thin_out(time: FloatArray, values: FloatArray, most: int = MOST_POINTS) -> tuple[FloatArray, FloatArray]:
    """Arrays of the times in s, and of the values in the signal's unit, of a signal reduced to about ``most`` points.

    Smallest and largest value of every section.

    >>> thin_out(np.arange(8.0), np.array([0, 1, 0, -1, 0, 0, 5, 0.0]), most=4)[1].tolist()
    [-1.0, 1.0, 0.0, 5.0]
    """
    if len(values) <= most:
        return time, values
    # Two points a section, rounded up; what is left behind the last whole section stays as it is.
    length = -(-len(values) // (most // 2))
    whole = len(values) // length * length
    parts = values[:whole].reshape(-1, length)
    low, high = np.nanmin(parts, axis=1), np.nanmax(parts, axis=1)
    starts = time[:whole:length]
    pairs = np.column_stack([low, high]).ravel()
    return np.concatenate([np.repeat(starts, 2), time[whole:]]), np.concatenate([pairs, values[whole:]])


# Plot of a vibration over time while the speed changes, with the limits that its half range has to keep.

LIMIT_DASHES = ("-", (0, (6, 2)), (0, (2, 1.5)))
"""Line styles of matplotlib for the limits drawn over a passage, in the order of the limits."""
MOST_CYCLES_DRAWN = 100
"""Number of cycles of a vibration up to which it is drawn as a line: more of them on the width of a page run into one
area, of which the envelope says more."""
BAND_ALPHA = 0.3
"""Opacity of the area between the envelopes, through which the grid and the limits can be seen."""


def passage_response(
    response: PassageResponse | Sequence[PassageResponse],
    output: str | None = None,
    *,
    limits: Mapping[str, ArrayLike] | Sequence[Mapping[str, ArrayLike]] | None = None,
    conventions: Conventions = SI,
    title: str | None = None,
    ax: GivenAxes = None,
) -> Figure:
    """Figure of a vibration over time while the speed changes, with half range, limits in red, and the speed below.

    Of many cycles the area between the upper and the lower envelope is drawn, largest and smallest value in each cycle.
    Several passages stand beside each other, with one axis for their values and each with its own time.

    Parameters
    ----------
    response : PassageResponse or sequence of these
        Several of one output have the same unit, such as a quick and a slow passage of one range.
    output : str, optional
        By default the first.
    limits : mapping, or sequence of these, optional
        Name -> allowed half range in the SI unit of the output, one or (n_t,); of several passages one for each.
    conventions : Conventions, optional
        Unit of angles.
    title : str, optional
        By default that of the first response.
    ax : sequence of Axes, optional
        Axes to draw into, for the vibration and the speed, each of all passages; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    runs = [response] if isinstance(response, PassageResponse) else list(response)
    given = [limits] * len(runs) if limits is None or isinstance(limits, Mapping) else list(limits)
    passages = [_Passage.of(run, output, lines or {}) for run, lines in zip(runs, given, strict=True)]
    channel = passages[0].channel
    scale, unit = axis_unit(channel.unit, max(passage.largest for passage in passages), conventions)
    shows = [f"{what} of {run.title}" for what in (channel.name, "speed") for run in runs]
    sheet, panels = style.grid_panels(
        style.WIDTH, 4.0 if len(runs) == 1 else 3.4, shows, ax, columns=len(runs), sharex="col", sharey="row",
        height_ratios=[3, 1],
    )  # fmt: skip
    for place, passage in enumerate(passages):
        panel, below = panels[:, place]
        _draw(panel, passage, scale)
        style.style_axes(below)
        below.plot(passage.run.times, passage.run.rpm, color=style.INK, linewidth=1.4)
        below.set_xlabel("time [s]")
        below.set_xlim(passage.run.times[0], passage.run.times[-1])
    panels[0, 0].set_ylabel(f"{channel.name} [{unit}]")
    panels[1, 0].set_ylabel("speed [rpm]")
    if len(passages) == 1:
        style.legend_beside(panels[0, 0])
    else:
        looks, names = panels[0, 0].get_legend_handles_labels()
        sheet.legend(len(names), looks, names, above=True)
    sheet.figure.align_ylabels(list(panels[:, 0]))
    return sheet.titled(runs[0].title if title is None else title)


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


def _draw(panel: Axes, passage: _Passage, scale: float) -> None:
    """Draw the vibration of a passage, or the area between its envelopes, its half range, and limits on both sides."""
    style.style_axes(panel)
    run = passage.run
    if cycles_above(passage.values, 0.0) <= MOST_CYCLES_DRAWN:
        panel.plot(
            *thin_out(run.times, passage.values * scale), color=style.PALETTE[0], linewidth=0.6, label="vibration"
        )
    else:
        times, low, high = run.bounds(passage.channel.name)
        panel.fill_between(
            times, low * scale, high * scale, color=style.PALETTE[0], alpha=BAND_ALPHA, linewidth=0, label="vibration"
        )
        for edge in (low, high):
            panel.plot(*thin_out(times, edge * scale), color=style.PALETTE[0], linewidth=0.8)
    times, sizes = run.envelope(passage.channel.name)
    panel.plot(*thin_out(times, sizes * scale), color=style.INK, linewidth=1.6, label="half range in a cycle")
    for number, (name, line) in enumerate(passage.limits.items()):
        dashes = LIMIT_DASHES[number % len(LIMIT_DASHES)]
        for sign in (1, -1):
            panel.plot(
                run.times, sign * line * scale, color=style.LIMIT_COLOR, linestyle=dashes, linewidth=1.4,
                label=name if sign > 0 else None,
            )  # fmt: skip


# Plot of the motion under a scenario over time, with the events marked.

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
    ax: GivenAxes = None,
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
    ax : sequence of Axes, optional
        Axes to draw into, one for each signal; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import torsionnet as tn
    >>> fault = tn.load("turbine_generator_ssr").simulate("T_LPB_G", scenario="two_phases", sampling_rate=2e3)
    >>> [axes.get_ylabel() for axes in scenario_motion(fault).axes]
    ['torque on generator\\n[kN·m]', 'T_LPB_G\\n[kN·m]']
    """
    sheet = _histories(recording, names, conventions, ax)
    panels = sheet.panels
    for panel in panels:  # on two lines, as names of torques on nodes are as long as a panel is high
        name, _, unit = panel.get_ylabel().rpartition(" [")
        panel.set_ylabel(f"{name}\n[{unit}")
    for event in recording.events[:MOST_LINES]:
        for panel in panels:
            panel.axvline(event.time, color=style.MUTED, linewidth=0.6, linestyle=(0, (3, 2)), zorder=0.5)
    if len(recording.events) <= MOST_LABELS:
        for event in recording.events:
            _label(panels[0], event)
    return sheet.titled(recording.title if title is None else title)


def _label(panel: Axes, event: MotionEvent) -> None:
    """Name an event above a panel, towards the side where there is more room."""
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

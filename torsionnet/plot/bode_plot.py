"""Plots of frequency responses: Bode plots with coherence, and Nyquist plots of control loops with their margins."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError, remedy
from torsionnet.base.number_text import typeset_unit
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.linear.phase import HALF_TURN, unwrapped_phase
from torsionnet.plot.drawing.style import GivenAxes
from torsionnet.signals.uncertainty import above_noise_up_to, is_coherent

if TYPE_CHECKING:
    from torsionnet.linear.responses.loop_margins import LoopMargins


# Bode plot of frequency responses, with panels of magnitude, phase and coherence over frequency.

LEAST_CONDITIONING = 1e-10
"""Least conditioning of a measured input at a frequency, below which a Bode plot is shaded as not to be trusted."""

AXIS_BEYOND_COHERENCE = 1.5
"""Factor from the highest usable or coherent frequency of an estimate to the end of the frequency axis; beyond is only
noise."""
CONSTANT_MAGNITUDE = 1e-9
"""Range of magnitudes divided by the largest one, below which a curve counts as constant but for rounding errors."""
TOO_SMALL, NOT_COHERENT = "motion too small for its sensor, or beyond decimation", "not coherent with the input"
PANEL_HEIGHTS = {"magnitude": 3.0, "phase": 2.0, "coherence": 1.0}
"""Heights of the panels of a Bode plot, in parts of the figure's."""
SHORT_LABEL = 14
"""Number of letters of a label below which five labels fit side by side in the legend."""
LONGEST_LABEL = 32
"""Largest number of letters with which the label of the magnitude axis has full size; a longer one is set smaller."""
FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Curve:
    """Curve of a Bode plot, with arrays of frequency, magnitude, phase in degrees, coherence, and flags where usable.

    Arrays have shape (n_f,); the magnitude is nan where it is infinite or zero.
    """

    label: str
    frequency: FloatArray
    magnitude: FloatArray
    phase: FloatArray
    coherence: FloatArray | None
    poor: NDArray[np.bool_]
    is_usable: NDArray[np.bool_]
    is_meant: NDArray[np.bool_]
    """Flags (n_f,), true at frequencies at which the response is usable or at least coherent and has to fit the
    axes."""
    why_faint: str = ""
    """Text of the legend that says why the faint part of the curve is not usable."""
    pair: str = ""
    """Name of the transfer function of the curve, output over input, as ``theta_1/T_T``."""
    name: str = ""
    """Label of the frequency response to which the curve belongs, where several responses are drawn."""


def bode(
    responses: FrequencyResponse | Sequence[FrequencyResponse],
    *,
    output: str | Sequence[str] | None = None,
    input: str | Sequence[str] | None = None,
    conventions: Conventions = SI,
    decibels: bool = False,
    x_log: bool = True,
    coherence: bool | None = None,
    labels: Sequence[str] | None = None,
    title: str | None = None,
    ax: GivenAxes = None,
) -> Figure:
    """Figure of magnitude and phase of one or several frequency responses over frequency, overlaid.

    They belong to several configurations, or to a model and a test.

    Parameters
    ----------
    responses : FrequencyResponse or sequence of these
    output, input : str or sequence of str, optional
        Which transfer functions; by default all. They must have one unit.
    conventions : Conventions, optional
        Units of angle and frequency, reference of the decibels.
    decibels : bool, optional
        Magnitude in dB instead of on a logarithmic scale.
    x_log : bool, optional
        Logarithmic frequency; a response at 0 Hz is then left out.
    coherence : bool, optional
        Whether to show the coherence; by default where there is one.
    labels : sequence of str, optional
        One for each response; by default what tells their titles apart.
    title : str, optional
        By default what the titles have in common.
    ax : sequence of Axes, optional
        Axes to draw into, for magnitude, phase and, if shown, coherence; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
        Magnitude, phase and, if shown, coherence. Phases are continuous, and a curve begins within -180 to 180 degrees.

    Raises
    ------
    UsageError
        An unknown name, transfer functions of different units, or a coherence that nobody estimated.

    Examples
    --------
    >>> import torsionnet as tn
    >>> response = tn.load("dmf_rig").frequency_response("theta_1", "T_T", [1, 2, 5, 10, 20])
    >>> bode(response, conventions=tn.Conventions(angle="deg")).axes[0].get_ylabel()
    '|theta_1/T_T| [deg/(N·m)]'
    """
    given = [responses] if isinstance(responses, FrequencyResponse) else list(responses)
    if not given:
        raise UsageError("there is no frequency response to plot", kind="missing-data")
    chosen = [response.select(output, input) for response in given]
    unit = _common_unit(chosen, conventions)
    common, names = _labels(chosen, labels)
    curves = [
        curve
        for response, name in zip(chosen, names, strict=True)
        for curve in _curves(response, name, conventions, x_log=x_log)
    ]
    panels = _panels(curves, coherence)
    shares = [PANEL_HEIGHTS[name] for name in panels]
    sheet, axes = style.stacked_panels(3.0 + 1.3 * (len(panels) - 1), panels, ax, shares=shares)
    sheet.figure.align_ylabels(axes)
    _draw(axes, panels, curves, decibels=decibels, conventions=conventions)
    _dress_frequency(axes, curves, conventions, x_log=x_log)
    _dress_magnitude(axes[0], _pair(chosen), unit, decibels=decibels, conventions=conventions)
    _legend(sheet, curves)
    return sheet.titled(common if title is None else title)


def _common_unit(responses: Sequence[FrequencyResponse], conventions: Conventions) -> str:
    units = {
        response.unit(o, i, conventions)
        for response in responses
        for o in range(len(response.outputs))
        for i in range(len(response.inputs))
    }
    if len(units) != 1:
        chosen = f"choose with {remedy('output=')} and {remedy('input=')}"
        text = f"transfer functions in {', '.join(sorted(units))} do not fit on one axis; {chosen}"
        raise UsageError(text, kind="wrong-unit")
    return units.pop()


def _labels(responses: Sequence[FrequencyResponse], labels: Sequence[str] | None) -> tuple[str, list[str]]:
    """Text common to the titles of several frequency responses, and list with a label for each response."""
    titles = [response.title for response in responses]
    models = {response.model for response in responses}
    is_one = len(set(titles)) == 1
    common = titles[0] if is_one else models.pop() if len(models) == 1 else ""
    if labels is not None:
        if len(labels) != len(responses):
            raise UsageError(f"{len(labels)} labels were given for {len(responses)} responses", kind="wrong-count")
        return common, list(labels)
    if len(responses) == 1:
        return common, [""]
    if not common:
        return common, titles
    return common, ["" if is_one else response.configuration for response in responses]


def _curves(response: FrequencyResponse, label: str, conventions: Conventions, *, x_log: bool) -> list[Curve]:
    shown = response.frequencies > 0 if x_log else np.full(len(response.frequencies), fill_value=True)
    poor = (
        np.zeros(len(shown), dtype=bool)
        if response.conditioning is None
        else response.conditioning < LEAST_CONDITIONING
    )
    several = len(response.outputs) * len(response.inputs) > 1
    curves = []
    for o, out in enumerate(response.outputs):
        is_usable, is_meant = (where[shown] for where in _where_meant(response, o))
        for i, into in enumerate(response.inputs):
            values = response.values[shown, o, i]
            size = np.abs(values) * response.scale(conventions, o, i)
            pair = f"{out.name}/{into.name}" if several or not label else ""
            coherence = None if response.coherence is None else response.coherence[shown, o, i]
            curves.append(
                Curve(
                    ", ".join(text for text in (label, pair) if text),
                    response.frequencies[shown] * conventions.frequency_scale,
                    np.where(np.isfinite(size) & (size > 0), size, np.nan),
                    # The phase of what is not coherent is any, and its turns would be counted into all that follows.
                    unwrapped_phase(np.where(is_meant, values, np.nan)),
                    coherence,
                    poor[shown],
                    is_usable,
                    is_meant,
                    NOT_COHERENT if response.usable_up_to is None else TOO_SMALL,
                    f"{out.name}/{into.name}",
                    label,
                )
            )
    return curves


def _where_meant(response: FrequencyResponse, output: int) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Flags (n_f,), true at frequencies where an output is usable, and flags (n_f,) where it is usable or coherent.

    All are true in the second if none is.
    """
    is_usable = np.asarray(response.frequencies <= above_noise_up_to(response, output))
    meant = is_usable | is_coherent(response, output)
    return is_usable, meant if meant.any() else np.ones_like(meant)


def _panels(curves: Sequence[Curve], coherence: bool | None) -> list[str]:
    available = any(curve.coherence is not None for curve in curves)
    if coherence and not available:
        raise UsageError(
            "none of the responses has a coherence: only estimates from recorded signals have", kind="missing-data"
        )
    wanted = available if coherence is None else coherence
    return ["magnitude", "phase", *(["coherence"] if wanted else [])]


def _draw(
    axes: Sequence[Axes], panels: Sequence[str], curves: Sequence[Curve], *, decibels: bool, conventions: Conventions
) -> None:
    for curve, look in zip(curves, _line_styles(curves), strict=True):
        size = 20 * np.log10(curve.magnitude / conventions.db_reference) if decibels else curve.magnitude
        for panel, data in zip(axes, (size, curve.phase, curve.coherence), strict=False):
            if data is not None:
                _line(panel, curve, data, look)
        for low, high in _stretches(curve):
            for panel in axes:
                panel.axvspan(low, high, color=style.FAINT, alpha=0.7, linewidth=0, zorder=0.5)
    # Noise beyond the resolution of a sensor may run off the picture; it sets no limits.
    phases = [curve.phase[np.isfinite(curve.phase) & curve.is_meant] for curve in curves]
    every = np.concatenate(phases)
    sizes = np.concatenate([curve.magnitude[curve.is_meant] for curve in curves])
    sizes = sizes[np.isfinite(sizes)]
    if not all(curve.is_meant.all() for curve in curves) or _is_constant(sizes):
        _make_room(axes[0], sizes, decibels=decibels, conventions=conventions)
    axes[1].set_ylabel("phase [deg]")
    style.phase_ticks(axes[1], *((every.min(), every.max()) if every.size else (-HALF_TURN, 0.0)))
    if "coherence" in panels:
        axes[2].set_ylabel("coherence [-]")
        axes[2].set_ylim(0, 1.05)


def _is_constant(sizes: FloatArray) -> bool:
    """Whether magnitudes are constant but for rounding errors, which an axis must not enlarge."""
    return bool(sizes.size) and float(np.ptp(sizes)) < CONSTANT_MAGNITUDE * float(sizes.max())


def _line_styles(curves: Sequence[Curve]) -> list[dict[str, Any]]:
    """List of the colours and dashes of the curves of a Bode plot, as keyword arguments of matplotlib.

    By output and input, or by transfer function and response of several ones.
    """
    sides = [(curve.pair, curve.name) for curve in curves]
    if len({name for _, name in sides}) == 1:
        sides = [(output, into) for output, _, into in (curve.pair.rpartition("/") for curve in curves)]
    firsts, seconds = (list(dict.fromkeys(side[index] for side in sides)) for index in (0, 1))
    if len(set(sides)) < len(sides):
        return [style.line_style(number) for number in range(len(curves))]
    sizes = (len(firsts), len(seconds))
    return [style.paired_style(firsts.index(first), seconds.index(other), sizes) for first, other in sides]


def _make_room(panel: Axes, sizes: FloatArray, *, decibels: bool, conventions: Conventions) -> None:
    if sizes.size:
        low, high = 0.6 * float(sizes.min()), 1.7 * float(sizes.max())
        reference = conventions.db_reference
        panel.set_ylim(*(20 * np.log10(np.array([low, high]) / reference) if decibels else (low, high)))


def _line(panel: Axes, curve: Curve, data: FloatArray, look: dict[str, Any]) -> None:
    """Draw a curve in a panel of a Bode plot, faint at frequencies where the response is not usable."""
    marker = "." if np.count_nonzero(np.isfinite(data)) == 1 else ""
    panel.plot(curve.frequency, np.where(curve.is_usable, data, np.nan), label=curve.label, marker=marker, **look)
    if not curve.is_usable.all():
        first = max(int(np.argmin(curve.is_usable)) - 1, 0)
        faint = {**look, "linewidth": 0.8, "alpha": 0.35}
        panel.plot(curve.frequency[first:], data[first:], **faint)


def _stretches(curve: Curve) -> list[tuple[float, float]]:
    """Pairs of ends, in the unit shown, of the frequency ranges where the measured input is too small to divide by.

    Ranges are widened by half a step.
    """
    if not curve.poor.any():
        return []
    f = curve.frequency
    middles = np.concatenate([f[:1], (f[1:] + f[:-1]) / 2, f[-1:]])
    edges = np.flatnonzero(np.diff(np.concatenate([[0], curve.poor.astype(int), [0]])))
    return [(float(middles[start]), float(middles[end])) for start, end in edges.reshape(-1, 2)]


def _dress_frequency(axes: Sequence[Axes], curves: Sequence[Curve], conventions: Conventions, *, x_log: bool) -> None:
    every = np.concatenate([_shown_frequencies(curve) for curve in curves])
    last = axes[-1]
    last.set_xlabel(f"frequency [{conventions.frequency}]")
    if x_log:
        last.set_xscale("log")
    if every.size and every.min() < every.max():
        last.set_xlim(every.min(), every.max())
    if x_log and every.size:
        style.log_ticks(last.xaxis, float(every.min()), float(every.max()))


def _shown_frequencies(curve: Curve) -> FloatArray:
    """Frequencies of a curve in the unit shown, shape (n,), up to a little beyond the last coherent frequency."""
    if curve.coherence is None:
        return curve.frequency
    highest = float(curve.frequency[curve.is_meant].max(initial=0.0))
    return np.asarray(curve.frequency[curve.frequency <= AXIS_BEYOND_COHERENCE * highest])


def _pair(responses: Sequence[FrequencyResponse]) -> str:
    """Text for the label of a Bode plot's magnitude axis, ``|theta_1/T_T|``, or "magnitude" for several functions."""
    pairs = {
        f"{out.name}/{into.name}" for response in responses for out in response.outputs for into in response.inputs
    }
    return f"|{pairs.pop()}|" if len(pairs) == 1 else "magnitude"


def _dress_magnitude(axes: Axes, what: str, unit: str, *, decibels: bool, conventions: Conventions) -> None:
    shown = typeset_unit(unit) if unit != "1" else "-"
    if decibels:
        reference = f"{conventions.db_reference:g}" + (f" {shown}" if unit != "1" else "")
        axes.set_ylabel(f"{what} [dB re {reference}]")
        return
    text = f"{what} [{shown}]"
    axes.set_ylabel(text, fontsize=style.FONT * min(1.0, LONGEST_LABEL / len(text)))
    axes.set_yscale("log")
    style.log_ticks(axes.yaxis, *axes.get_ylim())


def _legend(sheet: style.Sheet, curves: Sequence[Curve]) -> None:
    """Draw the legend below the axes of a Bode plot, with the meaning of faint curves and shaded frequency ranges."""
    handles, names = sheet.panels[0].get_legend_handles_labels()
    if len(curves) == 1 and "/" in curves[0].label:
        handles, names = [], []
    if any(curve.poor.any() for curve in curves):
        handles.append(Patch(color=style.FAINT))
        names.append("measured input nearly zero: not to be trusted")
    for reason in dict.fromkeys(curve.why_faint for curve in curves if not curve.is_usable.all()):
        handles.append(Line2D([], [], color=style.MUTED, linewidth=0.8, alpha=0.5))
        names.append(f"faint: {reason}")
    if handles:
        is_short = all(len(curve.label) < SHORT_LABEL for curve in curves)
        columns = min(len(names), 5 if is_short else 2)
        sheet.legend(columns, handles, names, handlelength=3)


# Nyquist plot of a control loop opened at its controller, with the stability margins.

SMALLEST_LOOP = 0.01
"""Smallest loop gain |L| of the frequencies shown, as a share of the largest gain if that is below 1; they end at its
reciprocal."""
LARGEST_LOOP = 3.0
"""Loop gain |L| up to which the loop is drawn to scale in the complex plane; a larger L is drawn at this distance, so
that -1 stays visible."""


def nyquist(margins: LoopMargins, *, title: str | None = None, ax: GivenAxes = None) -> Figure:
    """Figure of the open control loop L(j omega) in the complex plane, and its magnitude and phase over frequency.

    Parameters
    ----------
    margins : LoopMargins
        Result of :meth:`torsionnet.Drivetrain.loop_margins`.
    title : str, optional
        By default the controller at which the loop is opened.
    ax : sequence of Axes, optional
        Axes to draw into, for the complex plane, magnitude and phase; by default those of a new figure.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.Drivetrain("governed", [tn.Inertia("rotor", node="a", inertia=2),
    ...     tn.Controller("governor", sense={"velocity": "a"}, act="a", law=-30, delay="50 ms")])
    >>> [axes.get_xlabel() for axes in nyquist(rig.loop_margins()).axes]
    ['real part of L', '', 'frequency [Hz]']
    """
    shows = [["complex plane", "magnitude"], ["complex plane", "phase"]]
    sheet = style.mosaic_panels(4.1, shows, ax, width_ratios=(1.1, 1))
    plane, size, phase = sheet.panels
    style.share_axis(phase, size, "sharex")
    _plane(plane, margins)
    _over_frequency(size, phase, margins)
    sheet.legend(3)
    words = f"{margins.title}: loop opened at {margins.controller}"
    words += "" if margins.stable else " (unstable)"
    return sheet.titled(words if title is None else title)


def _plane(axes: Axes, margins: LoopMargins) -> None:
    style.style_axes(axes)
    loop = margins.loop * np.minimum(1, LARGEST_LOOP / np.maximum(np.abs(margins.loop), 1e-300))
    axes.plot(loop.real, loop.imag, color=style.PALETTE[0], linewidth=1.4, label="L, frequency > 0")
    # L(-j omega) is the conjugate of L(j omega).
    axes.plot(loop.real, -loop.imag, color=style.PALETTE[0], linewidth=0.7, linestyle="--")
    turn = np.linspace(0, 2 * np.pi, 361)
    axes.plot(np.cos(turn), np.sin(turn), color=style.INK, linewidth=0.6, alpha=0.5)
    axes.plot([-1], [0], "+", color=style.PALETTE[1], markersize=10, markeredgewidth=2, label="-1")
    # k L is -1 where L = -1/k, and L exp(-j phi) is -1 where L = -exp(j phi).
    if math.isfinite(margins.gain_increase.value):
        text = f"gain × {margins.gain_increase.value:.3g}"
        axes.plot([-1 / margins.gain_increase.value], [0], "D", color=style.PALETTE[2], markersize=4, label=text)
    if math.isfinite(margins.phase.value):
        point = -np.exp(1j * math.radians(margins.phase.value))
        text = f"phase {margins.phase.value:.3g}°"
        axes.plot([point.real], [point.imag], "o", color=style.PALETTE[3], markersize=5, label=text)
    axes.set_aspect("equal")
    axes.set_xlabel("real part of L")
    axes.set_ylabel("imaginary part of L")


def _over_frequency(size: Axes, phase: Axes, margins: LoopMargins) -> None:
    for axes in (size, phase):
        style.style_axes(axes)
        axes.set_xscale("log")
    shown = _shown_range(margins)
    f, loop = margins.frequencies[shown], margins.loop[shown]
    size.loglog(f, np.abs(loop), color=style.PALETTE[0], linewidth=1.2)
    size.axhline(1, color=style.INK, linewidth=0.6)
    size.set_ylabel("|L|")
    phase.plot(*_broken(f, np.degrees(np.angle(loop))), color=style.PALETTE[0], linewidth=1.2)
    if len(f) > 1:
        phase.set_xlim(f[0], f[-1])
    phase.set_ylabel("phase of L [°]")
    phase.set_yticks([-180, -90, 0, 90, 180])
    phase.set_xlabel("frequency [Hz]")
    for margin, color in ((margins.gain_increase, style.PALETTE[2]), (margins.phase, style.PALETTE[3])):
        if math.isfinite(margin.frequency):
            for axes in (size, phase):
                axes.axvline(margin.frequency, color=color, linewidth=0.8)


def _shown_range(margins: LoopMargins) -> slice:
    """Slice of the frequencies from the first to the last at which a control loop's gain |L| is in the range shown."""
    sizes = np.abs(margins.loop)
    low, high = SMALLEST_LOOP * min(1.0, float(sizes.max(initial=0.0))), 1 / SMALLEST_LOOP
    places = np.flatnonzero((sizes >= low) & (sizes <= high))
    return slice(int(places[0]), int(places[-1]) + 1) if len(places) > 1 else slice(None)


def _broken(f: FloatArray, degrees: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Arrays of frequencies in Hz, and of phases from -180 to 180 degrees, with a gap (nan) where the phase jumps."""
    jumps = np.flatnonzero(np.abs(np.diff(degrees)) > 180) + 1
    return np.insert(f, jumps, np.nan), np.insert(degrees, jumps, np.nan)

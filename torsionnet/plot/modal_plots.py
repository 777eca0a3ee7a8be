"""Plots of modes found in tests: stabilisation diagram, circle fit, modal assurance criterion, run-up and decay."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.number_text import typeset_unit
from torsionnet.modal import cmif
from torsionnet.modal.matrix_fraction import Stabilisation
from torsionnet.modal.modal_estimate import ModalEstimate
from torsionnet.modal.operational.ambient_modes import AmbientPoles, OperationalModes
from torsionnet.modal.operational.decay_modes import DecayFit
from torsionnet.modal.operational.run_up_modes import SweptFit
from torsionnet.plot.drawing.style import GivenAxes

if TYPE_CHECKING:
    from torsionnet.modal.circle_fitting import CircleFit


# Stabilisation diagram with poles by the order of the fit over frequency, and the responses' mode indicator.

FloatArray = NDArray[np.float64]
MARKS = (
    ("new", "x", style.MUTED, "pole"),
    ("frequency", ".", style.PALETTE[6], "stable in frequency"),
    ("damping", "o", style.PALETTE[5], "and in damping"),
    ("stable", "P", style.PALETTE[2], "and in shape"),
)
MOST_CURVES = 3
"""Largest number of singular values of the mode indicator that are drawn; further ones are mostly noise."""
ROUND_OFF = 1e-12
"""Relative margin of the frequency band, which keeps rounding from cutting off its first or last frequency."""
LABEL_DISTANCE = 0.022
"""Least distance of two neighbouring labels of modes, as a share of the width of the axes: a line of text."""


def stabilisation(
    diagram: Stabilisation,
    estimate: ModalEstimate | None = None,
    *,
    conventions: Conventions = SI,
    title: str | None = None,
    ax: Axes | None = None,
) -> Figure:
    """Stabilisation diagram, order of the fit over natural frequency of the poles, with the mode indicator (CMIF).

    Parameters
    ----------
    diagram : Stabilisation
    estimate : ModalEstimate, optional
        Its modes are marked by lines with natural frequency and damping ratio.
    conventions : Conventions, optional
        Unit of the frequencies.
    title : str, optional
        By default the title of the responses.
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
        Poles far beyond the band are not shown.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("dmf_rig")
    >>> response = rig.frequency_response("theta_1", "T_T", [0.5 * k for k in range(1, 61)])
    >>> stabilisation(tn.modal.stabilisation(response)).axes[0].get_ylabel()
    'order of the fit'
    """
    sheet, ((orders,),) = style.grid_panels(style.WIDTH, 4.6, [""], ax)
    level = orders.twinx()
    scale = conventions.frequency_scale
    _indicator(level, diagram, scale)
    _poles(orders, diagram, scale)
    style.style_axes(orders)
    orders.set_zorder(level.get_zorder() + 1)
    orders.patch.set_visible(False)
    low, high = np.abs(diagram.lines.s[[0, -1]]) / (2 * np.pi) * scale
    margin = 0.02 * (high - low)
    orders.set_xlim(low - margin, high + margin)
    orders.set_ylim(0, len(diagram.orders) + 1)
    if estimate is not None:
        _modes(orders, estimate, (low - margin, high + margin), conventions)
    orders.set_xlabel(f"natural frequency |λ|/2π [{conventions.frequency}]")
    orders.set_ylabel("order of the fit")
    sheet.legend(4)
    return sheet.titled(diagram.response.title if title is None else title)


def _indicator(axes: Axes, diagram: Stabilisation, scale: float) -> None:
    low, high = np.abs(diagram.lines.s[[0, -1]]) / (2 * np.pi)
    response = diagram.response.between(low * (1 - ROUND_OFF), high * (1 + ROUND_OFF))
    curves = cmif(response)[:, :MOST_CURVES]
    positive = (response.frequencies > 0) & np.isfinite(curves).all(axis=1) & (curves[:, :1] > 0).all(axis=1)
    for number, curve in enumerate(curves.T):
        width = 1.4 if number == 0 else 0.8
        axes.semilogy(response.frequencies[positive] * scale, curve[positive], color=style.MUTED, linewidth=width)
    units = {response.unit(o, i) for o in range(len(response.outputs)) for i in range(len(response.inputs))}
    unit = typeset_unit(units.pop()) if len(units) == 1 else "relative"
    axes.set_ylabel(f"CMIF [{unit}]", fontsize=style.FONT, color=style.MUTED)
    axes.tick_params(which="both", labelsize=style.SMALL, color=style.MUTED, labelcolor=style.MUTED)
    for spine in axes.spines.values():
        spine.set_visible(False)


def _poles(axes: Axes, diagram: Stabilisation, scale: float) -> None:
    groups: dict[str, list[tuple[float, int]]] = {name: [] for name, *_ in MARKS}
    for order in diagram.orders:
        frequencies = np.abs(order.poles) / (2 * np.pi) * scale
        for place, frequency in enumerate(frequencies):
            steps = (order.frequency[place], order.damping[place], order.shape[place])
            kind = ("new", "frequency", "damping", "stable")[steps.index(False) if False in steps else 3]
            groups[kind].append((float(frequency), order.order))
    for name, marker, color, words in MARKS:
        points = np.array(groups[name]).reshape(-1, 2)
        axes.plot(points[:, 0], points[:, 1], marker, color=color, markersize=5, linestyle="", label=words)


def _modes(axes: Axes, estimate: ModalEstimate, band: tuple[float, float], conventions: Conventions) -> None:
    """Draw a vertical line at each mode in the band, with natural frequency and damping ratio above the axes."""
    scale = conventions.frequency_scale
    low, high = band
    shown = [mode for mode in range(len(estimate)) if estimate.natural_frequencies[mode] * scale <= high]
    places = estimate.natural_frequencies[shown] * scale
    for place, mode, name in zip(places, shown, _apart(places, LABEL_DISTANCE * (high - low), high), strict=True):
        damping = f"{100 * estimate.damping_ratios[mode]:.3g} %" if estimate.poles[mode].imag else "real pole"
        axes.axvline(place, color=style.PALETTE[1], linewidth=1.0, zorder=0)
        axes.annotate(
            f"{place:.4g} {conventions.frequency}, {damping}",
            (place, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(name, 1.04),
            textcoords=("data", "axes fraction"),
            rotation=90,
            ha="center",
            va="bottom",
            fontsize=style.SMALL - 1,
            color=style.PALETTE[1],
            arrowprops={"arrowstyle": "-", "color": style.PALETTE[1], "linewidth": 0.6, "shrinkA": 0, "shrinkB": 0},
        )


def _apart(places: FloatArray, distance: float, end: float) -> list[float]:
    """Rising places of labels in units of the axis, moved as little as needed to stay apart and within its end."""
    moved: list[float] = []
    for place in places:
        moved.append(max(float(place), moved[-1] + distance) if moved else float(place))
    for number in range(len(moved) - 1, -1, -1):
        limit = end if number == len(moved) - 1 else moved[number + 1] - distance
        moved[number] = min(moved[number], limit)
    return moved


# Plot of the circle fitted to a mode in Nyquist's plane, and of the damping ratio from every pair of points.


def circle(fit: CircleFit, *, title: str | None = None, ax: GivenAxes = None) -> Figure:
    """Figure of the circle fitted to a mode in Nyquist's plane, and of damping ratios over distances of points in Hz.

    If the damping ratios on the right are level, a single mode with this law of damping explains the circle; a slope
    means that it does not.

    Parameters
    ----------
    fit : CircleFit
    title : str, optional
        By default the label of the fit, with natural frequency and damping ratio.
    ax : sequence of Axes, optional
        Axes to draw into, for the circle and the damping ratios; by default those of a new figure.

    Examples
    --------
    >>> import torsionnet as tn
    >>> response = tn.load("dmf_rig").frequency_response("theta_1", "T_T", [0.1 * k for k in range(1, 301)])
    >>> [axes.get_xlabel() for axes in circle(tn.modal.circle_fit(response, near=8)).axes]
    ['real part [rad/s/(N·m)]', 'distance of the two points [Hz]']
    """
    sheet = style.mosaic_panels(
        3.9, [["Nyquist's plane", "damping ratios of pairs of points"]], ax, width_ratios=(1.1, 1)
    )
    plane, pairs = sheet.panels
    _plane(plane, fit)
    _pairs(pairs, fit)
    sheet.legend(3)
    spread = f"{100 * fit.spread:.2g}"
    words = f"{fit.label}: {fit.natural_frequency:.4g} Hz, {100 * fit.damping_ratio:.3g} % ± {spread} % over the pairs"
    return sheet.titled(words if title is None else title)


def _plane(axes: Axes, fit: CircleFit) -> None:
    turn = np.linspace(0, 2 * np.pi, 361)
    around = fit.center + fit.radius * np.exp(1j * turn)
    axes.plot(around.real, around.imag, color=style.PALETTE[0], linewidth=1.2, label="circle")
    axes.plot(fit.points.real, fit.points.imag, "o", color=style.INK, markersize=3, label="lines of the response")
    top = fit.center + fit.radius * np.exp(1j * fit.angle)
    axes.plot([fit.center.real, top.real], [fit.center.imag, top.imag], color=style.PALETTE[1], linewidth=1.0)
    label = f"resonance, {fit.natural_frequency:.4g} Hz"
    axes.plot(top.real, top.imag, "D", color=style.PALETTE[1], markersize=5, label=label)
    for place in (0, len(fit.points) - 1):
        point = fit.points[place]
        away = (point - fit.center) / abs(point - fit.center)
        axes.annotate(
            f"{fit.frequencies[place]:.4g} Hz",
            (point.real, point.imag),
            xytext=(12 * away.real, 12 * away.imag),
            textcoords="offset points",
            fontsize=style.SMALL,
            ha="left" if away.real > 0 else "right",
            va="center",
        )
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.15)
    unit = typeset_unit(fit.unit)
    axes.set_xlabel(f"real part [{unit}]")
    axes.set_ylabel(f"imaginary part [{unit}]")


def _pairs(axes: Axes, fit: CircleFit) -> None:
    resonance = fit.natural_frequency
    below, above = fit.frequencies[fit.frequencies < resonance], fit.frequencies[fit.frequencies > resonance]
    apart = above - below[:, None]
    axes.plot(apart.ravel(), 100 * fit.pairs.ravel(), ".", color=style.PALETTE[0], markersize=2.5)
    median = 100 * fit.damping_ratio
    axes.axhline(median, color=style.PALETTE[1], linewidth=1.2)
    reach = max(6 * 100 * fit.spread, 0.05 * abs(median))
    axes.set_ylim(median - reach, median + reach)
    axes.set_xlabel("distance of the two points [Hz]")
    axes.set_ylabel("damping ratio of each pair [%]")


# Plot of a matrix of modal assurance criteria (MAC), which compare the mode shapes of two sets.

MOST_NUMBERS = 14
"""Largest number of modes on a side of a MAC matrix up to which its fields have numbers; in more, the fields are too
small for them."""
WHITE_TEXT_MAC = 0.55
"""MAC above which a field is so dark that its number is white."""


def mac_matrix(
    values: ArrayLike,
    *,
    rows: Sequence[str] | None = None,
    columns: Sequence[str] | None = None,
    row_label: str = "identified mode",
    column_label: str = "mode of the model",
    title: str = "",
    ax: Axes | None = None,
) -> Figure:
    """Figure of a matrix of modal assurance criteria (MAC) in shades from 0 to 1, with modes on rows and on columns.

    The fields have numbers if there are not too many modes.

    Parameters
    ----------
    values : (n_first, n_second) array
        As of :func:`torsionnet.modal.mac`, or the ``mac`` of a :class:`~torsionnet.modal.matching.Match`.
    rows, columns : sequence of str, optional
        Names of the modes; by default their numbers.
    row_label, column_label, title : str, optional
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.

    Raises
    ------
    UsageError
        The values are no matrix, or the names are not as many.

    Examples
    --------
    >>> mac_matrix([[1, 0.1], [0.05, 0.98]], rows=["8.7 Hz", "81 Hz"]).axes[0].get_ylabel()
    'identified mode'
    """
    matrix = np.asarray(values, dtype=float)
    if matrix.ndim != 2 or not matrix.size:
        raise UsageError(
            "a MAC plot needs a matrix; a match has none if model and test have fewer than two sensors in common",
            kind="missing-data",
        )
    names = [
        [str(number + 1) for number in range(size)] if given is None else list(given)
        for given, size in zip((rows, columns), matrix.shape, strict=True)
    ]
    for given, size in zip(names, matrix.shape, strict=True):
        if len(given) != size:
            raise UsageError(f"{size} modes need as many names, got {len(given)}", kind="wrong-count")
    cell = 0.45
    width, height = min(style.WIDTH, 2.2 + cell * matrix.shape[1]), min(9, 1.6 + cell * matrix.shape[0])
    sheet, ((axes,),) = style.grid_panels(width, height, [""], ax)
    picture = axes.imshow(matrix, cmap="Blues", vmin=0, vmax=1, aspect="equal")
    axes.set_xticks(range(matrix.shape[1]), names[1], fontsize=style.SMALL, rotation=45 if columns else 0)
    axes.set_yticks(range(matrix.shape[0]), names[0], fontsize=style.SMALL)
    axes.set_xlabel(column_label, fontsize=style.FONT)
    axes.set_ylabel(row_label, fontsize=style.FONT)
    if max(matrix.shape) <= MOST_NUMBERS:
        for (row, column), value in np.ndenumerate(matrix):
            # Dark fields have white numbers.
            color = style.PAPER if value > WHITE_TEXT_MAC else style.INK
            text = "-" if np.isnan(value) else f"{value:.2f}"
            axes.text(column, row, text, ha="center", va="center", fontsize=style.SMALL, color=color)
    bar = sheet.figure.colorbar(picture, ax=axes, shrink=0.9)
    bar.set_label("MAC [-]", fontsize=style.FONT)
    bar.ax.tick_params(labelsize=style.SMALL)
    return sheet.titled(title)


# Pictures of modes found without an input: swept fit over frequency, decay with envelope, stabilisation diagram.


def operational_modes(modes: OperationalModes, *, title: str | None = None, ax: Axes | None = None) -> Figure:
    """Figure of what modes without an input were read from: run-up, decay or stabilisation diagram.

    Parameters
    ----------
    modes : OperationalModes
    title : str, optional
    ax : Axes, optional
        Axes to draw into; by default those of a new figure.

    Returns
    -------
    matplotlib.figure.Figure
        Of a run-up, measured and fitted amplitude of the order, and what the same modes would do at steady speeds, over
        the frequency of the order. Of a decay, the signal, its fit and the envelope. Of an ambient record, the poles
        over the order of the model.

    Examples
    --------
    >>> from torsionnet.signals.recording import Recording, Signal
    >>> from torsionnet.modal import modes_from_decay
    >>> t = np.arange(2000) / 500
    >>> record = Recording((Signal("T", "torque", np.exp(-t) * np.cos(60 * t)),), sampling_rate=500)
    >>> operational_modes(modes_from_decay(record, "T", start=0)).axes[0].get_xlabel()
    'time [s]'
    """
    sheet, axes = style.one_panel(3.8, ax)
    unit = f" [{typeset_unit(modes.unit)}]" if modes.unit else ""
    if isinstance(modes.evidence, SweptFit):
        _swept(axes, modes.evidence, modes)
        axes.set_ylabel(f"{modes.channel}, amplitude{unit}")
    elif isinstance(modes.evidence, DecayFit):
        _decay(axes, modes.evidence)
        axes.set_ylabel(f"{modes.channel}{unit}")
    elif isinstance(modes.evidence, AmbientPoles):
        _stable(axes, modes.evidence, modes)
    style.legend_beside(axes)
    return sheet.titled(_heading(modes) if title is None else title)


def _heading(operational: OperationalModes) -> str:
    modes = ", ".join(
        f"{f:.4g} Hz ({100 * z:.3g} %)"
        for f, z in zip(operational.natural_frequencies, operational.damping_ratios, strict=True)
    )
    return f"{operational.title}: {modes}".removeprefix(": ")


def _swept(axes: Axes, fit: SweptFit, operational: OperationalModes) -> None:
    at = fit.frequencies
    axes.plot(at, np.abs(fit.measured), ".", color=style.INK, markersize=4, label=f"order {fit.order:g}, measured")
    axes.plot(at, np.abs(fit.fitted), color=style.PALETTE[0], linewidth=1.2, label="swept fit")
    for mode, (frequency, steady) in enumerate(zip(operational.natural_frequencies, fit.steady, strict=True)):
        label = "the mode at steady speeds" if not mode else None
        axes.plot(fit.steady_frequencies, np.abs(steady), "--", color=style.PALETTE[1], linewidth=1.2, label=label)
        axes.axvline(frequency, color=style.MUTED, linewidth=0.8)
    axes.set_ylim(0, None)
    axes.set_xlabel(f"frequency of order {fit.order:g} [Hz]")


def _decay(axes: Axes, fit: DecayFit) -> None:
    t = fit.times - fit.times[0]
    axes.plot(fit.times, fit.measured, color=style.INK, linewidth=1.0, label="measured")
    axes.plot(fit.times, fit.fitted, "--", color=style.PALETTE[0], linewidth=1.0, label="fitted")
    largest = int(np.abs(fit.amplitudes).argmax())
    envelope = np.abs(fit.amplitudes[largest]) * np.exp(fit.poles[largest].real * t)
    for sign in (1, -1):
        label = "envelope of the largest mode" if sign > 0 else None
        axes.plot(fit.times, fit.rest + sign * envelope, color=style.PALETTE[1], linewidth=1.2, label=label)
    if fit.decrement is not None:
        rest = np.interp(fit.decrement.times, fit.times, fit.rest)
        axes.plot(
            fit.decrement.times, rest + fit.decrement.amplitudes, "o", color=style.PALETTE[1], markersize=3,
            label="amplitude of each cycle",
        )  # fmt: skip
    axes.set_xlabel("time [s]")


def _stable(axes: Axes, poles: AmbientPoles, operational: OperationalModes) -> None:
    frequencies = np.abs(poles.poles) / (2 * np.pi)
    new = ~poles.stable
    axes.plot(frequencies[new], poles.orders[new], "x", color=style.MUTED, markersize=5, label="pole")
    axes.plot(
        frequencies[poles.stable], poles.orders[poles.stable], "P", color=style.PALETTE[2], markersize=5, label="stable"
    )
    for mode, frequency in enumerate(operational.natural_frequencies):
        axes.axvline(
            frequency, color=style.PALETTE[1], linewidth=1.0, label="mode (or order)" if not mode else None, zorder=0
        )
    axes.set_xlabel("natural frequency [Hz]")
    axes.set_ylabel("order of the model")

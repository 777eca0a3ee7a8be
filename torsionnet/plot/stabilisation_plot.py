"""Stabilisation diagram with poles by the order of the fit over frequency, and the responses' mode indicator."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

import torsionnet.plot.drawing.style as style
from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.number_text import typeset_unit
from torsionnet.modal import ModalEstimate, Stabilisation, cmif

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
    figure = style.new_figure(style.WIDTH, 4.6)
    orders = figure.subplots()
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
    figure.legend(loc="outside lower center", ncols=4, frameon=False, fontsize=style.SMALL)
    style.set_title(figure, diagram.response.title if title is None else title)
    return figure


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

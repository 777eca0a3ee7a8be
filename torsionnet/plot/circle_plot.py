"""Plot of the circle fitted to a mode in Nyquist's plane, and of the damping ratio from every pair of points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.number_text import typeset_unit

if TYPE_CHECKING:
    from torsionnet.modal import CircleFit


def circle(fit: CircleFit, *, title: str | None = None) -> Figure:
    """Figure of the circle fitted to a mode in Nyquist's plane, and of damping ratios over distances of points in Hz.

    If the damping ratios on the right are level, a single mode with this law of damping explains the circle; a slope
    means that it does not.

    Parameters
    ----------
    fit : CircleFit
    title : str, optional
        By default the label of the fit, with natural frequency and damping ratio.

    Examples
    --------
    >>> import torsionnet as tn
    >>> response = tn.load("dmf_rig").frequency_response("theta_1", "T_T", [0.1 * k for k in range(1, 301)])
    >>> [axes.get_xlabel() for axes in circle(tn.modal.circle_fit(response, near=8)).axes]
    ['real part [rad/s/(N·m)]', 'distance of the two points [Hz]']
    """
    figure = style.new_figure(style.WIDTH, 3.9)
    plane, pairs = figure.subplots(1, 2, width_ratios=(1.1, 1))
    _plane(plane, fit)
    _pairs(pairs, fit)
    figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=style.SMALL)
    spread = f"{100 * fit.spread:.2g}"
    words = f"{fit.label}: {fit.natural_frequency:.4g} Hz, {100 * fit.damping_ratio:.3g} % ± {spread} % over the pairs"
    style.set_title(figure, words if title is None else title)
    return figure


def _plane(axes: Axes, fit: CircleFit) -> None:
    style.style_axes(axes)
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
    style.style_axes(axes)
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

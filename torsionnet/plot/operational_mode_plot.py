"""Pictures of modes found without an input: swept fit over frequency, decay with envelope, stabilisation diagram."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import torsionnet.plot.drawing.style as style
from torsionnet.base.number_text import typeset_unit
from torsionnet.modal.operational.ambient_modes import AmbientPoles
from torsionnet.modal.operational.decay_modes import DecayFit
from torsionnet.modal.operational.operational_modes import OperationalModes
from torsionnet.modal.operational.swept_fit import SweptFit


def operational_modes(found: OperationalModes, *, title: str | None = None) -> Figure:
    """Figure of what modes without an input were read from: run-up, decay or stabilisation diagram.

    Parameters
    ----------
    found : OperationalModes
    title : str, optional

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
    figure = style.new_figure(style.WIDTH, 3.8)
    axes = figure.subplots()
    style.style_axes(axes)
    unit = f" [{typeset_unit(found.unit)}]" if found.unit else ""
    if isinstance(found.evidence, SweptFit):
        _swept(axes, found.evidence, found)
        axes.set_ylabel(f"{found.channel}, amplitude{unit}")
    elif isinstance(found.evidence, DecayFit):
        _decay(axes, found.evidence)
        axes.set_ylabel(f"{found.channel}{unit}")
    elif isinstance(found.evidence, AmbientPoles):
        _stable(axes, found.evidence, found)
    axes.legend(fontsize=style.SMALL, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    style.set_title(figure, _heading(found) if title is None else title)
    return figure


def _heading(found: OperationalModes) -> str:
    modes = ", ".join(
        f"{f:.4g} Hz ({100 * z:.3g} %)" for f, z in zip(found.natural_frequencies, found.damping_ratios, strict=True)
    )
    return f"{found.title}: {modes}".removeprefix(": ")


def _swept(axes: Axes, fit: SweptFit, found: OperationalModes) -> None:
    at = fit.frequencies
    axes.plot(at, np.abs(fit.measured), ".", color=style.INK, markersize=4, label=f"order {fit.order:g}, measured")
    axes.plot(at, np.abs(fit.fitted), color=style.PALETTE[0], linewidth=1.2, label="swept fit")
    for mode, (frequency, steady) in enumerate(zip(found.natural_frequencies, fit.steady, strict=True)):
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


def _stable(axes: Axes, poles: AmbientPoles, found: OperationalModes) -> None:
    frequencies = np.abs(poles.poles) / (2 * np.pi)
    new = ~poles.stable
    axes.plot(frequencies[new], poles.orders[new], "x", color=style.MUTED, markersize=5, label="pole")
    axes.plot(
        frequencies[poles.stable], poles.orders[poles.stable], "P", color=style.PALETTE[2], markersize=5, label="stable"
    )
    for mode, frequency in enumerate(found.natural_frequencies):
        axes.axvline(
            frequency, color=style.PALETTE[1], linewidth=1.0, label="mode (or order)" if not mode else None, zorder=0
        )
    axes.set_xlabel("natural frequency [Hz]")
    axes.set_ylabel("order of the model")

"""Natural frequency and damping from a free decay, by matrix pencil, least squares and logarithmic decrement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.notes import warning
from torsionnet.modal.operational.decay_fit import ExponentialFit, fit_exponentials
from torsionnet.modal.operational.decay_section import decay_section
from torsionnet.modal.operational.decrement import Decrement, logarithmic_decrement
from torsionnet.modal.operational.operational_modes import NORMAL_95, OperationalModes
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray
from torsionnet.signals.recording import Recording

FEWEST_CYCLES = 3.0
"""Cycles below which a decay does not tell damping from a drift."""
SAME_MODE = 0.05
"""Relative distance of frequencies up to which poles stay together for the decrement: a mode whose damping depends on
amplitude needs several."""
GREAT_MISFIT = 0.1
"""RMS residual over RMS of the decay above which it is no sum of a few damped vibrations."""


@dataclass(frozen=True, eq=False)
class DecayFit:
    """Free decay beside the damped vibrations fitted to it, over time in s, in SI units.

    Attributes
    ----------
    times, measured, fitted : (n,) arrays
        s and SI.
    rest : (n,) array
        What does not vibrate.
    poles, amplitudes : (n_modes,) complex arrays
        rad/s; X of ``Re X exp(lambda t)``, t from the start.
    decrement : Decrement or None
        Amplitudes of the largest mode and their logarithmic decrement.
    by_count : tuple of complex arrays
        Poles of the pencil with 1, 2, ... poles, rad/s.
    """

    times: FloatArray
    measured: FloatArray
    fitted: FloatArray
    rest: FloatArray
    poles: ComplexArray
    amplitudes: ComplexArray
    decrement: Decrement | None
    by_count: tuple[ComplexArray, ...]


def modes_from_decay(
    recording: Recording,
    channel: str,
    *,
    start: float | None = None,
    end: float | None = None,
    modes: int | None = None,
    highest: float | None = None,
) -> OperationalModes:
    """Natural frequencies and damping ratios from a free decay, as after a clutch drop, with 95 % intervals.

    The matrix pencil finds the poles, least squares refine them, and the logarithmic decrement of the largest mode
    over all its cycles, the other modes taken out, says whether damping depends on amplitude.

    Parameters
    ----------
    recording : Recording
    channel : str
    start, end : float, optional
        Times in s between which nothing excites the shaft; by default found from the signal.
    modes : int, optional
        Number of modes; default: as many as the decay bears (Schwarz's criterion).
    highest : float, optional
        Highest frequency of interest in Hz; default: that below which all but a hundredth of the power lies.

    Raises
    ------
    UsageError
        Start or end are outside the record.
    SolveError
        Nothing decays, or a decay of too few cycles.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> t = np.arange(2000) / 500
    >>> torque = 10 * np.exp(-0.02 * 2 * np.pi * 12 * t) * np.cos(2 * np.pi * 12 * np.sqrt(1 - 0.02**2) * t)
    >>> found = modes_from_decay(Recording((Signal("T", "torque", torque),), sampling_rate=500), "T", start=0)
    >>> float(found.natural_frequencies[0].round(4)), float(found.damping_ratios[0].round(5))
    (12.0, 0.02)
    """
    signal = recording[channel]
    if recording.times is not None:
        raise UsageError("a decay is read from even samples: resample the record first")
    if not np.isfinite(signal.values).all():
        raise UsageError(f"{channel} has values that are no numbers; repair the record first")
    if modes is not None and modes < 1:
        raise UsageError(f"at least one mode is fitted, got {modes}")
    section = decay_section(recording.time, signal.values, start, end, highest)
    fit = fit_exponentials(section.times, section.values, modes)
    span = section.times[-1] - section.times[0]
    cycles = fit.poles.imag * span / (2 * np.pi)
    if cycles.max() < FEWEST_CYCLES:
        raise SolveError(
            f"the decay holds {cycles.max():.2g} cycles of {fit.poles[-1].imag / 2 / np.pi:.3g} Hz, too few; "
            f"{FEWEST_CYCLES:g} or more are needed: give start and end, or record less noise"
        )
    errors = _half_widths(fit)
    waves = np.real(fit.amplitudes * np.exp(np.outer(section.times - section.times[0], fit.poles)))
    largest = int(np.abs(fit.amplitudes).argmax())
    apart = np.abs(np.abs(fit.poles) / abs(fit.poles[largest]) - 1) > SAME_MODE
    alone = section.values - fit.rest - waves[:, apart].sum(axis=1)
    decrement = logarithmic_decrement(section.times, alone, fit.poles[largest], float(fit.residuals.std()))
    remarks = [f"{count:.3g} cycles" for count in cycles]
    if decrement is not None:
        remarks[largest] += f"; {decrement.words}"
    misfit = float(np.sqrt(np.mean(fit.residuals**2)) / section.values.std())
    notes = list(section.notes)
    if misfit > GREAT_MISFIT:
        notes.append(
            warning(f"{misfit:.0%} of the decay (RMS) is no sum of damped vibrations: noise, or still excited")
        )
    if decrement is not None and decrement.depends_on_amplitude:
        notes.append(warning(f"damping depends on amplitude: {decrement.change(signal.unit)}"))
    evidence = DecayFit(
        section.times, section.values, section.values - fit.residuals, fit.rest, fit.poles, fit.amplitudes, decrement,
        fit.by_count,
    )  # fmt: skip
    return OperationalModes(
        fit.poles, errors[0], errors[1], np.abs(fit.amplitudes), channel, signal.unit,
        "free decay (matrix pencil, least squares)", evidence, tuple(remarks), recording.title, tuple(notes),
    )  # fmt: skip


def _half_widths(fit: ExponentialFit) -> FloatArray:
    """Half widths of the 95 % intervals of frequencies in Hz and of damping ratios, (2, n_modes)."""
    size, count = np.abs(fit.poles), len(fit.poles)
    errors = np.zeros((2, count))
    for mode, (a, b) in enumerate(zip(fit.poles.real, fit.poles.imag, strict=True)):
        places = [mode, mode + count]
        slopes = np.array([[a, b] / size[mode] / (2 * np.pi), [-(b**2), a * b] / size[mode] ** 3])
        variances = np.diag(slopes @ fit.covariance[np.ix_(places, places)] @ slopes.T)
        errors[:, mode] = NORMAL_95 * np.sqrt(np.maximum(variances, 0))
    return errors

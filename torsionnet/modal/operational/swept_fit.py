"""Modes fitted to the passage of an order through resonances, with intervals, remarks and the curves behind them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import SolveError
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.modal.operational.operational_modes import OperationalModes
from torsionnet.modal.operational.passage_windows import PassageWindows
from torsionnet.modal.operational.run_up_fit import RunUpFit, fit_run_up
from torsionnet.modal.operational.steady_reading import steady_reading
from torsionnet.modal.operational.swept_response import DERIVATIVES, Excitation, sweep_of, swept_response
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray

GREAT_MISFIT = 0.1
"""RMS residual over RMS amplitude above which other modes or an uneven excitation are suspected."""
STEADY_POINTS = 1000
"""Points of the curve of steady responses."""
FAST_SWEEP = 0.2
"""Sweep rate in units of (zeta f0)^2 from which the steady reading is off by percents, and the note on it is given."""


@dataclass(frozen=True, eq=False)
class SweptFit:
    """Measured order of a passage through resonances beside the fitted swept response, over order frequency in Hz.

    Attributes
    ----------
    order : float
    frequencies : (n,) array
        Frequency of the order in the middle of each window, Hz.
    measured, fitted : (n,) complex arrays
        Peak amplitudes in windows, SI.
    parts : (n_modes, n) complex array
        Contribution of each mode.
    steady_frequencies : (n_fine,) array
        Frequencies in Hz of the steady response.
    steady : (n_modes, n_fine) complex array
        Response of each mode at steady speeds, for the amplitude of its swept response.
    """

    order: float
    frequencies: FloatArray
    measured: ComplexArray
    fitted: ComplexArray
    parts: ComplexArray
    steady_frequencies: FloatArray
    steady: ComplexArray


def swept_modes(
    windows: PassageWindows,
    about: tuple[str, str, str, str],
    modes: int,
    excitation: Excitation,
    background: int,
    notes: tuple[NoteOrText, ...],
) -> OperationalModes:
    """Modes fitted to the windows of a passage, with intervals and remarks; about: channel, quantity, unit, title.

    Raises
    ------
    SolveError
        The resonance is not passed.
    """
    channel, quantity, unit, title = about
    derivative = DERIVATIVES.get(quantity, 0)
    fit = fit_run_up(windows, excitation, derivative, modes, background)
    factor = _student(fit.degrees)
    errors = factor * np.sqrt(np.diag(fit.covariance)).reshape(2, -1)
    frequencies, zeta = np.abs(fit.poles) / (2 * np.pi), -fit.poles.real / np.abs(fit.poles)
    evidence = SweptFit(
        windows.orders[0], windows.frequencies, windows.values[0], fit.fitted[0], fit.parts[:, 0],
        *_steady(fit, windows, excitation, derivative),
    )  # fmt: skip
    remarks = tuple(
        "; ".join(_remarks(windows, f, z, error)) for f, z, error in zip(frequencies, zeta, errors[1], strict=True)
    )
    law = "constant" if excitation == "constant" else "as the square of the speed"
    said = [f"amplitude of the excitation {law}", *notes, *_notes(fit, windows, excitation, derivative)]
    return OperationalModes(
        fit.poles, frequencies * errors[0], zeta * errors[1], np.abs(fit.parts[:, 0]).max(axis=1), channel, unit,
        f"swept response of order {windows.orders[0]:g}", evidence, remarks, title, tuple(said),
    )  # fmt: skip


def _student(degrees: int) -> float:
    from scipy.stats import t

    return float(t.ppf(0.975, degrees))


def _steady(
    fit: RunUpFit, windows: PassageWindows, excitation: Excitation, derivative: int
) -> tuple[FloatArray, ComplexArray]:
    """Frequencies in Hz and response of each mode at steady speeds, (n_modes, n), with the amplitudes of the fit."""
    at = np.linspace(windows.frequencies.min(), windows.frequencies.max(), STEADY_POINTS)
    omega = 2 * np.pi * at
    sweep = sweep_of(windows.times, windows.angle, windows.orders[0], excitation)
    growth = np.ones(len(omega)) if excitation == "constant" else (omega / np.abs(sweep.speed).max()) ** 2
    found = []
    for pole, part in zip(fit.poles, fit.parts[:, 0], strict=True):
        swept = windows.weights @ swept_response(pole, sweep, derivative)
        gain = np.vdot(swept, part) / np.vdot(swept, swept)
        compliance = abs(pole) ** 2 / ((1j * omega - pole) * (1j * omega - pole.conjugate()))
        found.append(gain * growth * compliance * (1j * omega) ** derivative)
    return at, np.array(found)


def _notes(fit: RunUpFit, windows: PassageWindows, excitation: Excitation, derivative: int) -> list[NoteOrText]:
    pole = fit.poles[int(np.abs(fit.parts[:, 0]).max(axis=1).argmax())]
    f0, zeta = abs(pole) / (2 * np.pi), -pole.real / abs(pole)
    found: list[NoteOrText] = []
    sweep = sweep_of(windows.times, windows.angle, windows.orders[0], excitation)
    passed = int(np.abs(np.abs(sweep.speed) - abs(pole)).argmin())
    rate = abs(float(np.gradient(sweep.speed, sweep.step)[passed])) / (2 * np.pi)
    if rate > FAST_SWEEP * (zeta * f0) ** 2:
        read = steady_reading(np.abs(sweep.speed) / (2 * np.pi), np.abs(swept_response(pole, sweep, derivative)))
        steady = 1 / (2 * zeta * np.sqrt(1 - zeta**2)) * abs(pole) ** derivative
        peak = _share_apart(read.peak / (steady * sweep.excitation[passed]))
        found.append(
            f"the order passes {f0:.4g} Hz at {rate:.3g} Hz/s: peak and half power, read as of a steady response, "
            f"would give {read.frequency:.4g} Hz, damping ratio {read.damping_ratio:.3g} and a peak {peak}"
        )
    if fit.misfit > GREAT_MISFIT:
        found.append(
            warning(
                f"the fit leaves {fit.misfit:.0%} of the amplitude (RMS): noise, more modes in the band, or an "
                "excitation that changes with speed in another way"
            )
        )
    if windows.amplitudes_only:
        found.append("amplitudes alone are fitted, phases are not known")
    return found


def _share_apart(ratio: float) -> str:
    share = round(100 * abs(ratio - 1))
    return f"{share} % too {'low' if ratio < 1 else 'high'}" if share else "of the right height"


def _remarks(windows: PassageWindows, f: float, zeta: float, error: float) -> list[str]:
    low, high = windows.frequencies.min(), windows.frequencies.max()
    if not low < f < high:
        raise SolveError(
            f"the fitted natural frequency of {f:.4g} Hz is outside the {low:.4g} to {high:.4g} Hz that order "
            f"{windows.orders[0]:g} runs through: the resonance is not passed"
        )
    found = []
    if not low < f * (1 - zeta) < f * (1 + zeta) < high:
        found.append("its half-power width is not passed as a whole")
    if error > 0.5:
        found.append("damping is hardly determined")
    return found

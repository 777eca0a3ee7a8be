"""Natural frequency and damping from a run-up or run-down, by a fit of the swept response to measured orders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.core.errors import SolveError, UsageError
from torsionnet.modal.operational.mean_rotation import mean_rotation
from torsionnet.modal.operational.operational_modes import OperationalModes
from torsionnet.modal.operational.order_windows import OrderWindows, order_windows
from torsionnet.modal.operational.run_up_fit import RunUpFit, fit_run_up
from torsionnet.modal.operational.steady_reading import steady_reading
from torsionnet.modal.operational.swept_response import DERIVATIVES, Excitation, sweep_of, swept_response
from torsionnet.modal.operational.tracked_windows import tracked_windows
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray
from torsionnet.response.measured.tracked_orders import TrackedOrders
from torsionnet.response.recording import Recording

BELOW_PEAK, ABOVE_PEAK = 0.6, 1.7
"""Lowest and highest frequency of the order over that of its largest amplitude, between which a mode is fitted: the
rest of the record tells of other modes."""
PROMINENT = 0.1
"""Prominence of a peak over the largest amplitude, from which it can be a resonance."""
SAMPLES_PER_CYCLE = 16
"""Samples per cycle of the highest frequency of the order that are kept; more tell nothing new."""
GREAT_MISFIT = 0.1
"""RMS residual over RMS amplitude above which other modes or an uneven excitation are suspected."""
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
    steady : (n_modes, n) complex array
        Response of each mode had the machine stayed at each speed, for its amplitude.
    """

    order: float
    frequencies: FloatArray
    measured: ComplexArray
    fitted: ComplexArray
    parts: ComplexArray
    steady: ComplexArray


def modes_from_run_up(
    recording: Recording,
    channel: str,
    order: float | Sequence[float],
    *,
    speed: ArrayLike | None = None,
    angle: ArrayLike | None = None,
    band: tuple[float, float] | None = None,
    modes: int = 1,
    excitation: Excitation = "constant",
    background: int = 1,
    revolutions: float | None = None,
) -> OperationalModes:
    """Natural frequencies and damping ratios from the passage of an order through resonances, with 95 % intervals.

    The swept response of the modes is fitted, not the steady one: the state of each mode follows the measured speed.
    The signal is read in Hann windows of the mean angle of rotation, and so is the fitted response, so that windows
    smear nothing. Orders that are given together are fitted together, with an amplitude each.

    Parameters
    ----------
    recording : Recording
    channel : str
        Signal read; its quantity says whether it follows the angle (torque, stress, angle) or is a derivative.
    order : float or sequence of float
        Vibrations per revolution; the first is that whose frequency passes the natural frequency.
    speed, angle : (n,) array
        Speed in rad/s or angle in rad of the reference shaft at every sample: one of them. Smoothed over four
        revolutions.
    band : (float, float), optional
        Frequencies of the order in Hz between which it is read; default: 0.6 to 1.7 times that of its peak.
    modes : int, optional
        Modes in the band.
    excitation : {"constant", "inertia"}, optional
        Amplitude of the excitation over speed: constant, as of gas torques at one load, or as the square of the
        speed, as of inertia torques.
    background : int, optional
        Degree of the polynomial in speed by which distant modes are described.
    revolutions : float, optional
        Length of a window; default: four, or less in a quick run-up.

    Raises
    ------
    UsageError
        Speed or angle are missing or do not fit, or the shaft does not turn on.
    SolveError
        The resonance is not passed, or the passage is too short.

    Examples
    --------
    >>> from torsionnet.response.recording import Signal
    >>> from torsionnet.modal.operational.swept_response import sweep_of, swept_response
    >>> times = np.arange(0, 12, 0.004)
    >>> turns = 10 * times + times**2
    >>> sweep, pole = sweep_of(times, 2 * np.pi * turns, 1.0), 2 * np.pi * 20 * (-0.02 + 0.9998j)
    >>> torque = np.real(swept_response(pole, sweep) * np.exp(1j * sweep.phase))
    >>> record = Recording((Signal("T", "torque", torque),), sampling_rate=250)
    >>> found = modes_from_run_up(record, "T", 1, angle=2 * np.pi * turns)
    >>> float(found.natural_frequencies[0].round(3)), float(found.damping_ratios[0].round(4))
    (20.0, 0.02)
    """
    signal, orders = recording[channel], tuple(np.atleast_1d(np.asarray(order, dtype=float)).tolist())
    _check(orders, modes, background)
    if recording.times is not None:
        raise UsageError("a run-up is read from even samples: resample the record first")
    if not np.isfinite(signal.values).all():
        raise UsageError(f"{channel} has values that are no numbers; repair the record first")
    times, turned = recording.time, mean_rotation(recording.time, speed=speed, angle=angle)
    values = signal.values - turned if signal.quantity == "angle" else signal.values
    windows = order_windows(times, values, turned, orders, revolutions)
    low, high = band or _band(windows)
    times, values, turned = _section(times, values, turned, orders[0], (low, high))
    windows = order_windows(times, values, turned, orders, revolutions).within(low, high)
    note = f"Hann windows of {windows.revolutions:.3g} revolutions, {windows.values.shape[1]} between "
    note += f"{low:.4g} and {high:.4g} Hz"
    if windows.revolutions < 2 and len(orders) == 1:
        note += f"; orders nearer than {2 / windows.revolutions:.2g} are not kept apart: give those there are, too"
    about = (channel, signal.quantity, signal.unit, recording.title)
    return _fitted(windows, about, modes, excitation, background, (note,))


def modes_from_tracked_orders(
    tracked: TrackedOrders,
    order: float,
    *,
    band: tuple[float, float] | None = None,
    modes: int = 1,
    excitation: Excitation = "constant",
    background: int = 1,
    amplitudes_only: bool | None = None,
    revolutions: float | None = None,
    bandwidth: float | None = None,
) -> OperationalModes:
    """Natural frequencies and damping ratios from a tracked order, by a fit of the swept response to it.

    Parameters
    ----------
    tracked : TrackedOrders
    order : float
    band, modes, excitation, background
        As for :func:`modes_from_run_up`.
    amplitudes_only : bool, optional
        Leave phases out; default: where the values have none.
    revolutions, bandwidth : float, optional
        How the order was tracked: length of the Hann window, or -3 dB bandwidth in Hz of a two-pole Vold-Kalman filter.
        The fitted response is smeared in the same way. With neither it is not smeared, and a remark says so.

    Raises
    ------
    UsageError
        The order was not tracked.
    SolveError
        The resonance is not passed, or values are too few.
    """
    _check((order,), modes, background)
    windows = tracked_windows(tracked, order, amplitudes_only, revolutions, bandwidth)
    low, high = band or _band(windows)
    windows = windows.within(low, high)
    notes = [f"{windows.values.shape[1]} values of the tracked order between {low:.4g} and {high:.4g} Hz"]
    if revolutions is None and bandwidth is None:
        notes.append("warning: how far the tracking smears is not known; give its bandwidth, or read the signal itself")
    about = (tracked.name, tracked.quantity, tracked.unit, tracked.title)
    return _fitted(windows, about, modes, excitation, background, tuple(notes))


def _check(orders: tuple[float, ...], modes: int, background: int) -> None:
    wrong = []
    if not orders or not all(np.isfinite(order) and order > 0 for order in orders):
        wrong.append("orders are positive numbers of vibrations per revolution")
    if modes < 1:
        wrong.append(f"at least one mode is fitted, got {modes}")
    if not 0 <= background <= 4:
        wrong.append(f"the background is a polynomial of degree 0 to 4, got {background}")
    if wrong:
        raise UsageError("; ".join(wrong))


def _band(windows: OrderWindows) -> tuple[float, float]:
    """Lowest and highest frequency in Hz around the most prominent peak of the first order."""
    from scipy.signal import find_peaks

    size, at = np.abs(windows.values[0]), windows.frequencies
    places, found = find_peaks(size, prominence=PROMINENT * size.max())
    if not len(places):
        end = "highest" if at[size.argmax()] > (at.min() + at.max()) / 2 else "lowest"
        raise SolveError(
            f"order {windows.orders[0]:g} runs from {at.min():.4g} to {at.max():.4g} Hz and is largest at its {end} "
            "frequency: the resonance is not passed. Record a wider range of speed, or take another order"
        )
    peak = at[places[found["prominences"].argmax()]]
    return max(float(at.min()), BELOW_PEAK * peak), min(float(at.max()), ABOVE_PEAK * peak)


def _section(
    times: FloatArray, values: FloatArray, angle: FloatArray, order: float, band: tuple[float, float]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Part of the record in which the order is in the band (Hz), with no more samples than it needs."""
    from scipy.signal import resample_poly

    frequency = order * np.abs(np.gradient(angle, times)) / (2 * np.pi)
    inside = np.flatnonzero((frequency >= band[0]) & (frequency <= band[1]))
    if len(inside) < 2:
        raise SolveError(
            f"order {order:g} runs from {frequency.min():.4g} to {frequency.max():.4g} Hz and is never between "
            f"{band[0]:.4g} and {band[1]:.4g} Hz"
        )
    part = slice(int(inside[0]), int(inside[-1]) + 1)
    times, values, angle = times[part], values[part], angle[part]
    factor = int((len(times) - 1) / (times[-1] - times[0]) / (SAMPLES_PER_CYCLE * band[1]))
    if factor < 2:
        return times, values, angle
    line = np.polynomial.Polynomial.fit(times, values, 1)(times)
    kept = slice(None, None, factor)
    return times[kept], resample_poly(values - line, 1, factor) + line[kept], angle[kept]


def _fitted(
    windows: OrderWindows,
    about: tuple[str, str, str, str],
    modes: int,
    excitation: Excitation,
    background: int,
    notes: tuple[str, ...],
) -> OperationalModes:
    channel, quantity, unit, title = about
    derivative = DERIVATIVES.get(quantity, 0)
    fit = fit_run_up(windows, excitation, derivative, modes, background)
    factor = _student(fit.degrees)
    errors = factor * np.sqrt(np.diag(fit.covariance)).reshape(2, -1)
    frequencies, zeta = np.abs(fit.poles) / (2 * np.pi), -fit.poles.real / np.abs(fit.poles)
    evidence = SweptFit(
        windows.orders[0], windows.frequencies, windows.values[0], fit.fitted[0], fit.parts[:, 0],
        _steady(fit, windows, excitation, derivative),
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


def _steady(fit: RunUpFit, windows: OrderWindows, excitation: Excitation, derivative: int) -> ComplexArray:
    """Response of each mode had the machine stayed at each speed, (n_modes, n), with the amplitudes of the fit."""
    omega = 2 * np.pi * windows.frequencies
    sweep = sweep_of(windows.times, windows.angle, windows.orders[0], excitation)
    growth = np.ones(len(omega)) if excitation == "constant" else (omega / np.abs(sweep.speed).max()) ** 2
    found = []
    for pole, part in zip(fit.poles, fit.parts[:, 0], strict=True):
        swept = windows.weights @ swept_response(pole, sweep, derivative)
        gain = np.vdot(swept, part) / np.vdot(swept, swept)
        compliance = abs(pole) ** 2 / ((1j * omega - pole) * (1j * omega - pole.conjugate()))
        found.append(gain * growth * compliance * (1j * omega) ** derivative)
    return np.array(found)


def _notes(fit: RunUpFit, windows: OrderWindows, excitation: Excitation, derivative: int) -> list[str]:
    pole = fit.poles[int(np.abs(fit.parts[:, 0]).max(axis=1).argmax())]
    f0, zeta = abs(pole) / (2 * np.pi), -pole.real / abs(pole)
    found = []
    sweep = sweep_of(windows.times, windows.angle, windows.orders[0], excitation)
    passed = int(np.abs(np.abs(sweep.speed) - abs(pole)).argmin())
    rate = abs(float(np.gradient(sweep.speed, sweep.step)[passed])) / (2 * np.pi)
    if rate > FAST_SWEEP * (zeta * f0) ** 2:
        read = steady_reading(np.abs(sweep.speed) / (2 * np.pi), np.abs(swept_response(pole, sweep, derivative)))
        steady = 1 / (2 * zeta * np.sqrt(1 - zeta**2)) * abs(pole) ** derivative
        steady *= sweep.excitation[passed]
        found.append(
            f"the order passes {f0:.4g} Hz at {rate:.3g} Hz/s: peak and half power read as a steady response would give "
            f"{read.frequency:.4g} Hz, damping ratio {read.damping_ratio:.3g} and a peak {read.peak / steady - 1:+.0%}"
        )
    if fit.misfit > GREAT_MISFIT:
        found.append(
            f"warning: the fit leaves {fit.misfit:.0%} of the amplitude (RMS): noise, more modes in the band, or an "
            "excitation that changes with speed in another way"
        )
    if windows.amplitudes_only:
        found.append("amplitudes alone are fitted, phases are not known")
    return found


def _remarks(windows: OrderWindows, f: float, zeta: float, error: float) -> list[str]:
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

"""Natural frequency and damping from a run-up or run-down, by a fit of the swept response to measured orders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.modal.operational.ambient_modes import OperationalModes
from torsionnet.modal.operational.passage_windows import PassageWindows, passage_windows, tracked_windows
from torsionnet.modal.operational.run_up_fit import (
    DERIVATIVES,
    Excitation,
    RunUpFit,
    fit_run_up,
    sweep_of,
    swept_response,
)
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray
from torsionnet.signals.orders.mean_rotation import MeanRotation, mean_rotation
from torsionnet.signals.orders.tracked_orders import TrackedOrders, TrackingKernel
from torsionnet.signals.recording import Recording
from torsionnet.signals.rotation.wheel_rotation import WheelRotation

# Peak and half-power width of a resonance curve, as they are read from steady responses.


@dataclass(frozen=True)
class SteadyReading:
    """Peak of a resonance curve, its frequency in Hz, and the damping ratio that half power gives (NaN: no such)."""

    frequency: float
    peak: float
    damping_ratio: float


def steady_reading(frequencies: FloatArray, amplitude: FloatArray) -> SteadyReading:
    """Peak, its frequency in Hz, and the damping ratio from the half-power width of a resonance curve, (n,) arrays.

    Of a swept response these are wrong: late, low and wide.

    Examples
    --------
    >>> f = np.linspace(15, 25, 20001)
    >>> read = steady_reading(f, 1 / np.abs(1 - (f / 20) ** 2 + 2j * 0.02 * f / 20))
    >>> print(read.frequency, round(read.peak, 3), round(read.damping_ratio, 4))
    19.992 25.005 0.02
    """
    rising = np.argsort(frequencies, kind="stable")
    f, size = frequencies[rising], amplitude[rising]
    top = int(size.argmax())
    # At half power the amplitude is 1/sqrt(2) of its peak, and zeta = (f_2 - f_1)/(2 f_0).
    level = size[top] / np.sqrt(2)
    below, above = np.flatnonzero(size[:top] < level), np.flatnonzero(size[top:] < level)
    if not len(below) or not len(above):
        return SteadyReading(float(f[top]), float(size[top]), float("nan"))
    low = np.interp(level, size[[below[-1], below[-1] + 1]], f[[below[-1], below[-1] + 1]])
    last = top + above[0]
    high = np.interp(level, size[[last, last - 1]], f[[last, last - 1]])
    return SteadyReading(float(f[top]), float(size[top]), float((high - low) / (2 * f[top])))


# Modes fitted to the passage of an order through resonances, with intervals, remarks and the curves behind them.

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
    # Of a pole p: natural frequency |p|/(2 pi), damping ratio -Re p/|p|; their errors are relative.
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
    responses = []
    for pole, part in zip(fit.poles, fit.parts[:, 0], strict=True):
        swept = windows.weights @ swept_response(pole, sweep, derivative)
        # Amplitude of the mode's excitation by least squares over the windows.
        gain = np.vdot(swept, part) / np.vdot(swept, swept)
        # |lambda|^2/((j omega - lambda)(j omega - lambda^*)), over the static response.
        compliance = abs(pole) ** 2 / ((1j * omega - pole) * (1j * omega - pole.conjugate()))
        responses.append(gain * growth * compliance * (1j * omega) ** derivative)
    return at, np.array(responses)


def _notes(fit: RunUpFit, windows: PassageWindows, excitation: Excitation, derivative: int) -> list[NoteOrText]:
    pole = fit.poles[int(np.abs(fit.parts[:, 0]).max(axis=1).argmax())]
    f0, zeta = abs(pole) / (2 * np.pi), -pole.real / abs(pole)
    remarks: list[NoteOrText] = []
    sweep = sweep_of(windows.times, windows.angle, windows.orders[0], excitation)
    passed = int(np.abs(np.abs(sweep.speed) - abs(pole)).argmin())
    rate = abs(float(np.gradient(sweep.speed, sweep.step)[passed])) / (2 * np.pi)
    # At (zeta f_0)^2 in Hz/s half the half-power width takes 2 pi of the mode's time constants 1/(zeta omega_0).
    if rate > FAST_SWEEP * (zeta * f0) ** 2:
        read = steady_reading(np.abs(sweep.speed) / (2 * np.pi), np.abs(swept_response(pole, sweep, derivative)))
        # Peak of a steady receptance over the static one, 1/(2 zeta sqrt(1 - zeta^2)).
        steady = 1 / (2 * zeta * np.sqrt(1 - zeta**2)) * abs(pole) ** derivative
        peak = _share_apart(read.peak / (steady * sweep.excitation[passed]))
        remarks.append(
            f"the order passes {f0:.4g} Hz at {rate:.3g} Hz/s: peak and half power, read as of a steady response, "
            f"would give {read.frequency:.4g} Hz, damping ratio {read.damping_ratio:.3g} and a peak {peak}"
        )
    if fit.misfit > GREAT_MISFIT:
        remarks.append(
            warning(
                f"the fit leaves {fit.misfit:.0%} of the amplitude (RMS): noise, more modes in the band, or an "
                "excitation that changes with speed in another way"
            )
        )
    if windows.amplitudes_only:
        remarks.append("amplitudes alone are fitted, phases are not known")
    return remarks


def _share_apart(ratio: float) -> str:
    share = round(100 * abs(ratio - 1))
    return f"{share} % too {'low' if ratio < 1 else 'high'}" if share else "of the right height"


def _remarks(windows: PassageWindows, f: float, zeta: float, error: float) -> list[str]:
    low, high = windows.frequencies.min(), windows.frequencies.max()
    if not low < f < high:
        raise SolveError(
            f"the fitted natural frequency of {f:.4g} Hz is outside the {low:.4g} to {high:.4g} Hz that order "
            f"{windows.orders[0]:g} runs through: the resonance is not passed",
            kind="no-resonance",
        )
    remarks = []
    if not low < f * (1 - zeta) < f * (1 + zeta) < high:
        remarks.append("its half-power width is not passed as a whole")
    if error > 0.5:
        remarks.append("damping is hardly determined")
    return remarks


BELOW_PEAK, ABOVE_PEAK = 0.6, 1.7
"""Lowest and highest frequency of the order over that of its largest amplitude, between which a mode is fitted: the
rest of the record tells of other modes."""
PROMINENT = 0.1
"""Prominence of a peak over the largest amplitude, from which it can be a resonance."""
SAMPLES_PER_CYCLE = 16
"""Samples per cycle of the highest frequency of the order that are kept; more tell nothing new."""


def modes_from_run_up(
    recording: Recording,
    channel: str,
    order: float | Sequence[float],
    rotation: str | MeanRotation | WheelRotation,
    *,
    band: tuple[float, float] | None = None,
    mode_count: int = 1,
    excitation_law: Excitation = "constant",
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
    rotation : str, MeanRotation or WheelRotation
        Channel of the record with speed or angle of the reference shaft, or its rotation by
        :func:`torsionnet.signals.mean_rotation` or from a toothed wheel on the same clock.
    band : (float, float), optional
        Frequencies of the order in Hz between which it is read; default: 0.6 to 1.7 times that of its peak.
    mode_count : int, optional
        Modes in the band.
    excitation_law : {"constant", "inertia"}, optional
        Amplitude of the excitation over speed: constant, as of gas torques at one load, or as the square of the
        speed, as of inertia torques.
    background : int, optional
        Degree of the polynomial in speed by which distant modes are described.
    revolutions : float, optional
        Length of a window; default: four, or less in a quick run-up.

    Raises
    ------
    UsageError
        Values are missing, the channel is neither speed nor angle, or the shaft does not turn on.
    SolveError
        The resonance is not passed, or the passage is too short.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> from torsionnet.modal.operational.run_up_fit import sweep_of, swept_response
    >>> times = np.arange(0, 12, 0.004)
    >>> turns = 10 * times + times**2
    >>> sweep, pole = sweep_of(times, 2 * np.pi * turns, 1.0), 2 * np.pi * 20 * (-0.02 + 0.9998j)
    >>> torque = np.real(swept_response(pole, sweep) * np.exp(1j * sweep.phase))
    >>> speed = Signal("n", "velocity", np.gradient(2 * np.pi * turns, times, edge_order=2))
    >>> record = Recording((Signal("T", "torque", torque), speed), sampling_rate=250)
    >>> modes = modes_from_run_up(record, "T", 1, "n")
    >>> float(modes.natural_frequencies[0].round(3)), float(modes.damping_ratios[0].round(4))
    (20.0, 0.02)
    """
    signal, orders = recording[channel], tuple(np.atleast_1d(np.asarray(order, dtype=float)).tolist())
    _require_run_up(orders, mode_count, background)
    if recording.times is not None:
        raise UsageError("a run-up is read from even samples: resample the record first", kind="uneven-samples")
    if not np.isfinite(signal.values).all():
        raise UsageError(f"{channel} has values that are no numbers; repair the record first", kind="not-finite")
    mean = _mean(recording, rotation)
    inside = slice(*np.searchsorted(recording.time, [mean.ends[0], np.nextafter(mean.ends[-1], np.inf)]).tolist())
    times = recording.time[inside]
    if len(times) < 2:
        raise UsageError(
            f"{channel} and the rotation have no time in common: are they on one clock?", kind="contradicting-values"
        )
    turned = mean.angle(times)
    values = signal.values[inside] - turned if signal.quantity == "angle" else signal.values[inside]
    # First all of the record, to find the peak; then only the passage around it.
    windows = passage_windows(times, values, turned, orders, revolutions)
    # The band follows from a first reading, and is read again without what lies outside it.
    low, high = band or _band(windows)
    times, values, turned = _section(times, values, turned, orders[0], (low, high))
    windows = passage_windows(times, values, turned, orders, revolutions).within(low, high)
    note = f"Hann windows of {windows.revolutions:.3g} revolutions, {windows.values.shape[1]} between "
    note += f"{low:.4g} and {high:.4g} Hz"
    if windows.revolutions < 2 and len(orders) == 1:
        note += f"; orders nearer than {2 / windows.revolutions:.2g} are not kept apart: give those there are, too"
    about = (channel, signal.quantity, signal.unit, recording.title)
    return swept_modes(windows, about, mode_count, excitation_law, background, (note,))


def modes_from_tracked_orders(
    tracked: TrackedOrders,
    order: float,
    *,
    band: tuple[float, float] | None = None,
    mode_count: int = 1,
    excitation_law: Excitation = "constant",
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
        How the order was tracked, unless ``tracked.tracking`` says so: length of a Hann window, or -3 dB
        bandwidth in Hz of a two-pole Vold-Kalman filter. The fitted response is smeared in the same way. Where nothing
        is known it is not smeared, and a remark says so.

    Raises
    ------
    UsageError
        The order was not tracked.
    SolveError
        The resonance is not passed, or values are too few.
    """
    _require_run_up((order,), mode_count, background)
    kernel = _kernel(tracked, revolutions, bandwidth)
    windows = tracked_windows(tracked, order, kernel, amplitudes_only)
    low, high = band or _band(windows)
    windows = windows.within(low, high)
    notes: list[NoteOrText] = [
        f"{windows.values.shape[1]} values of the tracked order between {low:.4g} and {high:.4g} Hz"
    ]
    if not kernel.known:
        notes.append(warning("how far the tracking smears is not known; give its bandwidth, or read the signal itself"))
    about = (tracked.name, tracked.quantity, tracked.unit, tracked.title)
    return swept_modes(windows, about, mode_count, excitation_law, background, tuple(notes))


def _kernel(tracked: TrackedOrders, revolutions: float | None, bandwidth: float | None) -> TrackingKernel:
    """Weights of an order tracking by what is given, or else by how the orders were tracked."""
    if revolutions is not None and bandwidth is not None:
        raise UsageError(
            "an order is tracked in windows of revolutions or with a bandwidth: give one of them",
            kind="contradicting-entries",
        )
    if revolutions is not None:
        return TrackingKernel(revolutions=revolutions, taper=revolutions / 2)
    return tracked.tracking if bandwidth is None else TrackingKernel(bandwidth=bandwidth)


def _mean(recording: Recording, rotation: str | MeanRotation | WheelRotation) -> MeanRotation:
    if isinstance(rotation, str):
        return mean_rotation(recording, rotation)
    return mean_rotation(rotation) if isinstance(rotation, WheelRotation) else rotation


def _require_run_up(orders: tuple[float, ...], modes: int, background: int) -> None:
    wrong = []
    if not orders or not all(np.isfinite(order) and order > 0 for order in orders):
        wrong.append("orders are positive numbers of vibrations per revolution")
    if modes < 1:
        wrong.append(f"at least one mode is fitted, got {modes}")
    if not 0 <= background <= 4:
        wrong.append(f"the background is a polynomial of degree 0 to 4, got {background}")
    if wrong:
        raise UsageError("; ".join(wrong), kind="out-of-range")


def _band(windows: PassageWindows) -> tuple[float, float]:
    """Lowest and highest frequency in Hz around the most prominent peak of the first order."""
    from scipy.signal import find_peaks

    size, at = np.abs(windows.values[0]), windows.frequencies
    places, peaks = find_peaks(size, prominence=PROMINENT * size.max())
    if not len(places):
        end = "highest" if at[size.argmax()] > (at.min() + at.max()) / 2 else "lowest"
        raise SolveError(
            f"order {windows.orders[0]:g} runs from {at.min():.4g} to {at.max():.4g} Hz and is largest at its {end} "
            "frequency: the resonance is not passed. Record a wider range of speed, or take another order",
            kind="no-resonance",
        )
    peak = at[places[peaks["prominences"].argmax()]]
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
            f"{band[0]:.4g} and {band[1]:.4g} Hz",
            kind="no-resonance",
        )
    part = slice(int(inside[0]), int(inside[-1]) + 1)
    times, values, angle = times[part], values[part], angle[part]
    factor = int((len(times) - 1) / (times[-1] - times[0]) / (SAMPLES_PER_CYCLE * band[1]))
    if factor < 2:
        return times, values, angle
    # The filter takes the record to be zero beyond its ends: without its straight line it nearly is.
    line = np.polynomial.Polynomial.fit(times, values, 1)(times)
    kept = slice(None, None, factor)
    return times[kept], resample_poly(values - line, 1, factor) + line[kept], angle[kept]

"""Natural frequency and damping from a free decay, by matrix pencil, least squares and logarithmic decrement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.base.number_text import screen_text
from torsionnet.modal.operational.ambient_modes import NORMAL_95, OperationalModes
from torsionnet.modal.operational.decay_fit import ExponentialFit, fit_exponentials
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray
from torsionnet.signals.recording import Recording

# Part of a record that holds a free decay, from the end of its excitation to the noise.

BLOCKS = 100
"""Blocks into which a record is divided to find where its vibration is largest."""
LIVELY = 0.6
"""Standard deviation of a block over the largest from which the decay can begin in it: those of half cycles differ."""
FLOOR_OVER_NOISE = 3.0
"""Standard deviation of a block over that of the noise at the end, down to which the decay is read."""
SMALLEST_SHARE = 1e-3
"""Standard deviation of a block over the largest, down to which a decay without noise is read."""
HIGHEST_SHARE = 0.01
"""Share of the power of a decay above the highest frequency that is kept: its sudden start spreads some percents."""
FILTER_REACH = 10
"""Samples at either end of a thinned signal that its anti-alias filter spoils: twice ten samples is its length."""
SAMPLES_PER_CYCLE, MOST_SAMPLES = 8, 1200
"""Samples per cycle of the highest frequency that are kept, and samples that the matrix pencil can take."""


@dataclass(frozen=True, eq=False)
class DecaySection:
    """Samples of a free decay in SI units at even times in s, and remarks on how they were chosen."""

    times: FloatArray
    values: FloatArray
    notes: tuple[NoteOrText, ...]


def decay_section(
    times: FloatArray, values: FloatArray, start: float | None, end: float | None, highest: float | None
) -> DecaySection:
    """Part of a signal in which it decays freely, with no more samples than its highest frequency (Hz) needs.

    Raises
    ------
    UsageError
        Start and end are not in the record.
    SolveError
        Hardly anything is left.
    """
    for name, at in (("start", start), ("end", end)):
        if at is not None and not times[0] <= at <= times[-1]:
            raise UsageError(
                f"the {name} at {at:g} s is outside the record from {times[0]:g} to {times[-1]:g} s",
                kind="out-of-range",
            )
    notes = []
    first, last = _decay_ends(values)
    if start is not None:
        first = int(np.searchsorted(times, start))
        last = max(last, first)
    else:
        notes.append(f"the decay was found to start at {times[first]:.4g} s")
    if end is not None:
        last = int(np.searchsorted(times, end))
    elif last < len(times) - 1 and last > first:
        notes.append(f"and to end in noise or rest at {times[last]:.4g} s")
    if last - first < 2 * SAMPLES_PER_CYCLE:
        raise SolveError(
            f"{max(last - first, 0)} samples of decay are too few: give start and end, or record longer",
            kind="too-short",
        )
    part, kept = values[first : last + 1], times[first : last + 1]
    return _thinned(kept, part, highest, tuple(notes))


def _decay_ends(values: FloatArray) -> tuple[int, int]:
    """Index of the largest deflection of the liveliest part, and of the end of the decay behind it."""
    size = max(len(values) // BLOCKS, 4)
    count = len(values) // size
    blocks = values[: count * size].reshape(count, size)
    x = np.arange(size) - (size - 1) / 2
    # Without a straight line in each block, as a mean or a drift is no vibration.
    slopes = blocks @ x / (x @ x)
    straight = blocks - blocks.mean(axis=1, keepdims=True) - slopes[:, None] * x
    lively = straight.std(axis=1)
    top = int(np.flatnonzero(lively > LIVELY * lively.max())[0])
    rest = values[-max(len(values) // 10, 1) :].mean()
    begin = top * size
    first = begin + int(np.abs(values[begin : begin + 2 * size] - rest).argmax())
    spread = np.array([np.std(values[k * size : (k + 4) * size]) for k in range(count)])
    floor = max(float(np.median(spread[-max(count // 10, 1) :])) * FLOOR_OVER_NOISE, SMALLEST_SHARE * spread.max())
    quiet = np.flatnonzero(spread[top + 1 :] < floor)
    last = (top + 1 + int(quiet[0])) * size if len(quiet) else len(values) - 1
    return first, min(last, len(values) - 1)


def _thinned(
    times: FloatArray, values: FloatArray, highest: float | None, notes: tuple[NoteOrText, ...]
) -> DecaySection:
    from scipy.signal import resample_poly

    rate = (len(times) - 1) / (times[-1] - times[0])
    if highest is None:
        # Half a Hann window: the beginning of the decay counts fully, its end fades to 0.
        padded = (values - values[-max(len(values) // 10, 1) :].mean()) * np.hanning(2 * len(values))[len(values) :]
        power = np.abs(np.fft.rfft(padded)) ** 2
        above = 1 - np.cumsum(power) / power.sum()
        highest = float(np.fft.rfftfreq(len(padded), 1 / rate)[int((above > HIGHEST_SHARE).sum())])
    factor = int(rate / (SAMPLES_PER_CYCLE * max(highest, rate / len(values))))
    if factor > 1:
        # About the line between the ends, at which the filter would ring otherwise.
        line = np.interp(times, times[[0, -1]], values[[0, -1]])
        kept = slice(FILTER_REACH, -FILTER_REACH)
        values, times = (resample_poly(values - line, 1, factor) + line[::factor])[kept], times[::factor][kept]
    if len(times) > MOST_SAMPLES:
        notes = (*notes, f"read up to {times[MOST_SAMPLES - 1]:.4g} s")
        times, values = times[:MOST_SAMPLES], values[:MOST_SAMPLES]
    return DecaySection(times, values, notes)


# Logarithmic decrement of a free decay by regression over its cycles, and how it depends on amplitude.

CYCLES_OVER_NOISE = 4.0
"""Amplitude over its standard error down to which the regression takes it: smaller ones are lifted by noise."""
ROUNDING = 1e-9
"""Amplitude over the largest below which it is rounding."""
FEWEST_AMPLITUDES, FEWEST_SAMPLES = 4, 4
"""Cycles below which a regression says nothing on how the decrement changes, and samples that a cycle needs."""
CLEAR_CHANGE, LEAST_CHANGE = 3.0, 0.1
"""Change of the decrement over its standard error, and over the decrement, from which it depends on amplitude."""


@dataclass(frozen=True, eq=False)
class Decrement:
    """Logarithmic decrement of one mode per cycle, from a regression of the logarithms of its amplitudes.

    Attributes
    ----------
    times, amplitudes : (n,) arrays
        Middle of each cycle, s, and the amplitude there, SI.
    decrement, half_width : float
        Logarithm of the ratio of successive amplitudes, per cycle, with its 95 % interval.
    at_large, at_small : float
        Decrement at the largest and at the smallest amplitude, of a parabola through the logarithms.
    change_error : float
        Standard error of their difference.
    """

    times: FloatArray
    amplitudes: FloatArray
    decrement: float
    half_width: float
    at_large: float
    at_small: float
    change_error: float

    @property
    def damping_ratio(self) -> float:
        """Damping ratio that a logarithmic decrement gives."""
        return _ratio(self.decrement)

    @property
    def depends_on_amplitude(self) -> bool:
        """Whether the decrement changes clearly while the amplitude falls."""
        change = abs(self.at_small - self.at_large)
        return change > CLEAR_CHANGE * self.change_error and change > LEAST_CHANGE * self.decrement

    @property
    def words(self) -> str:
        """Decrement in words, such as ``logarithmic decrement 0.126 +- 0.001 over 30 cycles``."""
        text = f"logarithmic decrement {screen_text(self.decrement, 3)} +- {screen_text(self.half_width, 2)} over "
        return f"{text}{len(self.times)} cycles, damping ratio {screen_text(self.damping_ratio, 3)}"

    def change(self, unit: str) -> str:
        """Damping ratios at the largest and at the smallest amplitude, in words."""
        return (
            f"{screen_text(_ratio(self.at_large), 3)} at {screen_text(float(self.amplitudes[0]), 3)} {unit}, "
            f"{screen_text(_ratio(self.at_small), 3)} at {screen_text(float(self.amplitudes[-1]), 3)} {unit}"
        )


def _ratio(decrement: float) -> float:
    return float(decrement / np.hypot(2 * np.pi, decrement))


def logarithmic_decrement(times: FloatArray, values: FloatArray, pole: complex, noise: float) -> Decrement | None:
    """Logarithmic decrement of one decaying vibration per cycle, None where its cycles are too few.

    The amplitude of each cycle is that of the damped vibration which fits it best: less noisy than its extremes.

    Parameters
    ----------
    times, values : (n,) arrays
        s, and the vibration about zero.
    pole : complex
        Its pole in rad/s, which gives the length of a cycle.
    noise : float
        RMS of the noise.
    """
    middle, size, error = _cycle_amplitudes(times, values, pole, noise)
    low = np.flatnonzero(size < np.maximum(CYCLES_OVER_NOISE * error, ROUNDING * size.max()) if len(size) else size)
    middle, size = (middle[: low[0]], size[: low[0]]) if len(low) else (middle, size)
    if len(size) < FEWEST_AMPLITUDES:
        return None
    cycles = (middle - middle[0]) * pole.imag / (2 * np.pi)
    weights = size / size.max()  # an error of an amplitude is one of its logarithm over its size
    # ln(amplitude) falls by the decrement each cycle; a square term shows that it changes with amplitude.
    line, covariance = _regression(cycles, np.log(size), weights, 1)
    bow, spread = _regression(cycles, np.log(size), weights, 2)
    return Decrement(
        middle, size, float(-line[1]), float(NORMAL_95 * np.sqrt(covariance[1, 1])), float(-bow[1]),
        float(-bow[1] - 2 * bow[2] * cycles[-1]), float(2 * cycles[-1] * np.sqrt(spread[2, 2])),
    )  # fmt: skip


def _cycle_amplitudes(
    times: FloatArray, values: FloatArray, pole: complex, noise: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Middles in s, amplitudes there, and their standard errors, of each whole cycle, (n_cycles,)."""
    period = 2 * np.pi / pole.imag
    edges = times[0] + period * np.arange(int((times[-1] - times[0]) / period) + 1)
    cycles = []
    for begin in edges[:-1]:
        first, last = np.searchsorted(times, [begin, begin + period])
        if last - first < FEWEST_SAMPLES:
            continue
        # The mode's own wave over one cycle, so that the amplitude found is that in the middle of the cycle.
        wave = np.exp(pole * (times[first:last] - begin - period / 2))
        parts = np.linalg.lstsq(np.stack([wave.real, -wave.imag], axis=1), values[first:last], rcond=None)[0]
        cycles.append((begin + period / 2, float(np.hypot(*parts)), noise * np.sqrt(2 / (last - first))))
    middle, size, error = np.array(cycles).reshape(-1, 3).T
    return middle, size, error


def _regression(x: FloatArray, y: FloatArray, weights: FloatArray, degree: int) -> tuple[FloatArray, FloatArray]:
    """Coefficients of a polynomial, lowest power first, and their covariance."""
    columns = np.vander(x, degree + 1, increasing=True) * weights[:, None]
    coefficients = np.linalg.lstsq(columns, y * weights, rcond=None)[0]
    left = y * weights - columns @ coefficients
    # Least squares: covariance s^2 (X^T X)^-1 with s^2 of what is left over its degrees of freedom
    variance = float(left @ left) / max(len(x) - degree - 1, 1)
    return np.asarray(coefficients), np.asarray(np.linalg.inv(columns.T @ columns) * variance)


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
    stop: float | None = None,
    mode_count: int | None = None,
    up_to: float | None = None,
) -> OperationalModes:
    """Natural frequencies and damping ratios from a free decay, as after a clutch drop, with 95 % intervals.

    The matrix pencil finds the poles, least squares refine them, and the logarithmic decrement of the largest mode
    over all its cycles, the other modes taken out, says whether damping depends on amplitude.

    Parameters
    ----------
    recording : Recording
    channel : str
    start, stop : float, optional
        Times in s between which nothing excites the shaft; by default found from the signal.
    mode_count : int, optional
        Number of modes; default: as many as the decay bears (Schwarz's criterion).
    up_to : float, optional
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
    >>> modes = modes_from_decay(Recording((Signal("T", "torque", torque),), sampling_rate=500), "T", start=0)
    >>> float(modes.natural_frequencies[0].round(4)), float(modes.damping_ratios[0].round(5))
    (12.0, 0.02)
    """
    signal = recording[channel]
    if recording.times is not None:
        raise UsageError("a decay is read from even samples: resample the record first", kind="uneven-samples")
    if not np.isfinite(signal.values).all():
        raise UsageError(f"{channel} has values that are no numbers; repair the record first", kind="not-finite")
    if mode_count is not None and mode_count < 1:
        raise UsageError(f"at least one mode is fitted, got {mode_count}", kind="wrong-count")
    section = decay_section(recording.time, signal.values, start, stop, up_to)
    fit = fit_exponentials(section.times, section.values, mode_count)
    span = section.times[-1] - section.times[0]
    cycles = fit.poles.imag * span / (2 * np.pi)
    if cycles.max() < FEWEST_CYCLES:
        raise SolveError(
            f"the decay holds {cycles.max():.2g} cycles of {fit.poles[-1].imag / 2 / np.pi:.3g} Hz, too few; "
            f"{FEWEST_CYCLES:g} or more are needed: give start and end, or record less noise",
            kind="too-short",
        )
    errors = _half_widths(fit)
    waves = np.real(fit.amplitudes * np.exp(np.outer(section.times - section.times[0], fit.poles)))
    largest = int(np.abs(fit.amplitudes).argmax())
    apart = np.abs(np.abs(fit.poles) / abs(fit.poles[largest]) - 1) > SAME_MODE
    # The largest mode alone, without the rest and the other modes, which would beat with it.
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
        # By a and b of lambda = a + j b: derivatives of f = |lambda|/(2 pi), and of zeta = -a/|lambda|.
        slopes = np.array([[a, b] / size[mode] / (2 * np.pi), [-(b**2), a * b] / size[mode] ** 3])
        variances = np.diag(slopes @ fit.covariance[np.ix_(places, places)] @ slopes.T)
        errors[:, mode] = NORMAL_95 * np.sqrt(np.maximum(variances, 0))
    return errors

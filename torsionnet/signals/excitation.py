"""Test signals to excite a drivetrain with: sweeps, stepped sines, multisines, bursts of noise."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from numbers import Real
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Value, plain_number
from torsionnet.base.entries.spec import Count, EntryError, Json, OneOf, Schema, Spec, coerce_part, entry
from torsionnet.base.errors import UsageError, got

# Base class of test signals, the excitations of a test bench.

FloatArray = NDArray[np.float64]

POINTS_PER_CYCLE = 2.0
"""Number of samples per cycle of the highest frequency that a sampling rate must exceed, by the sampling theorem."""


def _are_numbers(values: object) -> bool:
    numbers = np.asarray(values)
    return numbers.ndim == 1 and (numbers.dtype.kind in "iuf" or not len(numbers))


@dataclass(frozen=True, kw_only=True)
class Excitation(ABC, Declared):
    """Test signal of finite length around a mean value, such as the torque that excites a drivetrain in a test.

    Attributes
    ----------
    amplitude : float
        Peak of the alternating part, in the unit of the input: N m for a torque.
    mean : float
        Mean value, added throughout.
    """

    kind: ClassVar[str] = ""

    # The default amplitude of 1 N m is of use in Python only: a file has to state the amplitude of its test.
    amplitude: float = entry(Value("peak of the alternating torque", "torque"), 1.0, must=True)
    mean: float = entry(Value("torque added throughout; the test begins in its equilibrium", "torque", lower=None), 0.0)

    def __post_init__(self) -> None:
        faults = [
            f"{name} must be a positive number, got {value!r}"
            for name in (declared.name for declared in fields(self))
            if name != "mean" and isinstance(value := getattr(self, name), int | float)
            if not (np.isfinite(value) and (value > 0 or (value == 0 and name in self._may_be_zero)))
        ]
        faults += [
            f"{spec.name} must be several numbers, as (1.0,), got {getattr(self, spec.name)!r}"
            for spec in fields(self)
            if str(spec.type).startswith("tuple[float") and not _are_numbers(getattr(self, spec.name))
        ]
        faults += [
            f"{spec.name} must be a number, got {getattr(self, spec.name)!r}"
            for spec in fields(self)
            if str(spec.type) in ("float", "int") and not isinstance(getattr(self, spec.name), Real)
        ]
        if isinstance(self.mean, Real) and not np.isfinite(self.mean):
            faults.append(f"mean must be a number, got {self.mean!r}")
        faults += self._contradictions() if not faults else []
        if faults:
            raise UsageError(f"{self.kind}: {'; '.join(faults)}", kind="out-of-range")

    common: ClassVar[tuple[str, ...]] = ("amplitude", "mean")
    _may_be_zero: ClassVar[tuple[str, ...]] = ("seed",)

    def _contradictions(self) -> list[str]:
        """Errors in the combination of a test signal's values that are valid one by one, as text."""
        return []

    @property
    @abstractmethod
    def length(self) -> float:
        """Duration of the test signal in s."""

    @property
    @abstractmethod
    def highest_frequency(self) -> float:
        """Highest frequency in Hz that the test signal excites."""

    @abstractmethod
    def _alternating(self, time: FloatArray, sampling_rate: float) -> FloatArray:
        """Test signal without its mean at times in s, with a peak amplitude of 1, (n,)."""

    def time(self, sampling_rate: float) -> FloatArray:
        """Times in s of the test signal's samples from 0 on, (n,)."""
        return np.arange(round(self.length * sampling_rate)) / sampling_rate

    def samples(self, sampling_rate: float) -> FloatArray:
        """Samples of the test signal at ``sampling_rate`` Hz, in the unit of its amplitude, (n,).

        Raises
        ------
        UsageError
            The sampling rate is not above twice the highest frequency.
        """
        if not sampling_rate > POINTS_PER_CYCLE * self.highest_frequency:
            top = f"{self.kind} up to {self.highest_frequency:g} Hz"
            raise UsageError(f"{top} needs more than twice that rate, not {sampling_rate:g} Hz", kind="beyond-sampling")
        return self.mean + self.amplitude * self._alternating(self.time(sampling_rate), sampling_rate)


# Test signals made of a sine of changing frequency (linear chirp, logarithmic sweep, stepped sine).

TURN = 2 * np.pi
"""Angle of one turn in rad, the phase of one cycle of a sine."""

_FREQUENCY = Value("frequency", "frequency")


@dataclass(frozen=True, kw_only=True)
class _Sweep(Excitation):
    """Test signal that sweeps a sine from one frequency to another (base class).

    Attributes
    ----------
    start, stop : float
        First and last frequency, Hz.
    duration : float
        Length of the sweep, s.
    """

    start: float = entry(Value("first frequency", "frequency"))
    stop: float = entry(Value("last frequency", "frequency"))
    duration: float = entry(Value("length of the sweep", "time"))

    @property
    def length(self) -> float:
        return self.duration

    @property
    def highest_frequency(self) -> float:
        return max(self.start, self.stop)

    def _contradictions(self) -> list[str]:
        return ["start and stop are the same frequency"] if self.start == self.stop else []


@dataclass(frozen=True, kw_only=True)
class LinearChirp(_Sweep):
    """Test signal, a sine whose frequency changes by the same number of Hz every second.

    f(t) = f_0 + (f_1 - f_0) t / T, and its phase is the integral 2 pi (f_0 t + (f_1 - f_0) t^2 / (2 T)). Equations (1)
    and (2) of Galvagno et al. (2015) print sin(2 pi f(t) t) and f_0 - f_1, which would run the wrong way and twice as
    fast.

    Examples
    --------
    >>> chirp = LinearChirp(start=0.1, stop=80, duration=100, amplitude=15)
    >>> round(float(chirp.frequency(50.0)), 3), len(chirp.samples(10e3))
    (40.05, 1000000)
    """

    kind: ClassVar[str] = "linear chirp"
    _may_be_zero: ClassVar[tuple[str, ...]] = ("start", "stop")

    def frequency(self, time: FloatArray | float) -> FloatArray:
        """Instantaneous frequency of the sweep in Hz at times in s, same shape."""
        return np.asarray(self.start + (self.stop - self.start) * np.asarray(time) / self.duration)

    def _alternating(self, time: FloatArray, sampling_rate: float) -> FloatArray:  # noqa: ARG002
        cycles = (self.start + (self.stop - self.start) * time / (2 * self.duration)) * time
        return np.asarray(np.sin(TURN * cycles))


@dataclass(frozen=True, kw_only=True)
class LogarithmicSweep(_Sweep):
    """Test signal, a sine whose frequency changes by the same factor every second, f(t) = f_0 (f_1/f_0)^(t/T).

    It stays longer at low frequencies, where the resonances of drivetrains with soft springs lie close together.

    Examples
    --------
    >>> sweep = LogarithmicSweep(start=1, stop=100, duration=60)
    >>> float(sweep.frequency(30.0))
    10.0
    """

    kind: ClassVar[str] = "logarithmic sweep"

    def frequency(self, time: FloatArray | float) -> FloatArray:
        """Instantaneous frequency of the sweep in Hz at times in s, same shape."""
        return np.asarray(self.start * (self.stop / self.start) ** (np.asarray(time) / self.duration))

    def _alternating(self, time: FloatArray, sampling_rate: float) -> FloatArray:  # noqa: ARG002
        rate = np.log(self.stop / self.start) / self.duration
        return np.asarray(np.sin(TURN * self.start * np.expm1(rate * time) / rate))


class Frequencies(Spec[tuple[float, ...]]):
    """Entry of a file with a list of frequencies, or ``{from: 1 Hz, to: 40 Hz, count: 60}`` at equal factors."""

    def coerce(self, raw: object) -> tuple[float, ...]:
        if isinstance(raw, Mapping):
            return self._between(raw)
        if isinstance(raw, str) or not hasattr(raw, "__iter__"):
            raise EntryError(
                f"expected a list of frequencies or {{from: 1 Hz, to: 40 Hz, count: 60}}, {got(raw)}", kind="wrong-form"
            )
        return tuple(coerce_part(index, _FREQUENCY, value) for index, value in enumerate(raw))

    def _between(self, raw: Mapping[str, Any]) -> tuple[float, ...]:
        specs: dict[str, Spec[float]] = {
            "from": _FREQUENCY,
            "to": _FREQUENCY,
            "count": Count("", lower=2, upper=100_000),
        }
        if raw.keys() != specs.keys():
            raise EntryError(
                f"expected from, to and count, got {', '.join(map(str, raw)) or 'nothing'}", kind="wrong-form"
            )
        start, stop, count = (coerce_part(key, spec, raw[key]) for key, spec in specs.items())
        try:
            return _steps_between(start, stop, int(count))
        except UsageError as error:
            raise EntryError(error.fault) from None

    def plain(self, value: Any) -> Json:
        return [plain_number(frequency) for frequency in value]

    def schema(self) -> Schema:
        listed: Schema = {"type": "array", "items": SCALAR_SCHEMA, "minItems": 1}
        keys: Schema = {"from": SCALAR_SCHEMA, "to": SCALAR_SCHEMA, "count": {"type": "integer", "minimum": 2}}
        between: Schema = {"type": "object", "properties": keys, "required": list(keys), "additionalProperties": False}
        return {"anyOf": [listed, between], "description": self.description}


def _steps_between(start: float, stop: float, count: int) -> tuple[float, ...]:
    """Frequencies of a stepped sine in Hz, ``count`` of them at equal factors.

    Examples
    --------
    >>> _steps_between(1, 100, 3)
    (1.0, 10.0, 100.0)
    """
    if not (0 < start < stop and count > 1):
        raise UsageError(
            f"steps go from a frequency > 0 to a higher one, at least two: got {start}, {stop}, {count}",
            kind="out-of-range",
        )
    return tuple(np.geomspace(start, stop, count).tolist())


@dataclass(frozen=True, kw_only=True)
class SteppedSine(Excitation):
    """Test signal, a sine that holds each frequency for whole periods, without jumps of the phase.

    Attributes
    ----------
    frequencies : tuple of float
        Hz.
    hold : float
        Time for each in s, rounded up to whole periods.

    Examples
    --------
    >>> steps = SteppedSine(frequencies=(2.0, 5.0), hold=1.1)
    >>> steps.starts.round(6).tolist(), round(steps.length, 6)
    ([0.0, 1.5], 2.7)
    """

    kind: ClassVar[str] = "stepped sine"

    frequencies: tuple[float, ...] = entry(Frequencies("frequencies, one after the other"))
    hold: float = entry(Value("time for each frequency, rounded up to whole periods", "time"))

    def _contradictions(self) -> list[str]:
        sound = all(np.isfinite(f) and f > 0 for f in self.frequencies) and len(self.frequencies) > 0
        return [] if sound else ["frequencies must be positive numbers, at least one"]

    @property
    def _durations(self) -> FloatArray:
        f = np.asarray(self.frequencies, dtype=float)
        return np.asarray(np.ceil(self.hold * f - 1e-9) / f)

    @property
    def starts(self) -> FloatArray:
        """Times in s at which the frequencies of the stepped sine begin, (n_frequencies,)."""
        return np.concatenate([[0.0], np.cumsum(self._durations)[:-1]])

    @property
    def length(self) -> float:
        return float(self._durations.sum())

    @property
    def highest_frequency(self) -> float:
        return max(self.frequencies)

    def _alternating(self, time: FloatArray, sampling_rate: float) -> FloatArray:  # noqa: ARG002
        step = np.searchsorted(self.starts, time, side="right") - 1
        f = np.asarray(self.frequencies, dtype=float)[step]
        return np.asarray(np.sin(TURN * f * (time - self.starts[step])))


SHAPES = ("triangle", "sine")
"""Courses of a load cycle."""


@dataclass(frozen=True, kw_only=True)
class LoadCycles(Excitation):
    """Test signal of a component bench: cycles of one course at every mean, share of the amplitude and frequency.

    A mean is reached by a smooth ramp of one cycle, and cycles begin and end at it, so that nothing jumps.

    Attributes
    ----------
    frequencies, levels, means : tuple of float
        Hz, shares of the amplitude, and means in the unit of the amplitude beside ``mean``: at each mean each level, at
        each level each frequency.
    shape : {"triangle", "sine"}
    cycles : int
        How many of each.

    Examples
    --------
    >>> slow = LoadCycles(frequencies=(0.05,), amplitude=80, levels=(0.5, 1.0), means=(0.0, 100.0), cycles=4)
    >>> slow.length, slow.samples(1.0)[[5, 85, 180, 185]].tolist()
    (340.0, [40.0, 80.0, 100.0, 140.0])
    """

    kind: ClassVar[str] = "load cycles"

    frequencies: tuple[float, ...] = entry(Frequencies("cycles per second, one after the other"))
    shape: str = entry(OneOf("course of a cycle", SHAPES), "triangle")
    cycles: int = entry(Count("how many at every mean, level and frequency", upper=10_000), 6)
    levels: tuple[float, ...] = entry(Listed("shares of the amplitude", Value("share", "1"), form="a list"), (1.0,))
    means: tuple[float, ...] = entry(
        Listed("means of the torque, one after the other", Value("mean", "torque", lower=None), form="a list"), (0.0,)
    )

    def _contradictions(self) -> list[str]:
        if not self.frequencies or min(self.frequencies) <= 0:
            return ["frequencies must be positive numbers, at least one"]
        if not self.levels or not 0 < min(self.levels) <= max(self.levels) <= 1 or not self.means:
            return ["levels are shares of the amplitude above 0 up to 1, and there is at least one mean"]
        if not np.isfinite(self.means).all():
            return [f"means must be numbers, got {', '.join(f'{mean:g}' for mean in self.means)}"]
        if self.shape not in SHAPES or self.cycles != int(self.cycles):
            return [f"shape is {' or '.join(SHAPES)} and cycles a whole number, got {self.shape!r}, {self.cycles!r}"]
        return []

    @property
    def _cycle_pieces(self) -> Iterator[tuple[float, float, float, float]]:
        """Mean before, mean, share of the amplitude and frequency of each piece in turn; a ramp has no share."""
        before = 0.0
        for mean in self.means:
            if mean != before:
                yield before, mean, 0.0, self.frequencies[0]
            before = mean
            for level in self.levels:
                for frequency in self.frequencies:
                    yield mean, mean, level, frequency

    @property
    def length(self) -> float:
        return sum((self.cycles if level else 1) / frequency for _, _, level, frequency in self._cycle_pieces)

    @property
    def highest_frequency(self) -> float:
        return max(self.frequencies)

    def _alternating(self, time: FloatArray, sampling_rate: float) -> FloatArray:  # noqa: ARG002
        signal, start = np.full(len(time), self.means[-1] / self.amplitude), 0.0
        for before, mean, level, frequency in self._cycle_pieces:
            end = start + (self.cycles if level else 1) / frequency
            here = (time >= start) & (time < end)
            turns = frequency * (time[here] - start)
            course = np.sin(TURN * turns)
            # A triangle of height 1 is 2/pi arcsin of the sine.
            if self.shape == "triangle":
                course = 2 / np.pi * np.arcsin(course)
            # From mean to mean by half a cosine, so that not even the rate jumps.
            ramp = (1 - np.cos(np.pi * turns)) / 2 if mean != before else 1.0
            signal[here] = (before + (mean - before) * ramp) / self.amplitude + level * course
            start = end
        return signal


# Broadband test signals to excite a drivetrain with, periodic multisines and bursts of noise.

ComplexArray = NDArray[np.complex128]

WHOLE_PERIOD_TOLERANCE = 1e-9
"""Relative distance of a period from a whole number of samples up to which it counts as one, as floats are rounded."""
PEAK_POINTS_PER_CYCLE = 8
"""Number of points per cycle of the highest line at which the peak of a multisine is searched, to miss little of it."""
CLIPPING_ITERATIONS = 200
"""Number of times a multisine is clipped and its amplitudes are restored, after which the crest factor hardly falls
further."""


@dataclass(frozen=True, kw_only=True)
class _Periodic(Excitation):
    """Test signal of several periods of one length, with lines at multiples of 1/period in a band (base class).

    Attributes
    ----------
    start, stop : float
        Band in Hz.
    period : float
        s; lines are 1/period apart.
    periods : int
    seed : int
        The same seed gives the same signal.
    """

    start: float = entry(Value("lower end of the band", "frequency"))
    stop: float = entry(Value("upper end of the band", "frequency"))
    period: float = entry(Value("length of a period; lines are 1/period apart", "time"))
    periods: int = entry(Count("how many periods", upper=100_000), 1)
    seed: int = entry(Count("the same seed gives the same signal", lower=0, upper=2**32 - 1), 0)

    @property
    def length(self) -> float:
        return self.period * self.periods

    @property
    def highest_frequency(self) -> float:
        return self.stop

    @property
    def lines(self) -> FloatArray:
        """Frequencies of the excited lines in Hz, (n_lines,)."""
        return np.asarray(self._numbers / self.period)

    @property
    def _numbers(self) -> NDArray[np.int_]:
        """Number of cycles per period of each excited line, (n_lines,)."""
        first, last = np.ceil(self.start * self.period - 1e-9), np.floor(self.stop * self.period + 1e-9)
        return np.arange(max(int(first), 1), int(last) + 1)

    def _count(self, sampling_rate: float) -> int:
        """Number of samples in one period of the signal.

        Raises
        ------
        UsageError
            It is not a whole number, so that the lines would leak.
        """
        count = round(self.period * sampling_rate)
        if abs(count - self.period * sampling_rate) > WHOLE_PERIOD_TOLERANCE * count:
            raise UsageError(
                f"{self.kind}: a period of {self.period:g} s is not a whole number of samples at {sampling_rate:g} Hz; "
                "change one of them",
                kind="contradicting-values",
            )
        return count

    def _contradictions(self) -> list[str]:
        if self.start >= self.stop:
            return ["start must be below stop"]
        if not len(self.lines):
            return [f"no line between {self.start:g} and {self.stop:g} Hz with a period of {self.period:g} s"]
        return []


@dataclass(frozen=True, kw_only=True)
class Multisine(_Periodic):
    """Test signal, a multisine with equal amplitudes at all lines of a band, and phases for a low peak.

    From Schroeder's phases on, the signal is clipped and its amplitudes are restored again and again (Van der Ouderaa,
    Schoukens and Renneboog 1988).

    Examples
    --------
    >>> burst = Multisine(start=0.5, stop=40, period=8, periods=5)
    >>> x = burst.samples(1000)
    >>> bool(abs(x).max() / x.std() < 1.6), len(burst.lines)
    (True, 317)
    """

    kind: ClassVar[str] = "multisine"

    @cached_property
    def _spectrum(self) -> ComplexArray:
        """Complex amplitudes (n_lines,) of the multisine's lines, scaled to a peak of 1."""
        numbers = self._numbers
        size, order = int(PEAK_POINTS_PER_CYCLE * numbers[-1]), np.arange(len(numbers))
        # Schroeder's phases, whose peak is low; clipping with the magnitudes put back lowers it further.
        values = np.exp(-1j * np.pi * order * (order - 1) / len(numbers))
        best, lowest = values, np.inf
        for level in np.linspace(0.75, 0.95, CLIPPING_ITERATIONS):
            signal = _periodic(numbers, values, size)
            peak = np.abs(signal).max()
            if peak < lowest:
                best, lowest = values, peak
            clipped = np.fft.rfft(np.clip(signal, -level * peak, level * peak))[numbers]
            values = np.exp(1j * np.angle(clipped))
        return np.asarray(best / np.abs(_periodic(numbers, best, 4 * size)).max())

    def _alternating(self, time: FloatArray, sampling_rate: float) -> FloatArray:  # noqa: ARG002
        return np.tile(_periodic(self._numbers, self._spectrum, self._count(sampling_rate)), self.periods)


@dataclass(frozen=True, kw_only=True)
class BurstRandom(_Periodic):
    """Test signal, a burst of noise in a band for a share of each period, then silence in which the drivetrain rests.

    Every period has noise of its own. ``amplitude`` is the peak.

    Attributes
    ----------
    share : float
        Of a period with noise, 0 to 1.

    Examples
    --------
    >>> x = BurstRandom(start=1, stop=40, period=4, periods=3, share=0.5, seed=7).samples(200)
    >>> float(abs(x[400:800]).max()), float(abs(x).max())
    (0.0, 1.0)
    """

    kind: ClassVar[str] = "burst random"

    share: float = entry(Value("share of a period with noise", "1"), 0.5)

    def _contradictions(self) -> list[str]:
        return super()._contradictions() + ([] if self.share <= 1 else ["share must be at most 1"])

    def _alternating(self, time: FloatArray, sampling_rate: float) -> FloatArray:  # noqa: ARG002
        rng = np.random.default_rng(self.seed)
        count = self._count(sampling_rate)
        noise = rng.standard_normal((2, self.periods, len(self._numbers)))
        bursts = [_periodic(self._numbers, real + 1j * imag, count) for real, imag in zip(*noise, strict=True)]
        gate = np.arange(count) < self.share * count
        signal = np.concatenate([gate * burst for burst in bursts])
        return np.asarray(signal / np.abs(signal).max())


def _periodic(numbers: NDArray[np.int_], values: ComplexArray, size: int) -> FloatArray:
    """Samples (size,) of one period of a signal, from the complex amplitudes of its lines."""
    spectrum = np.zeros(size // 2 + 1, dtype=complex)
    spectrum[numbers] = values
    return np.asarray(np.fft.irfft(spectrum, size) * size / 2)

"""Test signals made of a sine of changing frequency (linear chirp, logarithmic sweep, stepped sine)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Value, plain_number
from torsionnet.base.entries.spec import Count, EntryError, Json, Schema, Spec, coerce_part, entry
from torsionnet.base.errors import UsageError, got
from torsionnet.signals.excitation.excitation import Excitation, FloatArray

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
            raise EntryError(f"expected a list of frequencies or {{from: 1 Hz, to: 40 Hz, count: 60}}, {got(raw)}")
        return tuple(coerce_part(index, _FREQUENCY, value) for index, value in enumerate(raw))

    def _between(self, raw: Mapping[str, Any]) -> tuple[float, ...]:
        specs: dict[str, Spec[float]] = {
            "from": _FREQUENCY,
            "to": _FREQUENCY,
            "count": Count("", lower=2, upper=100_000),
        }
        if raw.keys() != specs.keys():
            raise EntryError(f"expected from, to and count, got {', '.join(map(str, raw)) or 'nothing'}")
        start, stop, count = (coerce_part(key, spec, raw[key]) for key, spec in specs.items())
        try:
            return _steps_between(start, stop, int(count))
        except UsageError as error:
            raise EntryError(str(error)) from None

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
        raise UsageError(f"steps go from a frequency > 0 to a higher one, at least two: got {start}, {stop}, {count}")
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

"""History of a torque over time as a sum of straight lines and of waves that may decay, exact at every time."""

from __future__ import annotations

from bisect import bisect_right
from cmath import exp
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, pi
from typing import TYPE_CHECKING, Any, TypeAlias

from torsionnet.base.entries.composite import Composite
from torsionnet.base.entries.scalars import (
    SCALAR_SCHEMA,
    AnyQuantity,
    PhysicalQuantity,
    Value,
    plain_number,
    plain_scalar,
)
from torsionnet.base.entries.spec import EntryError, Json, Schema, Spec
from torsionnet.base.errors import EntryPath, Fault, got, unknown_key
from torsionnet.base.expressions import Expression, Number
from torsionnet.model.elements import Values

if TYPE_CHECKING:
    import numpy as np  # reading and checking a model file does without
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]
SAMPLE_SLACK = 1e-6
"""Share of a sampling interval by which a piece may begin after a sample and still hold at it, since times of samples
are quotients and rounded."""


@dataclass(frozen=True)
class Wave:
    """Term Re(A exp(s (t - t_0))) of a history, with the complex amplitude A and the exponent s in 1/s."""

    amplitude: complex
    exponent: complex


@dataclass(frozen=True)
class HistoryPiece:
    """Piece value + slope (t - t_0) + sum of waves of a history, which holds from t_0 = ``start`` in s.

    Attributes
    ----------
    start : float
        s.
    value, slope : float
        Unit of the history, and that in a second.
    waves : tuple of Wave
    """

    start: float
    value: float = 0.0
    slope: float = 0.0
    waves: tuple[Wave, ...] = ()

    def values_at(self, times: FloatArray) -> FloatArray:
        """Values (n,) of the piece at times in s, also where another piece holds."""
        import numpy as np

        passed = times - self.start
        total = self.value + self.slope * passed
        for wave in self.waves:
            total = total + (wave.amplitude * np.exp(wave.exponent * passed)).real
        return np.asarray(total, dtype=float)

    def begun(self, start: float) -> HistoryPiece:
        """Piece with the same values, counted from another time in s."""
        passed = start - self.start
        waves = tuple(Wave(wave.amplitude * exp(wave.exponent * passed), wave.exponent) for wave in self.waves)
        return HistoryPiece(start, self.value + self.slope * passed, self.slope, waves)


@dataclass(frozen=True)
class TimeHistory:
    """History of a torque, or of what scales one, over time: each piece holds until the next one begins.

    Before the first piece, which begins at 0 s, its value there holds.

    Examples
    --------
    >>> ramp = TimeHistory((HistoryPiece(0.0, 20.0, 4600.0), HistoryPiece(0.05, 250.0)))
    >>> ramp.samples(100.0, 8).tolist()
    [20.0, 66.0, 112.0, 158.0, 204.0, 250.0, 250.0, 250.0]
    """

    pieces: tuple[HistoryPiece, ...]

    @property
    def first(self) -> float:
        """Value of the history at 0 s."""
        begun = self.pieces[0].begun(0.0)
        return begun.value + sum(wave.amplitude.real for wave in begun.waves)

    @property
    def breaks(self) -> tuple[float, ...]:
        """Times in s at which a new piece begins, that of the first left out."""
        return tuple(piece.start for piece in self.pieces[1:])

    def samples(self, rate: float, count: int) -> FloatArray:
        """Values (count,) of the history at ``rate`` Hz from 0 s; where it jumps, those after the jump."""
        import numpy as np

        values = np.zeros(count)
        for number, piece in enumerate(self.pieces):
            begin = 0 if number == 0 else first_sample(piece.start, rate)
            values[begin:] = piece.values_at(np.arange(begin, max(begin, count)) / rate)
        return values

    def piece_at(self, time: float) -> HistoryPiece:
        """Piece that holds from a time in s on."""
        return self.pieces[max(0, bisect_right(self.pieces, time, key=lambda piece: piece.start) - 1)]

    def __add__(self, other: TimeHistory) -> TimeHistory:
        starts = sorted({piece.start for history in (self, other) for piece in history.pieces})
        pieces = []
        for start in starts:
            a, b = (history.piece_at(start).begun(start) for history in (self, other))
            pieces.append(HistoryPiece(start, a.value + b.value, a.slope + b.slope, (*a.waves, *b.waves)))
        return TimeHistory(tuple(pieces))

    @property
    def fastest(self) -> float:
        """Highest frequency in Hz of the waves of the history, 0 without waves."""
        sizes = (abs(wave.exponent.imag) for piece in self.pieces for wave in piece.waves)
        return max(sizes, default=0.0) / (2 * pi)


def first_sample(start: float, rate: float) -> int:
    """Number of the first sample at ``rate`` Hz that does not lie before a time in s.

    >>> first_sample(0.1, 1e3), first_sample(0.1001, 1e3)
    (100, 101)
    """
    return max(0, ceil(start * rate - SAMPLE_SLACK))


def held_course(values: FloatArray, rate: float) -> TimeHistory:
    """History of values at ``rate`` Hz from 0 s, each of which holds until the next."""
    listed = values.tolist()
    new = [number for number, value in enumerate(listed) if not number or value != listed[number - 1]]
    return TimeHistory(tuple(HistoryPiece(number / rate, listed[number]) for number in new))


def constant(value: float) -> TimeHistory:
    """History of one value."""
    return TimeHistory((HistoryPiece(0.0, value),))


def straight(rows: Iterable[tuple[float, float]]) -> TimeHistory:
    """History that runs straight between rows (time in s, value) and stands still before and after them.

    A time given twice is a jump.

    >>> straight([(0.1, 0.0), (0.1, 5.0), (0.3, 9.0)]).samples(10.0, 5).tolist()
    [0.0, 5.0, 7.0, 9.0, 9.0]
    """
    listed = list(rows)
    pieces = [HistoryPiece(0.0, listed[0][1])] if listed[0][0] > 0 or len(listed) == 1 else []
    for (begin, low), (end, high) in pairwise(listed):
        if end > begin:
            pieces.append(HistoryPiece(begin, low, (high - low) / (end - begin)))
    if len(listed) > 1:
        pieces.append(HistoryPiece(listed[-1][0], listed[-1][1]))
    return TimeHistory(tuple(pieces))


# Entry for a value over time: a constant, rows of times and values, or a sinusoid about a mean.

TIME = Value("a time", "time")
_FREQUENCY = PhysicalQuantity("frequency", "frequency", exclusive=True)
_PHASE = PhysicalQuantity("phase of the cosine", "angle", lower=None)
_WORDS = ("mean", "amplitude", "frequency", "phase")


@dataclass(frozen=True)
class SteadyCourse:
    """Course of one value."""

    value: Expression

    def history(self, value: Values) -> TimeHistory:
        """History of the course with the values of parameters."""
        return constant(float(value(self.value)))

    def parts(self) -> Iterator[tuple[str, Expression]]:
        """Yield the name of the entry and the expression of every value of the course."""
        yield "", self.value


@dataclass(frozen=True)
class StraightCourse:
    """Course that runs straight between rows of times in s and values, and stands still before and after them."""

    rows: tuple[tuple[float, Expression], ...]

    def history(self, value: Values) -> TimeHistory:
        """History of the course with the values of parameters."""
        return straight((time, float(value(expression))) for time, expression in self.rows)

    def parts(self) -> Iterator[tuple[str, Expression]]:
        """Yield the name of the entry and the expression of every value of the course."""
        for _, expression in self.rows:
            yield "", expression


@dataclass(frozen=True)
class SineCourse:
    """Course mean + amplitude cos(2 pi frequency t + phase)."""

    amplitude: Expression
    frequency: Expression
    mean: Expression = Number(0)
    phase: Expression = Number(0)

    def history(self, value: Values) -> TimeHistory:
        """History of the course with the values of parameters."""
        from cmath import rect

        mean, size, frequency, phase = (float(value(getattr(self, name))) for name in _WORDS)
        wave = Wave(rect(size, phase), complex(0.0, 2 * pi * frequency))
        return TimeHistory((HistoryPiece(0.0, mean, 0.0, (wave,)),))

    def parts(self) -> Iterator[tuple[str, Expression]]:
        """Yield the name of the entry and the expression of every value of the course."""
        for name in _WORDS:
            yield name, getattr(self, name)


Course: TypeAlias = SteadyCourse | StraightCourse | SineCourse


@dataclass(frozen=True, eq=False, repr=False)
class HistoryEntry(Composite[Course]):
    """Entry for a value over time, ``20 N*m``, ``{0 s: 20 N*m, 50 ms: 250 N*m}`` or a sinusoid.

    Between its rows the value runs straight; before the first and after the last it stands still. Rows as a list,
    ``[[0.1 s, 0 N*m], [0.1 s, 250 N*m]]``, may give a time twice, which is a jump. A sinusoid
    ``{mean: 40 N*m, amplitude: 60 N*m, frequency: 10 Hz, phase: 0 deg}`` is mean + amplitude cos(2 pi f t + phase).
    """

    dimension: str = ""
    """Name of the dimension of the value; empty: any."""

    @property
    def of(self) -> Spec[Expression]:
        """Specification of one value."""
        if not self.dimension:
            return AnyQuantity("a value")
        return PhysicalQuantity(f"a {self.dimension}", self.dimension, lower=None)

    @property
    def example(self) -> str:
        unit = " N*m" if self.dimension in ("torque", "") else ""
        sine = f"{{mean: 40{unit}, amplitude: 60{unit}, frequency: 10 Hz}}"
        return f"20{unit}, {{0 s: 20{unit}, 50 ms: 250{unit}}} or {sine}"

    def read(self, raw: object) -> tuple[Course | None, list[Fault]]:
        if isinstance(raw, SteadyCourse | StraightCourse | SineCourse):
            return raw, []
        if isinstance(raw, Mapping):
            return self._sine(raw) if set(raw) & set(_WORDS) else self._rows(list(raw.items()), keyed=True)
        if isinstance(raw, list | tuple):
            wrong = [place for place, row in enumerate(raw) if not isinstance(row, list | tuple) or len(row) != 2]
            if wrong:
                return None, [
                    Fault(f"a row is [time, value], {got(raw[place])}", (place,), kind="wrong-form") for place in wrong
                ]
            return self._rows([(row[0], row[1]) for row in raw], keyed=False)
        try:
            return SteadyCourse(self.of.coerce(raw)), []
        except EntryError as error:
            example = f"; over time, as {self.example}"
            return None, [replace(fault, message=fault.message + example) for fault in error.faults]

    def _rows(self, raw: list[tuple[Any, Any]], *, keyed: bool) -> tuple[Course | None, list[Fault]]:
        if not raw:
            return None, [Fault(f"expected {self.example}, got no rows", kind="missing-entry")]
        faults: list[Fault] = []
        rows: list[tuple[float, Expression]] = []
        latest = -1.0
        for place, (key, given) in enumerate(raw):
            at: EntryPath = (key,) if keyed else (place, 0)
            try:
                time = TIME.coerce(key)
            except EntryError as error:
                text = f"a row begins with a time, as 50 ms: {error}"
                faults.append(Fault(text, at, on_key=keyed, kind=error.fault.kind))
                continue
            if time < latest or (keyed and time == latest):
                faults.append(
                    Fault(
                        f"{key} stands after {latest:g} s; the times of a history rise",
                        at,
                        on_key=keyed,
                        kind="unordered-rows",
                    )
                )
            latest = max(latest, time)
            course, further = self.of.read(given)
            faults += [fault.under(*((key,) if keyed else (place, 1))) for fault in further]
            if course is not None:
                rows.append((time, course))
        # Two rows at one time are a jump, the left and the right value.
        thrice = [time for time, after in zip([row[0] for row in rows], [row[0] for row in rows[2:]], strict=False)
                  if time == after]  # fmt: skip
        faults += [
            Fault(f"{time:g} s stands three times; a jump has two rows", kind="unordered-rows")
            for time in dict.fromkeys(thrice)
        ]
        return (None, faults) if faults else (StraightCourse(tuple(rows)), [])

    def _sine(self, raw: Mapping[Any, Any]) -> tuple[Course | None, list[Fault]]:
        specs: dict[str, Spec[Expression]] = {
            "mean": self.of, "amplitude": self.of, "frequency": _FREQUENCY, "phase": _PHASE
        }  # fmt: skip
        rest = f"a sinusoid has {', '.join(_WORDS)}"
        faults = [unknown_key(key, list(_WORDS), (key,), rest) for key in raw if key not in specs]
        faults += [
            Fault(f"a sinusoid needs its {key}", on_key=True, kind="missing-entry")
            for key in ("amplitude", "frequency")
            if raw.get(key) is None
        ]
        values: dict[str, Any] = {}
        for key, spec in specs.items():
            if raw.get(key) is not None:
                values[key], further = spec.read(raw[key])
                faults += [fault.under(key) for fault in further]
        return (None, faults) if faults else (SineCourse(**values), [])

    def expressions(self, value: Any) -> tuple[tuple[EntryPath, Expression, str], ...]:
        wanted = {"frequency": "frequency", "phase": "angle"}
        return tuple(((name,) if name else (), part, wanted.get(name, self.dimension)) for name, part in value.parts())

    def plain(self, value: Any) -> Json:
        if isinstance(value, SteadyCourse):
            return plain_scalar(value.value)
        if isinstance(value, SineCourse):
            return {name: plain_scalar(expression) for name, expression in value.parts() if expression != Number(0)}
        times = [time for time, _ in value.rows]
        rows = [(f"{plain_number(time)} s", plain_scalar(expression)) for time, expression in value.rows]
        return dict(rows) if len(set(times)) == len(times) else [list(row) for row in rows]

    def schema(self) -> Schema:
        row: Schema = {"type": "array", "items": SCALAR_SCHEMA, "minItems": 2, "maxItems": 2}
        rows: Schema = {"type": "object", "additionalProperties": SCALAR_SCHEMA, "minProperties": 1}
        return {
            "description": self.description,
            "anyOf": [SCALAR_SCHEMA, rows, {"type": "array", "items": row, "minItems": 1}],
        }

    @property
    def accepted(self) -> str:
        return "Scalar | collections.abc.Mapping[typing.Any, Scalar] | list[list[Scalar]]"

"""Recording of signals sampled together on a test bench, real or simulated."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.notes import NoteOrText
from torsionnet.base.packages import NotebookResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.linear.between_samples import Between, BetweenSamples, check_between
from torsionnet.signals.rotation.pulse_channel import PulseChannel

if TYPE_CHECKING:
    import pandas

    from torsionnet.signals.stepped_levels import SteppedStiffness

# Energy balance of motion over time.


@dataclass(frozen=True)
class DissipatedEnergy:
    """Energy in J that an element has turned into heat in a motion."""

    element: Annotated[str, Out("element")]
    energy: Annotated[float, Out("turned into heat", "J", json="energy_J")]


@dataclass(frozen=True)
class EnergyBalance:
    """Energies in J between the first and the last sample of a motion over time.

    Attributes
    ----------
    supplied : float
        Work of the torques from outside.
    stored : float
        Rise of the kinetic energy of inertias and of the energy stored in springs.
    dissipated : mapping
        Energy that each element has turned into heat, by name.

    Examples
    --------
    >>> EnergyBalance(10.0, 7.5, {"clutch": 2.5}).left_over
    0.0
    """

    SHOWN: ClassVar = ("supplied", "stored", "left_over", "heat")

    supplied: Annotated[float, Out(json="supplied_J")]
    stored: Annotated[float, Out(json="stored_J")]
    dissipated: Mapping[str, float] = field(default_factory=dict)

    @property
    def left_over(self) -> Annotated[float, Out(json="left_over_J")]:
        """Energy in J that the sums do not account for: the error of the calculation."""
        return self.supplied - self.stored - sum(self.dissipated.values())

    @property
    def heat(self) -> Annotated[tuple[DissipatedEnergy, ...], Out(json="dissipated")]:
        """Energy that each element has turned into heat, as it is shown."""
        return tuple(DissipatedEnergy(name, float(energy)) for name, energy in self.dissipated.items())

    @property
    def balance(self) -> EnergyBalance:
        """Balance itself, as a :class:`DeferredBalance` has it."""
        return self


class DeferredBalance:
    """Energy balance worked out when it is first asked for, since works of many dampers cost more than the motion.

    It has the fields of an :class:`EnergyBalance`, and is stored as one.

    >>> DeferredBalance(lambda: EnergyBalance(10.0, 7.5, {"clutch": 2.5}))
    EnergyBalance(supplied=10.0, stored=7.5, dissipated={'clutch': 2.5})
    """

    def __init__(self, work_out: Callable[[], EnergyBalance]) -> None:
        self._work_out: Callable[[], EnergyBalance] | None = work_out

    @cached_property
    def balance(self) -> EnergyBalance:
        """Balance itself, after which what it was worked out from is no longer held."""
        assert self._work_out is not None
        balance, self._work_out = self._work_out(), None
        return balance

    @property
    def supplied(self) -> float:
        """Work of the torques from outside in J."""
        return self.balance.supplied

    @property
    def stored(self) -> float:
        """Rise of kinetic and stored energy in J."""
        return self.balance.stored

    @property
    def dissipated(self) -> Mapping[str, float]:
        """Energy in J that each element has turned into heat, by name."""
        return self.balance.dissipated

    @property
    def left_over(self) -> float:
        """Energy in J that the sums do not account for: the error of the calculation."""
        return self.balance.left_over

    def __eq__(self, other: object) -> bool:
        return self.balance == (other.balance if isinstance(other, DeferredBalance) else other)

    def __repr__(self) -> str:
        return repr(self.balance)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[type[EnergyBalance], tuple[float, float, dict[str, float]]]:
        return EnergyBalance, (self.supplied, self.stored, dict(self.dissipated))


AnyBalance: TypeAlias = EnergyBalance | DeferredBalance
"""Energy balance of a motion, worked out or not yet."""


# Events of motion over time, as a contact that closes or a clutch that locks.


@dataclass(frozen=True)
class MotionEvent:
    """Change of the piece of a law of motion at a time in s.

    Attributes
    ----------
    time : float
        Time of the event in s.
    element : str
        Name of the element whose law changes its piece.
    what : str
        The change in words, as ``closes``, ``opens``, ``sticks``, ``slips``, ``stage 2``.

    Examples
    --------
    >>> str(MotionEvent(0.2873563, "clutch", "sticks"))
    '0.287356 s: clutch sticks'
    """

    time: Annotated[float, Out("time", "s", json="time_s")]
    element: Annotated[str, Out("element")]
    what: Annotated[str, Out("what")]

    def __str__(self) -> str:
        return f"{self.time:.6g} s: {self.element} {self.what}"


FloatArray = NDArray[np.float64]

QUANTITY_UNITS = {"torque": "N*m", "angle": "rad", "velocity": "rad/s", "acceleration": "rad/s^2", "stress": "Pa"}
"""SI unit of the values of a signal by its quantity, such as torque."""

LOWEST_SAMPLING_RATE, HIGHEST_SAMPLING_RATE = 1e-15, 1e15
"""Lowest and highest sampling rate in Hz that are accepted, as a rate beyond them is a mistake."""


def is_rate(sampling_rate: float) -> bool:
    """Whether a number is a possible sampling rate in Hz.

    >>> is_rate(10e3), is_rate(0.0), is_rate(1e300), is_rate(float("nan"))
    (True, False, False, False)
    """
    return LOWEST_SAMPLING_RATE <= sampling_rate <= HIGHEST_SAMPLING_RATE


@dataclass(frozen=True, eq=False)
class Signal:
    """Signal of a recording with the name, quantity and values in SI units of one channel.

    Attributes
    ----------
    name : str
    quantity : str
        A key of ``QUANTITY_UNITS``, or empty where it is not known.
    values : (n,) array
        Values in the SI unit of the quantity.
    notes : tuple of str or Note
        Origin and processing of the values.
    between : {"band_limited", "straight", "held"}
        Course between samples: nothing above half the sampling rate, straight lines, or each value held until the next.
        Fits and estimates take a torque that drives as it says.
    course_rate : float, optional
        Sampling rate in Hz that ``between`` speaks of, where the signal has been brought to another one since.
    """

    SHOWN: ClassVar = ("name", "unit", "smallest", "largest", "rms", "notes")

    name: Annotated[str, Out("channel")]
    quantity: str
    values: FloatArray
    notes: Annotated[tuple[NoteOrText, ...], Out("notes")] = ()
    between: Between = "band_limited"
    course_rate: float | None = None

    def __post_init__(self) -> None:
        check_between(self.between)

    @property
    def unit(self) -> Annotated[str, Out("unit")]:
        """SI unit of the values of a signal; empty where the quantity is not known."""
        return QUANTITY_UNITS.get(self.quantity, "")

    @property
    def smallest(self) -> Annotated[float, Out("smallest", digits=4)]:
        """Smallest value of a signal."""
        return float(self.values.min())

    @property
    def largest(self) -> Annotated[float, Out("largest", digits=4)]:
        """Largest value of a signal."""
        return float(self.values.max())

    @property
    def rms(self) -> Annotated[float, Out("RMS", json="RMS", digits=4)]:
        """Root mean square of the values of a signal."""
        return float((self.values**2).mean() ** 0.5)

    def course(self, sampling_rate: float) -> BetweenSamples:
        """Course of the signal between samples of a record at a rate in Hz."""
        return BetweenSamples(self.between, self.course_rate or sampling_rate)

    def at_other_rate(self, values: FloatArray, sampling_rate: float) -> Signal:
        """Signal with the values at other times, which were at a rate in Hz before."""
        kept = None if self.between == "band_limited" else self.course_rate or sampling_rate
        return replace(self, values=values, course_rate=kept)


@dataclass(frozen=True, eq=False, repr=False)
class Recording(NotebookResult):
    """Recording of signals in SI units with a common sampling rate in Hz.

    Attributes
    ----------
    signals : tuple of Signal
        Signals, all of one length.
    sampling_rate : float
        Sampling rate, Hz.
    start : float
        Time of the first sample, s.
    times : (n,) array, optional
        Time stamps in s where sampling is not uniform; the sampling rate is then their mean rate.
    title : str
    notes : tuple of str or Note
        Origin: file, assumptions made in reading it, processing since.
    pulses : tuple of PulseChannel
        Times of the pulses of toothed wheels and encoders on the same clock, each of a length of its own.
    events : tuple of MotionEvent
        Of a simulation with laws of motion: contacts that close and open, friction that sticks and slips.
    energy : EnergyBalance, optional
        Of such a simulation.

    Examples
    --------
    >>> record = Recording((Signal("T_T", "torque", np.array([0.0, 1.0])),), sampling_rate=10e3)
    >>> record["T_T"].unit, record.duration
    ('N*m', 0.0002)
    """

    picture: ClassVar[str] = "time_histories"

    signals: Annotated[tuple[Signal, ...], Out(json="channels")]
    sampling_rate: Annotated[float, Out(json="sampling_rate_Hz")]
    start: Annotated[float, Out(json="start_s")] = 0.0
    times: FloatArray | None = None
    title: str = ""
    notes: tuple[NoteOrText, ...] = ()
    pulses: tuple[PulseChannel, ...] = ()
    events: tuple[MotionEvent, ...] = ()
    energy: AnyBalance | None = None

    def __post_init__(self) -> None:
        lengths = {len(signal.values) for signal in self.signals}
        if len(lengths) > 1:
            sizes = ", ".join(f"{signal.name} has {len(signal.values)}" for signal in self.signals)
            raise UsageError(f"the signals of a recording must be of one length: {sizes}", kind="unlike-results")
        if not is_rate(self.sampling_rate):
            raise UsageError(
                f"the sampling rate must be a positive number of Hz, got {self.sampling_rate}", kind="out-of-range"
            )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the signals of a recording."""
        return tuple(signal.name for signal in self.signals)

    def __len__(self) -> int:
        """Number of samples of each signal of a recording."""
        return len(self.signals[0].values) if self.signals else 0

    def __iter__(self) -> Iterator[Signal]:
        return iter(self.signals)

    def __getitem__(self, name: str) -> Signal:
        for signal in self.signals:
            if signal.name == name:
                return signal
        raise UsageError(
            f'no signal is named "{name}"{did_you_mean(name, self.names)}; there is {", ".join(self.names) or "none"}',
            kind="unknown-channel",
        )

    def pulses_of(self, name: str) -> PulseChannel:
        """Times of the pulses of a channel of a recording in s, by its name.

        Raises
        ------
        UsageError
            There is no such channel of pulses.
        """
        for channel in self.pulses:
            if channel.name == name:
                return channel
        known = [channel.name for channel in self.pulses]
        text = f'no channel of pulses is named "{name}"{did_you_mean(name, known)}'
        raise UsageError(f"{text}; there is {', '.join(known) or 'none'}", kind="unknown-channel")

    @property
    def samples(self) -> int:
        """Number of samples of each signal of a recording."""
        return len(self)

    @property
    def duration(self) -> Annotated[float, Out(json="duration_s")]:
        """Length of a recording in s, one sampling interval for every sample."""
        return len(self) / self.sampling_rate

    @property
    def time(self) -> FloatArray:
        """Times of all samples of a recording in s, shape (n,)."""
        return self.start + np.arange(len(self)) / self.sampling_rate if self.times is None else self.times

    def select(self, names: Iterable[str]) -> Recording:
        """Recording of the named signals and channels of pulses only, in the order of the names."""
        wanted = list(names)
        trains = {channel.name: channel for channel in self.pulses if channel.name in wanted}
        signals = tuple(self[name] for name in wanted if name not in trains or name in self.names)
        return replace(self, signals=signals, pulses=tuple(trains[name] for name in wanted if name in trains))

    def between(self, start: float | None = None, stop: float | None = None) -> Recording:
        """Recording from one time to another in s, ends included, with its pulses; without an end up to its own.

        Examples
        --------
        >>> record = Recording((Signal("T", "torque", np.arange(10.0)),), sampling_rate=10.0)
        >>> record.between(0.25, 0.5)["T"].values.tolist()
        [3.0, 4.0, 5.0]
        """
        if start is None and stop is None:
            return self
        first, last = -np.inf if start is None else start, np.inf if stop is None else stop

        def kept(times: FloatArray) -> FloatArray:
            return np.asarray((times >= first) & (times <= last))

        inside = kept(self.time)
        times = self.time[inside]
        pulses = tuple(replace(channel, times=channel.times[kept(channel.times)]) for channel in self.pulses)
        return replace(
            self,
            signals=tuple(replace(signal, values=signal.values[inside]) for signal in self.signals),
            start=float(times[0]) if len(times) else self.start,
            times=None if self.times is None else times,
            pulses=pulses,
        ).with_notes(f"cut to {first:g} to {last:g} s")

    def with_pulses(self, *channels: PulseChannel) -> Recording:
        """Copy of the recording with channels of pulses added, or exchanged where one of the same name exists."""
        new = {channel.name: channel for channel in channels}
        kept = [new.pop(channel.name, channel) for channel in self.pulses]
        return replace(self, pulses=(*kept, *new.values()))

    def with_signals(self, *signals: Signal) -> Recording:
        """Copy of the recording with signals added, or exchanged where a signal of the same name exists."""
        new = {signal.name: signal for signal in signals}
        kept = [new.pop(signal.name, signal) for signal in self.signals]
        return replace(self, signals=(*kept, *new.values()))

    def with_notes(self, *notes: NoteOrText) -> Recording:
        """Copy of the recording with notes added behind those it already has."""
        return replace(self, notes=(*self.notes, *notes))

    def __repr__(self) -> str:
        size = f"{len(self)} samples at {self.sampling_rate:g} Hz, {self.duration:g} s" if self.signals else ""
        trains = ", ".join(f"{channel.name} of {len(channel)} pulses" for channel in self.pulses)
        return f"<Recording {', '.join(self.names)}: {'; '.join(filter(None, (size, trains)))}>"

    def to_dataframe(self) -> pandas.DataFrame:
        """Signals as a pandas.DataFrame in SI units, with the times in s as index; ``attrs`` has title, units, notes.

        Raises
        ------
        MissingExtraError
            pandas is not installed.
        """
        from torsionnet.base.table import data_frame

        units = {signal.name: signal.unit for signal in self.signals}
        values = np.column_stack([signal.values for signal in self.signals]) if units else np.empty((len(self), 0))
        return data_frame(values, ("time [s]", self.time), units, self.title, self.notes)

    def stepped_stiffness(self, output: str, input: str) -> SteppedStiffness:
        """First harmonics of the torque through an element and of its twist, at the steps of a sine test.

        Steps are cycles of one frequency and one amplitude in a row, found in the twist. Each gives k' + j k'' over
        the amplitude, its loss factor eta_1 = k''/k', and with an inertia a point of the backbone.

        Parameters
        ----------
        output, input : str
            Names of the torque and of the twist.

        Raises
        ------
        UsageError
            The signals are no torque and no angle, or hold no frequency and amplitude for four cycles.

        Examples
        --------
        >>> t = np.arange(0, 20, 0.002)
        >>> twist = np.where(t < 10, 0.05, 0.2) * np.sin(10 * t)
        >>> record = Recording((Signal("T", "torque", 460 * twist + 3000 * twist**3), Signal("g", "angle", twist)), 500)
        >>> steps = record.stepped_stiffness("T", "g")
        >>> steps.amplitudes.round(4).tolist(), steps.stiffness.real.round(2).tolist()
        ([0.05, 0.2], [465.62, 550.0])
        """
        from torsionnet.signals.stepped_levels import stepped_stiffness

        for name, quantity in ((output, "torque"), (input, "angle")):
            if self[name].quantity != quantity:
                text = "the output of a stiffness is a torque, its input an angle of twist"
                raise UsageError(f"{text}, and {name} is of the quantity {self[name].quantity}", kind="unfit-channel")
        values = (self[output].values, self[input].values)
        return stepped_stiffness(*values, self.sampling_rate, self.title, self.notes)

    def table(self) -> Table:
        """Table of the signals of a recording with unit, mean, standard deviation and range of each.

        >>> Recording((Signal("T_T", "torque", np.array([0.0, 2.0])),), sampling_rate=10).table().rows
        (('T_T', 'torque', 'N*m', 1.0, 1.0, 0.0, 2.0),)
        """
        columns = tuple(map(Column, ("signal", "quantity", "unit", "mean", "standard deviation", "lowest", "highest")))
        rows = tuple(_described(signal) for signal in self.signals)
        span = f"{len(self)} samples at {self.sampling_rate:g} Hz, {self.duration:g} s"
        trains = tuple(f"{channel.name}: {channel.span}" for channel in self.pulses)
        return Table(self.title or "Recording", columns, rows, (span, *trains, *map(str, self.notes)))


def _described(signal: Signal) -> tuple[str | float | None, ...]:
    known = signal.values[np.isfinite(signal.values)]
    numbers = (known.mean(), known.std(), known.min(), known.max()) if len(known) else (None,) * 4
    return (signal.name, signal.quantity, signal.unit, *(None if x is None else float(x) for x in numbers))

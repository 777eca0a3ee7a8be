"""Summary of a simulated motion: peaks of its signals with their times, events, and energies."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from torsionnet.base.notes import NoteOrText
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.signals.recording import MotionEvent

if TYPE_CHECKING:
    from torsionnet.signals.recording import Recording

CLOSED_BALANCE = 1e-9
"""Share of the energies of a motion that its balance may leave over as rounding; digits below are the machine's."""

MOST_EVENTS_SHOWN = 20
"""Events of a motion that a table shows, as a page has room for; a motion that rattles has thousands."""


@dataclass(frozen=True)
class SignalPeaks:
    """Highest and lowest value of a signal over time, with their times in s, and its value at the end."""

    signal: Annotated[str, Out("signal")]
    unit: Annotated[str, Out("unit")]
    highest: Annotated[float, Out("highest")]
    highest_at: Annotated[float, Out("at", "s", json="highest_at_s")]
    lowest: Annotated[float, Out("lowest")]
    lowest_at: Annotated[float, Out("at", "s", json="lowest_at_s")]
    last: Annotated[float, Out("at the end")]


@dataclass(frozen=True)
class DissipatedEnergy:
    """Energy in J that an element has turned into heat in a motion."""

    element: Annotated[str, Out("element")]
    energy: Annotated[float, Out("turned into heat", "J", json="energy_J")]


@dataclass(frozen=True)
class EnergyRecord:
    """Energies of a motion in J: supplied, stored, turned into heat by element, and what the sums leave over."""

    supplied: Annotated[float, Out(json="supplied_J")]
    stored: Annotated[float, Out(json="stored_J")]
    left_over: Annotated[float, Out(json="left_over_J")]
    dissipated: tuple[DissipatedEnergy, ...]


@dataclass(frozen=True)
class EventRecord:
    """Event of a motion over time, as ``torsionnet simulate --json`` prints it."""

    time: Annotated[float, Out("time", "s", json="time_s")]
    element: Annotated[str, Out("element")]
    what: Annotated[str, Out("what")]


@dataclass(frozen=True)
class SimulationRecord:
    """Motion under a scenario in one configuration, as ``torsionnet simulate --json`` prints it."""

    configuration: str
    title: str
    scenario: str
    sampling_rate: Annotated[float, Out(json="sampling_rate_Hz")]
    samples: int
    duration: Annotated[float, Out(json="duration_s")]
    peaks: tuple[SignalPeaks, ...]
    events: tuple[EventRecord, ...]
    energy: Annotated[EnergyRecord | None, Out(optional=True)]
    notes: tuple[NoteOrText, ...]


def signal_peaks(recording: Recording) -> tuple[SignalPeaks, ...]:
    """Peaks of every signal of a recording, those of the samples, with their times.

    Examples
    --------
    >>> import numpy as np
    >>> from torsionnet.signals.recording import Recording, Signal
    >>> (one,) = signal_peaks(Recording((Signal("T", "torque", np.array([0.0, 2.0, -1.0])),), 10.0))
    >>> one.highest, one.highest_at, one.lowest, one.lowest_at, one.last
    (2.0, 0.1, -1.0, 0.2, -1.0)
    """
    times = recording.time

    def of_signal(name: str) -> SignalPeaks:
        signal = recording[name]
        high, low = int(signal.values.argmax()), int(signal.values.argmin())
        values = signal.values
        return SignalPeaks(
            name, signal.unit, float(values[high]), float(times[high]), float(values[low]), float(times[low]),
            float(values[-1]),
        )  # fmt: skip

    return tuple(of_signal(name) for name in recording.names)


def peak_table(recording: Recording, title: str, words: str = "") -> Table:
    """Table of the highest and lowest value of every signal of a recording, with their times in s."""
    span = f"{len(recording)} samples at {recording.sampling_rate:g} Hz; peaks are those of the samples"
    notes = [one for one in (words, span, *recording.notes) if one]
    return result_table(title, signal_peaks(recording), SignalPeaks, notes=notes)


def event_table(events: tuple[MotionEvent, ...]) -> Table:
    """Table of the events of a motion in their order, the first of them where there are many."""
    rows = [EventRecord(one.time, one.element, one.what) for one in events[:MOST_EVENTS_SHOWN]]
    more = len(events) - len(rows)
    return result_table("Events", rows, EventRecord, notes=[f"and {more} more"] if more else [])


def energy_table(recording: Recording, title: str = "Energy") -> Table | None:
    """Table of what each element of a simulated motion has turned into heat, in J; None without an energy balance."""
    if recording.energy is None:
        return None
    energy, rows = recording.energy, _heat(recording)
    largest = max(abs(energy.supplied), abs(energy.stored), *(abs(one.energy) for one in rows), 0.0)
    rest = (
        "nothing left over"
        if abs(energy.left_over) <= CLOSED_BALANCE * largest
        else f"{energy.left_over:.3g} J left over"
    )
    notes = [f"supplied {energy.supplied:.6g} J, stored {energy.stored:.6g} J, {rest}"]
    return result_table(title, rows, DissipatedEnergy, notes=notes)


def motion_tables(recording: Recording, title: str, words: str = "") -> Iterator[Table]:
    """Yield the tables of peaks, events and energies of a simulated motion, as far as it has them."""
    yield peak_table(recording, title, words)
    if recording.events:
        yield event_table(recording.events)
    energy = energy_table(recording)
    if energy is not None:
        yield energy


def _heat(recording: Recording) -> tuple[DissipatedEnergy, ...]:
    found = {} if recording.energy is None else recording.energy.dissipated
    return tuple(DissipatedEnergy(name, float(energy)) for name, energy in found.items())


def simulation_record(recording: Recording, scenario: str, configuration: str = "") -> SimulationRecord:
    """Peaks, events and energies of a simulated motion as plain data for JSON, in SI units."""
    energy = recording.energy
    return SimulationRecord(
        configuration, recording.title, scenario, recording.sampling_rate, len(recording), recording.duration,
        signal_peaks(recording), tuple(EventRecord(one.time, one.element, one.what) for one in recording.events),
        None if energy is None else EnergyRecord(energy.supplied, energy.stored, energy.left_over, _heat(recording)),
        recording.notes,
    )  # fmt: skip

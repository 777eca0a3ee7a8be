"""Summary of a simulated motion: peaks of its signals with their times, events, and energies."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.signals.recording import DissipatedEnergy, EnergyBalance, MotionEvent, Recording

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


@dataclass(frozen=True, eq=False)
class SimulatedMotion:
    """Motion under a scenario in one configuration: its recording, with the peaks of every signal."""

    SHOWN: ClassVar = (
        "configuration", "recording.title", "scenario", "recording.sampling_rate", "recording.samples",
        "recording.duration", "peaks", "recording.events", "energy", "recording.notes",
    )  # fmt: skip

    configuration: str
    scenario: str
    recording: Recording

    @property
    def peaks(self) -> tuple[SignalPeaks, ...]:
        """Peaks of every signal, those of the samples, with their times."""
        return signal_peaks(self.recording)

    @property
    def energy(self) -> Annotated[EnergyBalance | None, Out(optional=True)]:
        """Energies in J, None without laws of motion."""
        energy = self.recording.energy
        return None if energy is None else energy.balance


def signal_peaks(recording: Recording) -> tuple[SignalPeaks, ...]:
    """Peaks of every signal of a recording, those of the samples, with their times.

    Examples
    --------
    >>> import numpy as np
    >>> from torsionnet.signals.recording import Recording, Signal
    >>> (peaks,) = signal_peaks(Recording((Signal("T", "torque", np.array([0.0, 2.0, -1.0])),), 10.0))
    >>> peaks.highest, peaks.highest_at, peaks.lowest, peaks.lowest_at, peaks.last
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
    notes = [note for note in (words, span, *recording.notes) if note]
    return result_table(title, signal_peaks(recording), SignalPeaks, notes=notes)


def event_table(events: tuple[MotionEvent, ...]) -> Table:
    """Table of the events of a motion in their order, the first of them where there are many."""
    shown = events[:MOST_EVENTS_SHOWN]
    more = len(events) - len(shown)
    return result_table("Events", shown, MotionEvent, notes=[f"and {more} more"] if more else [])


def energy_table(recording: Recording, title: str = "Energy") -> Table | None:
    """Table of what each element of a simulated motion has turned into heat, in J; None without an energy balance."""
    if recording.energy is None:
        return None
    energy = recording.energy.balance
    largest = max(abs(energy.supplied), abs(energy.stored), *(abs(heat) for heat in energy.dissipated.values()), 0.0)
    rest = (
        "nothing left over"
        if abs(energy.left_over) <= CLOSED_BALANCE * largest
        else f"{energy.left_over:.3g} J left over"
    )
    notes = [f"supplied {energy.supplied:.6g} J, stored {energy.stored:.6g} J, {rest}"]
    return result_table(title, energy.heat, DissipatedEnergy, notes=notes)


def motion_tables(recording: Recording, title: str, words: str = "") -> Iterator[Table]:
    """Yield the tables of peaks, events and energies of a simulated motion, as far as it has them."""
    yield peak_table(recording, title, words)
    if recording.events:
        yield event_table(recording.events)
    energy = energy_table(recording)
    if energy is not None:
        yield energy

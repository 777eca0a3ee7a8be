"""Record of a motion in stretches of one contact state each, its readings at samples, and the summary of its peaks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.linear.assembly.law_stiffness import Functional, Term, powers_of_s
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.dynamic_stiffness.state_space import action_share
from torsionnet.model.channels import Input
from torsionnet.motion.contact_form import ContactForm
from torsionnet.motion.contact_states import Contact, ContactStates
from torsionnet.motion.march_tables import BLOCK, in_steps, rows_along
from torsionnet.motion.motion_plant import Layout, MotionPlant, PlacedLaw
from torsionnet.signals.recording import AnyBalance, DissipatedEnergy, EnergyBalance, MotionEvent, Recording

# Record of a motion: its stretches in one contact state each, and the readings at samples.

# Motion over time of a drivetrain with laws of motion, as solvers return it.


@dataclass(frozen=True, eq=False)
class MotionOverTime:
    """Readings (n_out, n) in SI units at samples, events and energies of a motion."""

    values: FloatArray
    events: tuple[MotionEvent, ...]
    energy: AnyBalance


# Rows over the state of a contact state for what sensors read.


@dataclass(frozen=True, eq=False)
class ReadingPlan:
    """Parts of readings that are the same in every contact state, in floats.

    Attributes
    ----------
    terms : tuple of tuple
        For each reading its terms: factors (3,) of the angle, rate and acceleration of a row (n_q,), or None and the
        place of a law of motion with the factor of its torque.
    direct : (n_out, n_in) array
        Shares of torques from outside.
    actions : (n_out, n_actions) array
        Shares of the torques of controllers.
    """

    terms: tuple[tuple[tuple[FloatArray | None, FloatArray, int], ...], ...]
    direct: FloatArray
    actions: FloatArray


def reading_plan(plant: MotionPlant, readings: Sequence[Functional], inputs: Sequence[Input]) -> ReadingPlan:
    """Plan of readings, which all contact states share.

    Raises
    ------
    UsageError
        The torque of a law on a rigid connection is read.
    """
    places = {law.number: place for place, law in enumerate(plant.laws)}
    direct = [[float(reading.direct(channel.row)) for channel in inputs] for reading in readings]
    actions = [[action_share(plant.assembly, reading, action) for action in plant.actions] for reading in readings]
    return ReadingPlan(
        tuple(tuple(_term(plant, term, places) for term in reading.terms) for reading in readings),
        np.array(direct).reshape(len(readings), len(inputs)),
        np.array(actions).reshape(len(readings), len(plant.actions)),
    )


def _term(plant: MotionPlant, term: Term, places: Mapping[int, int]) -> tuple[FloatArray | None, FloatArray, int]:
    number = -1 if term.law is None else term.law
    if number >= 0 and isinstance(plant.assembly.laws[number], PlacedLaw):
        if number not in places:
            owner = plant.assembly.owners[number]
            raise UsageError(
                f"{owner}: rigid connections hold its twist still, so that its torque is not determined",
                kind="indeterminate-torque",
            )
        return None, np.array([float(term.factor)]), places[number]
    factors = [float(term.factor) * float(value) for value in powers_of_s(plant.assembly, term)]
    return term.row, np.array(factors), -1


def reading_rows(
    plant: MotionPlant,
    readings: Sequence[Functional],
    inputs: Sequence[Input],
    form: ContactForm,
    at: Layout,
    plan: ReadingPlan | None = None,
) -> FloatArray:
    """Rows (n_out, N) of readings in SI units over the state z of a contact state.

    ``plan`` are the parts that are the same in every contact state, if known.

    Raises
    ------
    UsageError
        The torque of a law on a rigid connection is read.
    """
    plan = reading_plan(plant, readings, inputs) if plan is None else plan
    rows_of_readings = np.zeros((len(readings), at.size)) + plan.direct @ form.inputs[: plan.direct.shape[1]]
    rows_of_readings += plan.actions @ form.act
    for number, terms in enumerate(plan.terms):
        for row, factors, place in terms:
            if row is None:
                rows_of_readings[number] += factors[0] * form.torques[place]
                continue
            for factor, part in zip(factors, form.motion, strict=True):
                if factor:
                    rows_of_readings[number] += factor * (row @ part)
    return rows_of_readings


COLUMNS = 256
"""Number of stretches worked on at once, enough for products of matrices at full speed."""
MOST_KEPT = 64
"""Most contact states whose rows are kept, which take some MB each for large drivetrains."""


@dataclass(frozen=True, eq=False)
class Stretches:
    """Stretches of motion in one contact state each.

    Attributes
    ----------
    contacts : list of tuple
        Contact states by number.
    numbers : (n, 3) array
        Contact state, grid point, and whole steps; 0 steps for a part of a step.
    times : (n, 2) array
        Part of the step at the beginning, and part passed.
    starts : (n, n_p) array
        States p at the beginning.
    """

    contacts: list[Contact]
    numbers: NDArray[np.int64]
    times: FloatArray
    starts: FloatArray

    @property
    def nbytes(self) -> int:
        return self.numbers.nbytes + self.times.nbytes + self.starts.nbytes

    def groups(self, keys: NDArray[np.int64], among: NDArray[np.int64]) -> Iterator[Stretches]:
        """Stretches of the numbers ``among`` of one key each, a few hundred at a time."""
        order = among[np.argsort(keys[among], kind="stable")]
        for own in np.split(order, np.flatnonzero(np.diff(keys[order])) + 1):
            for first in range(0, len(own), COLUMNS):
                yield self.chosen(own[first : first + COLUMNS])

    def chosen(self, which: NDArray[np.int64]) -> Stretches:
        """Stretches of some numbers."""
        return Stretches(self.contacts, self.numbers[which], self.times[which], self.starts[which])

    @property
    def is_whole(self) -> NDArray[np.bool_]:
        """Whether stretches are of whole steps, not of parts of steps."""
        return np.asarray(self.numbers[:, 2] > 0)

    @property
    def kinds(self) -> NDArray[np.int64]:
        """Numbers that differ where the contact state does, or whole steps from parts of steps."""
        return 2 * self.numbers[:, 0] + self.is_whole

    def alike(self) -> Iterator[tuple[Contact, bool, Stretches]]:
        """Stretches by contact state, whole steps (True) apart from parts of steps, a few hundred at a time."""
        for few in self.groups(self.kinds, np.arange(len(self.numbers))):
            yield self.contacts[few.numbers[0, 0]], bool(few.is_whole[0]), few

    def along(self, rows: tuple[FloatArray, FloatArray], drive: FloatArray) -> FloatArray:
        """Values (n, n_points, n_rows) at grid points or between along whole steps, see :func:`.rows_along`."""
        ahead, pushed = rows
        driven = drive[self.numbers[:, 1, None] + np.arange(BLOCK + 1)].reshape(len(self.starts), -1)
        values = self.starts @ ahead.reshape(-1, ahead.shape[2]).T + driven @ pushed.reshape(-1, pushed.shape[2]).T
        return np.asarray(values.reshape(-1, *ahead.shape[:2]))

    def whole_states(self, drive: FloatArray) -> FloatArray:
        """States z (N, n) at the beginning."""
        i, f = self.numbers[:, 1], self.times[:, 0]
        before, after = drive[i], drive[i + 1]
        return np.vstack([self.starts.T, (before + f[:, None] * (after - before)).T, (after - before).T])


class MotionReadings:
    """Record of readings (n_out, n) at samples, filled with stretches of motion.

    ``refinement`` is the number of steps between samples, ``drive`` (n_points, n_u) the torques at the grid points.
    """

    def __init__(
        self, states: ContactStates, readings: Sequence[Functional], inputs: Sequence[Input], n: int, refinement: int,
        drive: FloatArray,
    ) -> None:  # fmt: skip
        self.states, self.readings, self.inputs = states, readings, inputs
        self.refinement, self.drive = refinement, drive
        self.plan = reading_plan(states.plant, readings, inputs)
        self.by_sample = np.zeros((n, len(readings)))
        self._rows: dict[Contact, tuple[FloatArray, tuple[FloatArray, FloatArray]]] = {}

    @property
    def values(self) -> FloatArray:
        """Readings (n_out, n) at samples."""
        return self.by_sample.T

    def add(self, stretches: Stretches) -> None:
        """Read stretches of motion at the samples from their beginnings on, without their ends."""
        n, k = stretches.numbers, self.refinement
        first = -n[:, 1] % k  # steps to the first sample
        inside = np.where(stretches.is_whole, first < n[:, 2], (first == 0) & (stretches.times[:, 0] == 0))
        for few in stretches.groups(k * stretches.kinds + first, np.flatnonzero(inside)):
            at_once, (ahead, pushed) = self._rows_of(few.contacts[few.numbers[0, 0]])
            begin = int(-few.numbers[0, 1] % k)
            samples = (few.numbers[:, 1] + begin) // k
            if few.is_whole[0]:
                read = few.along((ahead[begin::k], pushed[begin::k]), self.drive)
                reached = np.arange(begin, BLOCK, k) < few.numbers[:, 2, None]
                which, further = np.nonzero(reached)
                self.by_sample[samples[which] + further] = read[reached]
            else:
                self.by_sample[samples] = (at_once @ few.whole_states(self.drive)).T

    def add_last(self, contact: Contact, z: FloatArray) -> None:
        """Read the state z at the last sample."""
        self.by_sample[-1] = self._rows_of(contact)[0] @ z

    def _rows_of(self, contact: Contact) -> tuple[FloatArray, tuple[FloatArray, FloatArray]]:
        if contact not in self._rows:
            if len(self._rows) >= MOST_KEPT:
                self._rows.clear()
            states, at = self.states, self.states.at
            form = states.form(contact)
            rows = reading_rows(states.plant, self.readings, self.inputs, form, at, self.plan) * in_steps(at, states.h)
            self._rows[contact] = rows, rows_along(rows, states.steps(contact), at)
        return self._rows[contact]


# Summary of a simulated motion: peaks of its signals with their times, events, and energies.

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

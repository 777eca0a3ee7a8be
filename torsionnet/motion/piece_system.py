"""Motion over time of a drivetrain whose laws of motion have straight pieces, exact between events.

In each contact state the motion is that of a linear system, which exponentials advance exactly for torques that run
straight between samples. Where a law enters another piece, where a contact lifts off, where friction begins to stick
or to slip, the motion is continued in the next contact state; such events are located to rounding.

Motion over time of a drivetrain with laws of straight pieces under torques of lines and waves, exact between events.
Between the breaks of the torques waves are generators w' = F w among the states, so that exponentials advance them with
the motion. Breaks that no sample hits are reached by steps of their own length.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.linear.assembly.law_stiffness import Functional
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.model.channels import Input
from torsionnet.motion import marching
from torsionnet.motion.contact_states import Contact, ContactStates, FinerStepError, relative_state
from torsionnet.motion.driving import Driving, Stretch
from torsionnet.motion.march_tables import BLOCK, MOST_TURN, in_steps, push_offsets
from torsionnet.motion.marching import with_torques
from torsionnet.motion.motion_plant import Drive, LawPhases, Layout
from torsionnet.motion.motion_record import MotionOverTime, MotionReadings, Stretches
from torsionnet.motion.motion_works import Works, remembered_energies, stored_energy
from torsionnet.motion.scenarios.time_history import SAMPLE_SLACK
from torsionnet.motion.smooth_laws import SplitPlant
from torsionnet.signals.recording import AnyBalance, DeferredBalance, EnergyBalance, MotionEvent

STORM_WINDOW, MOST_EVENTS = 64, 2_000
"""Steps of a window of time and most events in it. The fastest vibration makes ten turns in the window; a contact that
it closes and opens needs 20 events, and ten laws with three pieces on each side 1200. More events only come
from contacts that close and open within ever shorter times."""
STEPS_WORTH_COMPILING = 100_000
"""Number of steps from which the march is compiled where numba is installed: loading the compiled loop takes half a
second, as 50 000 steps in numpy. Shorter motions change over where a list gets full of events before half their time,
which takes a second. Only sizes decide, so that a result does not depend on what was simulated before."""
MOST_BYTES_KEPT = 50_000_000
"""Most memory in bytes of stretches of motion whose works wait until somebody asks for them."""
LISTED = 8192
"""Number of stretches and events of a motion listed before they are read."""


class PieceMotion:
    """Motion under way: contact state, grid point, part of the step, state p and the lists of the march.

    ``drive`` (last + BLOCK + 2, n_u) are torques and scales at the grid points, k of them to a sample, from the time
    ``begins`` in s on. ``end`` is the state z in SI units at the end, ``contact`` the contact state there, and
    ``energies`` are those stored in J at the beginning and at the end.
    """

    end: FloatArray
    contact: Contact
    energies: tuple[float, float]

    def __init__(self, states: ContactStates, drive: FloatArray, k: int, last: int, begins: float = 0.0) -> None:
        self.states, self.k, self.last, self.begins = states, k, last, begins
        self.drive = drive
        self.events: list[MotionEvent] = []
        self.kept: list[Stretches] = []
        self.works = Works(states, self.drive)

    def whole(self, z0: FloatArray, record: MotionReadings, contact: Contact | None = None) -> MotionOverTime:
        """Motion from a state z0 in SI units to the last sample; ``contact`` goes on from the end of another."""
        states, at = self.states, self.states.at
        numbers, times = np.zeros((LISTED, 3), dtype=np.int64), np.zeros((LISTED, 2))
        starts, event_times = np.zeros((LISTED, at.n_p)), np.zeros(LISTED)
        event_numbers = np.zeros((LISTED, 4), dtype=np.int64)
        storm = np.array([STORM_WINDOW, 0, MOST_EVENTS, 0], dtype=np.int64)
        offsets = push_offsets(at.n_p, at.n_u)
        flat = self.drive.ravel()
        units = in_steps(at, states.h)
        first = contact or self._at_start(z0)
        # Angles count from what turns with the whole, time in steps.
        z0 = relative_state(states.plant, at, z0) / units
        z0[at.u] = flat[: at.n_u]
        contact = states.fixed(first, z0)
        z0[at.slope] = flat[at.n_u : 2 * at.n_u] - flat[: at.n_u]
        p = self._refreshed(contact, z0)[: at.n_p].copy()
        energy = stored_energy(states, contact, self._z(p, 0, 0.0))
        begun = remembered_energies(states, contact, self._z(p, 0, 0.0) * units)
        self.kept.append(_standing(contact, 0, p))
        march = _compiled_march() if self.last >= STEPS_WORTH_COMPILING else marching.march
        state = np.array([states.number(contact), 0, self.last, 0, 0], dtype=np.int64)
        f = 0.0
        while True:
            reason, f, guard = march(
                state, f, p, flat, at.n_u, states.n_sub, at.n_q, tuple(states.tables[:-1]), states.tables[-1],
                states.following, offsets, (numbers, times, starts), event_numbers, event_times, storm,
            )  # fmt: skip
            if reason == marching.STORM:
                self._refuse_storm(event_numbers[: state[4]], int(state[1]), f)
            if reason == marching.ASK:
                # The next contact state is not known yet: it follows from the state at the event.
                z = self._refreshed(states.contacts[state[0]], self._z(p, int(state[1]), f))
                time = self.begins + (int(state[1]) + f) * states.h
                contact, always = states.state_after(states.contacts[state[0]], guard, z, time)
                known = states.number(contact)
                if always:
                    states.following[state[0], guard] = known
                event_numbers[state[4] - 1, 3] = known
                state[0] = known
                p[:] = self._refreshed(contact, z)[: at.n_p]
            if reason != marching.ASK or state[3] > LISTED // 2 or state[4] > LISTED // 2:
                self._note(record, numbers[: state[3]], times[: state[3]], starts[: state[3]])
                self._tell(event_numbers[: state[4]], event_times)
                state[3] = state[4] = 0
                # A full list before half the time means many events, for which compiling pays.
                if reason != marching.DONE and 2 * state[1] < self.last:
                    march = _compiled_march()
                if states.is_large:
                    contact = states.contacts[state[0]]
                    states.clear()
                    state[0] = states.number(contact)
            if reason == marching.DONE:
                break
        contact, z = states.contacts[state[0]], self._z(p, self.last, 0.0)
        record.add_last(contact, z)
        self.end, self.contact = self._in_angles(contact, z), contact
        self.kept.append(_standing(contact, self.last, p))
        self.energies = energy, stored_energy(states, contact, z)
        stored = self.energies[1] - energy
        kept = remembered_energies(states, contact, z * units)
        gained = {owner: value - begun[owner] for owner, value in kept.items()}
        return MotionOverTime(record.values, tuple(self.events), DeferredBalance(lambda: self._balance(stored, gained)))

    def _note(self, record: MotionReadings, numbers: NDArray[np.int64], times: FloatArray, starts: FloatArray) -> None:
        """Read stretches at the samples, and keep them for the works, or work these out at once if there are many."""
        stretches = Stretches(self.states.contacts, numbers.copy(), times.copy(), starts.copy())
        record.add(stretches)
        self.kept.append(stretches)
        if sum(part.nbytes for part in self.kept) > MOST_BYTES_KEPT:
            self._work_out()

    def _work_out(self) -> None:
        for stretches in self.kept:
            self.works.add(stretches)
        self.kept.clear()

    def _balance(self, stored: float, gained: Mapping[str, float]) -> EnergyBalance:
        self._work_out()
        works = dict(self.works.by_element)
        for owner, value in gained.items():
            works[owner] = works.get(owner, 0.0) - value
        return EnergyBalance(works.pop("", 0.0), stored, works)

    def _in_angles(self, contact: Contact, z: FloatArray) -> FloatArray:
        """State z in SI units with the angles and speeds of all coordinates."""
        at = self.states.at
        angles = z * in_steps(at, self.states.h)
        position, speed, _ = self.states.form(contact).motion
        angles[at.q], angles[at.v] = position @ angles, speed @ angles
        return angles

    def _z(self, p: FloatArray, i: int, f: float) -> FloatArray:
        return np.asarray(with_torques(p, i, f, self.states.at.n_u, self.drive.ravel()))

    def _refreshed(self, contact: Contact, z: FloatArray) -> FloatArray:
        units = in_steps(self.states.at, self.states.h)
        return np.asarray(self.states.form(contact).refresh @ (z * units) / units)

    def _at_start(self, z: FloatArray) -> Contact:
        states, at = self.states, self.states.at
        rows = np.array([law.row for law in states.plant.laws]).reshape(-1, at.n_q)
        scales = np.array([1.0 if place < 0 else self.drive[0, place] for place in states.drive.scale_of])
        return states.at_start(rows @ z[at.q], rows @ z[at.v], scales)

    def _tell(self, numbers: NDArray[np.int64], times: FloatArray) -> None:
        contacts, h = self.states.contacts, self.states.h
        known: dict[tuple[int, int], tuple[tuple[str, str], ...]] = {}
        for (before, _, i, after), f in zip(numbers.tolist(), times.tolist(), strict=False):
            if (before, after) not in known:
                known[before, after] = self.states.changes(contacts[before], contacts[after])
            self.events += [MotionEvent(self.begins + (i + f) * h, *change) for change in known[before, after]]

    def _refuse_storm(self, numbers: NDArray[np.int64], i: int, f: float) -> None:
        states = self.states
        owners = [states.laws[guard // 3].owner for guard in numbers[-MOST_EVENTS:, 1].tolist()]
        most = max(dict.fromkeys(owners), key=owners.count)
        rate = owners.count(most) / (STORM_WINDOW * states.h)
        time = self.begins + (i + f) * states.h
        text = f"{most}: at {time:.6g} s its torque changes its piece more than {rate:.3g} times a second"
        raise SolveError(
            f"{text}, without an end to be seen; give the contact or the friction a stiffness or a damping",
            kind="no-solution",
        )


def _standing(contact: Contact, i: int, p: FloatArray) -> Stretches:
    """Stretch without length at a grid point, which says in which contact state a motion begins or ends there."""
    return Stretches([contact], np.array([[0, i, 0]], dtype=np.int64), np.zeros((1, 2)), p[None].copy())


def _compiled_march() -> Callable[..., tuple[int, float, int]]:
    """March in a compiled loop where numba is installed and works, else that in numpy, which can do the same."""
    with contextlib.suppress(Exception):
        from torsionnet.motion.compiled_march import march

        return march
    return marching.march


# Length of the steps of a motion with laws of straight pieces, from the rates of its contact states.

LONGEST_TURN = 1.0
"""Angle in rad that the fastest vibration may turn in a step: between two looks at the guards it then makes one turning
point at most."""
MOST_SUBSTEPS = 64
"""Most points of the finer grid in a step, which bounds the memory of the tables: poles quicker than all vibrations, as
of strong dampers, shorten the step beyond that."""
MOST_STEPS = 100_000_000
"""Most steps of a motion, some minutes of work."""


def first_rates(states: ContactStates, laws: Sequence[LawPhases]) -> tuple[float, float]:
    """Largest frequency and pole in rad/s with all laws at their stiffest and most damped pieces."""
    contact: list[int] = []
    for law in laws:
        # The stiffest and most damped piece of every law.
        slopes = [number for number, phase in enumerate(law.phases) if phase.kind == "slope"]
        contact.append(max(slopes, key=lambda number: (law.phases[number].stiffness, law.phases[number].damping)))
    try:
        return states.form(tuple(contact)).largest_rates
    except UsageError:  # massless parts that only other contact states fix
        return 0.0, 0.0


def steps_of(rates: tuple[float, float], step: float, n: int, refinement: int = 1) -> tuple[int, int]:
    """Number of steps in a sampling interval of ``step`` seconds, and points of the finer grid in a step.

    ``rates`` are the fastest vibration and the largest pole in rad/s, ``n`` is the number of samples.

    Raises
    ------
    UsageError
        The motion needs too many steps.
    """
    turning, largest = rates
    most = MOST_SUBSTEPS * MOST_TURN
    # Steps short enough for the fastest vibration, and for what the finer grid can follow of poles.
    k = refinement * max(1, math.ceil(step * turning / LONGEST_TURN), math.ceil(step * largest / most))
    if k * n > MOST_STEPS:
        text = f"the fastest motion, {largest:.3g} rad/s, needs {k * n:.2g} steps over {n * step:.3g} s"
        raise UsageError(f"{text}; simulate a shorter time, or leave out what is so stiff", kind="too-large")
    n_sub = 4
    while n_sub * MOST_TURN < largest * step / k and n_sub < MOST_SUBSTEPS:
        n_sub *= 2
    return k, n_sub


# Motion over time of a drivetrain with laws of straight pieces under torques of lines and waves, exact between
# events.


@dataclass(frozen=True, eq=False)
class Generators:
    """Generators w' = F w of the waves in all entries of u, which S adds to them.

    Those of an exponent s = a + jb are the real and imaginary parts of A exp(s (t - t_0)).
    """

    kinds: tuple[tuple[int, complex], ...]
    F: FloatArray
    S: FloatArray

    def at(self, stretch: Stretch, time: float) -> FloatArray:
        """States (n_w,) of the generators at a time of a stretch; waves of others stand still at zero."""
        states = np.zeros(2 * len(self.kinds))
        for source in stretch.waves:
            place = 2 * self.kinds.index((source.entry, source.exponent))
            wave = source.amplitude * np.exp(source.exponent * (time - stretch.start))
            states[place : place + 2] += wave.real, wave.imag
        return states


def generators_of(stretches: Sequence[Stretch], n_u: int) -> Generators:
    """Generators of all waves of stretches, with ``n_u`` entries of u."""
    kinds = tuple(dict.fromkeys((wave.entry, wave.exponent) for stretch in stretches for wave in stretch.waves))
    F, S = np.zeros((2 * len(kinds), 2 * len(kinds))), np.zeros((n_u, 2 * len(kinds)))
    for number, (entry, exponent) in enumerate(kinds):
        own = slice(2 * number, 2 * number + 2)
        # d/dt of (Re, Im) A exp((a + jb) t) = [[a, -b], [b, a]] (Re, Im)
        F[own, own] = [[exponent.real, -exponent.imag], [exponent.imag, exponent.real]]
        S[entry, 2 * number] = 1.0
    return Generators(kinds, F, S)


@dataclass(frozen=True)
class _Run:
    """Steps of one length from ``start`` in s: ``n`` intervals of k steps, the first point being sample ``sample``.

    Without samples ``sample`` is -1; with ``alone`` only the first point is one.
    """

    start: float
    interval: float
    n: int
    sample: int
    alone: bool = False


def simulate_pieces(
    split: SplitPlant,
    readings: Sequence[Functional],
    inputs: Sequence[Input],
    driving: Driving,
    z0: FloatArray,
    contact: Contact | None = None,
    refinement: int = 1,
) -> MotionOverTime:
    """Motion of a plant with laws of straight pieces from a state z0 = (q, q', controllers, ...) in SI units.

    The parameters are those of :func:`.smooth_system.simulate_smooth`; with ``refinement`` steps are so many times
    shorter.

    Raises
    ------
    UsageError
        Parts that stick in a loop, massless nodes whose motion nothing fixes, or too many steps.
    SolveError
        Too many events, or a row that leaves its curve.
    """
    plant = split.plant
    columns = np.array([plant.assembly.rows_of(channel.row)[0] for channel in inputs]).reshape(len(inputs), -1).T
    n_in, n_scales = columns.shape[1], len(split.scales)
    cuts = [0.0, *driving.breaks, driving.duration]
    stretches = [driving.straight(start, end) for start, end in pairwise(cuts)]
    made = generators_of(stretches, n_in + n_scales)
    scale_of = tuple(-1 if scale < 0 else n_in + scale for scale in split.scale_of)
    drive = Drive(columns, scale_of, n_scales, made.F, made.S)
    at = Layout(len(columns), sum(len(action.F) for action in plant.actions), len(made.F), drive.n_u)
    z = np.zeros(at.size)
    own = slice(0, 2 * at.n_q + at.n_c)
    z[own], z[at.constant] = z0[own], 1.0
    states = ContactStates(plant, split.phases, drive, at, relative=True)
    rates = first_rates(states, split.phases)
    march = _DrivenMarch(states, readings, inputs, driving, stretches, made)
    # A contact state quicker than the steps: the motion begins again with shorter ones.
    while True:
        try:
            return march.whole(z, contact, rates, refinement)
        except FinerStepError as finer:
            rates = (max(rates[0], finer.rates[0]), max(rates[1], finer.rates[1]))


@dataclass(frozen=True, eq=False)
class _DrivenMarch:
    states: ContactStates
    readings: Sequence[Functional]
    inputs: Sequence[Input]
    driving: Driving
    stretches: Sequence[Stretch]
    generators: Generators

    def whole(
        self, z: FloatArray, contact: Contact | None, rates: tuple[float, float], refinement: int
    ) -> MotionOverTime:
        """Motion from a state z to the last sample."""
        driving, at = self.driving, self.states.at
        values = np.zeros((len(self.readings), driving.n))
        k, n_sub = steps_of(rates, 1 / driving.rate, driving.n, refinement)
        length = jumped = 0.0
        energy: float | None = None
        parts: list[MotionOverTime] = []
        for stretch in self.stretches or [driving.straight(0.0, 0.0)]:
            for run in self._runs(stretch):
                steps = max(1, math.ceil(run.interval * driving.rate * k - SAMPLE_SLACK))
                h = run.interval / steps
                if h != length:
                    for part in parts:
                        part.energy.left_over  # noqa: B018  works are those of the steps before
                    self.states.with_steps(h, n_sub)
                    length = h
                drive = self._straight_torques(stretch, run, steps)
                motion = PieceMotion(self.states, drive, steps, run.n * steps, run.start)
                record = MotionReadings(self.states, self.readings, self.inputs, run.n + 1, steps, drive)
                z[at.w] = self.generators.at(stretch, run.start)
                parts.append(motion.whole(z, record, contact))
                z, contact = motion.end, motion.contact
                if energy is not None:  # a torque that jumps moves at once what has no inertia
                    jumped += motion.energies[0] - energy
                energy = motion.energies[1]
                if run.sample >= 0:
                    last = 1 if run.alone else run.n + 1
                    values[:, run.sample : run.sample + last] = parts[-1].values[:, :last]
                elif run.n:
                    number = round((run.start + run.interval) * driving.rate)
                    if abs((run.start + run.interval) * driving.rate - number) < SAMPLE_SLACK:
                        values[:, number] = parts[-1].values[:, -1]
        events = tuple(event for part in parts for event in part.events)
        balances = [*(part.energy for part in parts), EnergyBalance(jumped, jumped)]
        return MotionOverTime(values, events, DeferredBalance(lambda: added_up(balances)))

    def _runs(self, stretch: Stretch) -> Iterator[_Run]:
        """Runs of a stretch: to the first sample in it, from there to the last one, and on to its end."""
        rate = self.driving.rate
        first, last = math.ceil(stretch.start * rate - SAMPLE_SLACK), math.floor(stretch.end * rate + SAMPLE_SLACK)
        if last < first:
            yield _Run(stretch.start, stretch.end - stretch.start, 1, -1)
            return
        if first - stretch.start * rate > SAMPLE_SLACK:
            yield _Run(stretch.start, first / rate - stretch.start, 1, -1)
        if last > first or stretch.end == stretch.start:
            yield _Run(first / rate, 1 / rate, last - first, first)
        if stretch.end * rate - last > SAMPLE_SLACK:
            yield _Run(last / rate, stretch.end - last / rate, 1, last, alone=True)

    def _straight_torques(self, stretch: Stretch, run: _Run, steps: int) -> FloatArray:
        """Straight parts of u (n_points, n_u) at the grid points of a run, and beyond it as far as a block reaches."""
        numbers = np.arange(run.n * steps + BLOCK + 2)
        passed = numbers * (run.interval / steps)
        lines = stretch.values[:, None] + stretch.slopes[:, None] * (run.start - stretch.start + passed)
        end = run.start + run.n * run.interval
        times = np.minimum(run.start + passed, end)
        if run.sample >= 0 and not run.alone:  # exact at samples
            times = (run.sample + np.minimum(numbers / steps, run.n)) / self.driving.rate
        return np.ascontiguousarray((lines + self.driving.sampled(times)).T)


def added_up(balances: Sequence[AnyBalance]) -> EnergyBalance:
    """Energy balance of motions that follow each other."""
    lost: dict[str, float] = {}
    for balance in balances:
        for owner, value in balance.dissipated.items():
            lost[owner] = lost.get(owner, 0.0) + value
    return EnergyBalance(sum(part.supplied for part in balances), sum(part.stored for part in balances), lost)

"""Motion over time of a drivetrain whose laws of motion have straight pieces, exact between events.

In each contact state the motion is that of a linear system, which exponentials advance exactly for torques that run
straight between samples. Where a law enters another piece, where a contact lifts off, where friction begins to stick
or to slip, the motion is continued in the next contact state; such events are located to rounding.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.motion import marching
from torsionnet.motion.contact_states import Contact, ContactStates
from torsionnet.motion.march_tables import in_steps
from torsionnet.motion.motion_energy import stored_energy
from torsionnet.motion.motion_over_time import MotionOverTime
from torsionnet.motion.motion_record import MotionRecord, Stretches
from torsionnet.motion.motion_steps import with_torques
from torsionnet.motion.motion_works import Works
from torsionnet.motion.start_state import relative_state
from torsionnet.motion.step_matrices import push_offsets
from torsionnet.signals.energy_balance import DeferredBalance, EnergyBalance
from torsionnet.signals.motion_event import MotionEvent

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

    def whole(self, z0: FloatArray, record: MotionRecord, contact: Contact | None = None) -> MotionOverTime:
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
        z0 = relative_state(states.plant, at, z0) / units
        z0[at.u] = flat[: at.n_u]
        contact = states.fixed(first, z0)
        z0[at.slope] = flat[at.n_u : 2 * at.n_u] - flat[: at.n_u]
        p = self._refreshed(contact, z0)[: at.n_p].copy()
        energy = stored_energy(states, contact, self._z(p, 0, 0.0))
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
                z = self._refreshed(states.contacts[state[0]], self._z(p, int(state[1]), f))
                time = self.begins + (int(state[1]) + f) * states.h
                contact, always = states.after(states.contacts[state[0]], guard, z, time)
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
        return MotionOverTime(record.values, tuple(self.events), DeferredBalance(lambda: self._balance(stored)))

    def _note(self, record: MotionRecord, numbers: NDArray[np.int64], times: FloatArray, starts: FloatArray) -> None:
        """Read stretches at the samples, and keep them for the works, or work these out at once if there are many."""
        stretches = Stretches(self.states.contacts, numbers.copy(), times.copy(), starts.copy())
        record.add(stretches)
        self.kept.append(stretches)
        if sum(one.nbytes for one in self.kept) > MOST_BYTES_KEPT:
            self._work_out()

    def _work_out(self) -> None:
        for one in self.kept:
            self.works.add(one)
        self.kept.clear()

    def _balance(self, stored: float) -> EnergyBalance:
        self._work_out()
        works = dict(self.works.found)
        return EnergyBalance(works.pop("", 0.0), stored, works)

    def _in_angles(self, contact: Contact, z: FloatArray) -> FloatArray:
        """State z in SI units with the angles and speeds of all coordinates."""
        at = self.states.at
        found = z * in_steps(at, self.states.h)
        position, speed, _ = self.states.form(contact).motion
        found[at.q], found[at.v] = position @ found, speed @ found
        return found

    def _z(self, p: FloatArray, i: int, f: float) -> FloatArray:
        return np.asarray(with_torques(p, i, f, self.states.at.n_u, self.drive.ravel()))

    def _refreshed(self, contact: Contact, z: FloatArray) -> FloatArray:
        units = in_steps(self.states.at, self.states.h)
        return np.asarray(self.states.form(contact).refresh @ (z * units) / units)

    def _at_start(self, z: FloatArray) -> Contact:
        states, at = self.states, self.states.at
        rows = np.array([one.row for one in states.plant.laws]).reshape(-1, at.n_q)
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
            f"{text}, without an end to be seen; give the contact or the friction a stiffness or a damping"
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

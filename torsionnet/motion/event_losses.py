"""Energy that laws of motion turn into heat at once where they change their piece."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.motion.contact_states import Contact, ContactStates
from torsionnet.motion.guard_polynomials import DEGREE
from torsionnet.motion.march_tables import in_steps
from torsionnet.motion.motion_energy import energy_rows
from torsionnet.motion.motion_record import Stretches
from torsionnet.motion.phases import LawPhases


def losing_law(laws: Sequence[LawPhases], before: Sequence[int], after: Sequence[int]) -> str:
    """Element that may turn energy into heat at the change from one contact state to another; empty if none does.

    A preload that catches a row takes the energy of its motion. Friction that begins to slip at less than it stuck with
    lets what has no inertia beyond it, as the spring of a friction with stiffness, go back at once.
    """
    for law, one, other in zip(laws, before, after, strict=True):
        if one == other:
            continue
        catches = law.phases[other].kind == "hold" and not law.over_rate
        lets_go = law.over_rate and law.phases[other].kind != "hold"
        if catches or lets_go:
            return law.owner
    return ""


def holding_law(laws: Sequence[LawPhases], contact: Sequence[int]) -> str:
    """Element whose law holds a row in a contact state, and may have let it go and caught it again at one time."""
    return next((law.owner for law, one in zip(laws, contact, strict=True) if law.phases[one].kind == "hold"), "")


class EventLosses:
    """Energies in J lost at the events between stretches of motion that follow each other."""

    def __init__(self, states: ContactStates, drive: FloatArray) -> None:
        self.states, self.drive = states, drive
        self._last: Stretches | None = None
        self._owners: dict[tuple[Contact, Contact], str] = {}

    def between(self, stretches: Stretches) -> Iterator[tuple[str, float]]:
        """Yield element and energy of each loss up to the last of some stretches, in the order of time."""
        if not len(stretches.numbers):
            return
        if self._last is not None:
            yield from self._lost(self._last, stretches.chosen(np.array([0])))
        numbers, begun = stretches.numbers[:, 0], stretches.times[:, 0]
        changes = np.flatnonzero((numbers[1:] != numbers[:-1]) | (begun[1:] > 0))  # events, also back to the same state
        yield from self._lost(stretches.chosen(changes), stretches.chosen(changes + 1))
        self._last = stretches.chosen(np.array([len(numbers) - 1]))

    def _lost(self, before: Stretches, after: Stretches) -> Iterator[tuple[str, float]]:
        pairs = zip(before.numbers[:, 0].tolist(), after.numbers[:, 0].tolist(), strict=True)
        owners = [self._owner(before.contacts[one], after.contacts[other]) for one, other in pairs]
        which = np.array([number for number, owner in enumerate(owners) if owner], dtype=np.int64)
        if len(which):
            lost = self._energies(before.chosen(which), at_end=True) - self._energies(after.chosen(which))
            yield from zip([owner for owner in owners if owner], lost.tolist(), strict=True)

    def _owner(self, before: Contact, after: Contact) -> str:
        if (before, after) not in self._owners:
            laws = self.states.laws
            self._owners[before, after] = (
                holding_law(laws, after) if before == after else losing_law(laws, before, after)
            )
        return self._owners[before, after]

    def _energies(self, stretches: Stretches, *, at_end: bool = False) -> FloatArray:
        """Stored energies (n,) in J at the beginnings of stretches, or at their ends."""
        found = np.zeros(len(stretches.numbers))
        for number in np.unique(stretches.numbers[:, 0]).tolist():
            own = np.flatnonzero(stretches.numbers[:, 0] == number)
            few, contact = stretches.chosen(own), stretches.contacts[number]
            Z = self._ends(contact, few) if at_end else few.whole_states(self.drive)
            found[own] = energy_rows(self.states, contact).at(Z)
        return found

    def _ends(self, contact: Contact, few: Stretches) -> FloatArray:
        """States z (N, n) at the ends of stretches in one contact state."""
        at, n_sub = self.states.at, self.states.n_sub
        units = in_steps(at, self.states.h)
        A = self.states.h * self.states.form(contact).A * units / units[:, None]
        Z = few.whole_states(self.drive)
        steps = few.numbers[:, 2]
        for step in range(int(steps.max())):
            moving = steps > step
            Z[:, moving] = scipy.linalg.expm(A) @ Z[:, moving]
            self._drive_at(Z, few.numbers[:, 1] + step + 1, moving)
        parts = np.where(steps > 0, 0.0, few.times[:, 1])
        whole = np.minimum((parts * n_sub).astype(np.int64), n_sub)
        finest = scipy.linalg.expm(A / n_sub) if whole.any() else A
        for part in range(int(whole.max())):
            Z[:, whole > part] = finest @ Z[:, whole > part]
        rest = np.maximum(parts - whole / n_sub, 0.0)
        term = Z
        for k in range(1, DEGREE + 1):
            term = (A @ term) * (rest / k)
            Z = Z + term
        return np.asarray(Z)

    def _drive_at(self, Z: FloatArray, places: NDArray[np.int64], moving: NDArray[np.bool_]) -> None:
        """Write the torques at grid points, and how they change after them, into states z (N, n) that move."""
        here, following = self.drive[places[moving]], self.drive[places[moving] + 1]
        at = self.states.at
        Z[at.u, moving] = here.T
        Z[at.slope, moving] = (following - here).T

"""Record of a motion: its stretches in one contact state each, and the readings at samples."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.functionals import Functional
from torsionnet.assembly.rows import FloatArray
from torsionnet.model.channels import Input
from torsionnet.solve.motion.contact_states import Contact, ContactStates
from torsionnet.solve.motion.march_tables import in_steps
from torsionnet.solve.motion.read_rows import reading_plan, reading_rows
from torsionnet.solve.motion.step_matrices import BLOCK, rows_along

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

    def chosen(self, which: NDArray[Any]) -> Stretches:
        """Stretches of a mask or of numbers."""
        return Stretches(self.contacts, self.numbers[which], self.times[which], self.starts[which])

    def alike(self) -> Iterator[tuple[Contact, bool, Stretches]]:
        """Stretches by contact state, whole steps (True) apart from parts of steps, a few hundred at a time."""
        kinds = 2 * self.numbers[:, 0] + (self.numbers[:, 2] > 0)
        order = np.argsort(kinds, kind="stable")
        for own in np.split(order, np.flatnonzero(np.diff(kinds[order])) + 1):
            for first in range(0, len(own), COLUMNS):
                few = self.chosen(own[first : first + COLUMNS])
                yield self.contacts[few.numbers[0, 0]], bool(few.numbers[0, 2] > 0), few

    def along(self, rows: tuple[FloatArray, FloatArray], drive: FloatArray) -> FloatArray:
        """Values (BLOCK, n_rows, n) of rows at and between grid points along whole steps, see :func:`.rows_along`."""
        ahead, pushed = rows
        places = self.numbers[:, 1, None] + np.arange(BLOCK + 1)
        driven = drive[places].reshape(len(places), -1).T
        found = ahead.reshape(-1, ahead.shape[2]) @ self.starts.T + pushed.reshape(-1, pushed.shape[2]) @ driven
        return np.asarray(found.reshape(*ahead.shape[:2], len(places)))

    def whole_states(self, drive: FloatArray) -> FloatArray:
        """States z (N, n) at the beginning."""
        i, f = self.numbers[:, 1], self.times[:, 0]
        before, after = drive[i], drive[i + 1]
        return np.vstack([self.starts.T, (before + f[:, None] * (after - before)).T, (after - before).T])


class MotionRecord:
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
        self.values = np.zeros((len(readings), n))
        self._rows: dict[Contact, tuple[FloatArray, tuple[FloatArray, FloatArray]]] = {}

    def add(self, stretches: Stretches) -> None:
        """Read stretches of motion at the samples from their beginnings on, without their ends."""
        n, k = stretches.numbers, self.refinement
        to_sample = -n[:, 1] % k  # steps to the next sample
        whole = n[:, 2] > 0
        holds_one = np.where(whole, to_sample < n[:, 2], (to_sample == 0) & (stretches.times[:, 0] == 0))
        for contact, steps, few in stretches.chosen(holds_one).alike():
            at_once, (ahead, pushed) = self._rows_of(contact)
            i = few.numbers[:, 1]
            if not steps:
                self.values[:, i // k] = at_once @ few.whole_states(self.drive)
                continue
            first = -i % k
            for offset in np.unique(first).tolist():
                own = few.chosen(first == offset)
                read = own.along((ahead[offset::k], pushed[offset::k]), self.drive)
                inside = np.arange(offset, BLOCK, k)[:, None] < own.numbers[:, 2]
                which, column = np.nonzero(inside)
                places = (own.numbers[:, 1] + offset) // k
                self.values[:, places[column] + which] = read.transpose(1, 0, 2)[:, inside]

    def add_last(self, contact: Contact, z: FloatArray) -> None:
        """Read the state z at the last sample."""
        self.values[:, -1] = self._rows_of(contact)[0] @ z

    def _rows_of(self, contact: Contact) -> tuple[FloatArray, tuple[FloatArray, FloatArray]]:
        if contact not in self._rows:
            if len(self._rows) >= MOST_KEPT:
                self._rows.clear()
            states, at = self.states, self.states.at
            form = states.form(contact)
            rows = reading_rows(states.plant, self.readings, self.inputs, form, at, self.plan) * in_steps(at, states.h)
            self._rows[contact] = rows, rows_along(rows, states.steps(contact), at)
        return self._rows[contact]

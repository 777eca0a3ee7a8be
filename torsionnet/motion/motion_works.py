"""Works of dampers, laws of motion and torques from outside along a motion, by Gauss quadrature of its exact course."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.motion.contact_form import ContactForm
from torsionnet.motion.contact_states import Contact, ContactStates
from torsionnet.motion.event_losses import EventLosses
from torsionnet.motion.guard_polynomials import DEGREE
from torsionnet.motion.march_tables import in_steps
from torsionnet.motion.motion_plant import PlacedLaw
from torsionnet.motion.motion_record import MOST_KEPT, Stretches
from torsionnet.motion.step_matrices import StepMatrices, step_matrices

WORK_TOLERANCE = 1e-10
"""Share by which quadrature may miss the work of the fastest vibration within a step; slower ones it misses by less."""
FEWEST_NODES, MOST_NODES = 3, 10
"""Fewest and most Gauss points in a step or a part of it, of which three integrate exactly what is left of the energy
of a loose contact, of the fifth degree in time under a straight torque."""
NODES_IN_PART = 4
"""Number of Gauss points in a part of a step, in which nothing turns by more than 0.25 rad: four points miss
5.6e-10 (2 0.25)^8 = 2e-12 of what a vibration loses."""


@dataclass(frozen=True, eq=False)
class WorkRows:
    """Powers in W as squares of rows over z, then as products of two rows, each with a factor and an owner.

    ``rows`` are (n_squares + 2 n_products, N): squares, first rows and second rows. The owner "" is outside.
    """

    rows: FloatArray
    n_squares: int
    factors: FloatArray
    owners: tuple[str, ...]

    def powers(self, values: FloatArray) -> FloatArray:
        """Powers (..., n_powers, n) over their factors from values (..., n_rows, n) of the rows."""
        n, m = self.n_squares, len(self.owners) - self.n_squares
        squares, products = values[..., :n, :] ** 2, values[..., n : n + m, :] * values[..., n + m :, :]
        return np.concatenate([squares, products], axis=-2)


def work_rows(states: ContactStates, contact: Contact, form: ContactForm, h: float) -> WorkRows:
    """Powers of dampers, of laws of motion, of controllers and of torques from outside, over z in steps of h seconds.

    A law over the twist stores what its torque at rest would take up; the rest is lost.
    """
    plant, at = states.plant, states.at
    squares: list[tuple[FloatArray, float, str]] = []
    products: list[tuple[FloatArray, FloatArray, float, str]] = []
    system, speed, one = plant.assembly.system, form.motion[1], np.eye(at.size)[at.one]
    for number, law in enumerate(plant.assembly.laws):
        if system.damping[number] and not isinstance(law, PlacedLaw):
            squares.append((system.rows[number] @ speed, float(system.damping[number]), plant.assembly.owners[number]))
    for number, (law_of, place) in enumerate(zip(states.laws, contact, strict=True)):
        phase, rate = law_of.phases[place], form.rates[number]
        if law_of.over_rate:
            if phase.kind != "hold" or phase.lower:
                products.append((form.torques[number], rate, 1.0, law_of.owner))
        elif phase.kind == "free":
            line = phase.torque * one + phase.stiffness * form.twists[number]
            products.append((line, rate, -1.0, law_of.owner))
        elif phase.kind == "slope" and phase.damping:
            squares.append((rate, phase.damping, law_of.owner))
    for number, column in enumerate(states.drive.columns.T):
        products.append((form.inputs[number], column @ speed, 1.0, ""))
    for action, torque in zip(plant.actions, form.act, strict=True):
        products.append((torque, action.row @ speed, 1.0, ""))
    rows = [row for row, _, _ in squares] + [one for one, _, _, _ in products] + [row for _, row, _, _ in products]
    return WorkRows(
        np.array(rows) * in_steps(at, h),
        len(squares),
        np.array([factor for _, factor, _ in squares] + [factor for _, _, factor, _ in products]),
        tuple([owner for _, _, owner in squares] + [owner for _, _, _, owner in products]),
    )


def gauss_points(count: int, parts: int = 1) -> tuple[FloatArray, FloatArray]:
    """Places and weights of Gauss points from 0 to 1, so many in each of so many equal parts."""
    places, weights = np.polynomial.legendre.leggauss(count)
    begins = np.arange(parts)[:, None]
    return ((begins + (places + 1) / 2) / parts).ravel(), np.tile(weights / (2 * parts), parts)


def node_count(turn: float) -> tuple[int, int]:
    """Number of Gauss points, and of parts of a step, in which the fastest vibration turns, or decays, by so many rad.

    >>> node_count(1.0), node_count(16.0)
    ((6, 1), (9, 4))
    """
    parts = 1
    while True:
        for count in range(FEWEST_NODES, MOST_NODES + 1):
            size = math.factorial(count) ** 4 / ((2 * count + 1) * math.factorial(2 * count) ** 3)
            if size * (2 * turn / parts) ** (2 * count) < WORK_TOLERANCE:
                return count, parts
        parts += 1


@dataclass(frozen=True, eq=False)
class _Tables:
    work: WorkRows
    weights: FloatArray
    inside: FloatArray
    steps: StepMatrices
    taylor: FloatArray
    finest: FloatArray


class Works:
    """Works in J by element along stretches of motion; those of torques from outside stand under ""."""

    def __init__(self, states: ContactStates, drive: FloatArray) -> None:
        self.states, self.drive = states, drive
        self.h, self.n_sub = states.h, states.n_sub
        self.found: dict[str, float] = {}
        self.losses = EventLosses(states, drive)
        self._tables: dict[Contact, _Tables] = {}

    def add(self, stretches: Stretches) -> None:
        """Add the works along stretches of motion, and what is lost at events between them."""
        for contact, whole, few in stretches.alike():
            tables = self._tables_of(contact)
            sums = self._over_steps(tables, few) if whole else self._over_parts(tables, few)
            for owner, value in zip(tables.work.owners, (self.h * tables.work.factors * sums).tolist(), strict=True):
                self.found[owner] = self.found.get(owner, 0.0) + value
        for owner, value in self.losses.between(stretches):
            self.found[owner] = self.found.get(owner, 0.0) + value

    def _tables_of(self, contact: Contact) -> _Tables:
        if contact not in self._tables:
            if len(self._tables) >= MOST_KEPT:
                self._tables.clear()
            self._tables[contact] = self._made(contact)
        return self._tables[contact]

    def _made(self, contact: Contact) -> _Tables:
        at = self.states.at
        form, units = self.states.form(contact), in_steps(at, self.h)
        A = self.h * form.A * units / units[:, None]
        work = work_rows(self.states, contact, form, self.h)
        places, weights = gauss_points(*node_count(max(form.largest_rates) * self.h))
        inside = np.vstack([work.rows @ scipy.linalg.expm(place * A) for place in places])
        taylor = [work.rows]
        for k in range(1, DEGREE + 1):
            taylor.append(taylor[-1] @ A / k)
        steps = step_matrices(np.asarray(scipy.linalg.expm(A)), at)
        return _Tables(work, weights, inside, steps, np.array(taylor), np.asarray(scipy.linalg.expm(A / self.n_sub)))

    def _over_steps(self, tables: _Tables, few: Stretches) -> FloatArray:
        weights, steps = tables.weights, tables.steps
        p, i = few.starts.T, few.numbers[:, 1]
        total = np.zeros(len(tables.work.owners))
        for step in range(int(few.numbers[:, 2].max())):
            now, then = self.drive[i + step].T, self.drive[i + step + 1].T
            values = (tables.inside @ np.vstack([p, now, then - now])).reshape(len(weights), -1, len(i))
            inside = (step < few.numbers[:, 2]).astype(float)
            total += np.tensordot(weights, tables.work.powers(values), axes=1) @ inside
            p = steps.powers[0] @ p + steps.first @ now + steps.last @ then
        return total

    def _over_parts(self, tables: _Tables, few: Stretches) -> FloatArray:
        z, lengths = few.whole_states(self.drive), few.times[:, 1]
        places, weights = gauss_points(NODES_IN_PART)
        total = np.zeros(len(tables.work.owners))
        for part in range(self.n_sub):
            sizes = np.clip(lengths - part / self.n_sub, 0.0, 1 / self.n_sub)
            if not sizes.any():
                break
            coefficients = tables.taylor @ z
            for place, weight in zip(places, weights, strict=True):
                total += weight * tables.work.powers(_polynomial(coefficients, place * sizes)) @ sizes
            z = tables.finest @ z
        return total


def _polynomial(coefficients: FloatArray, at: FloatArray) -> FloatArray:
    """Values of polynomials with ascending coefficients (DEGREE + 1, n_rows, n) at places (n,)."""
    value: FloatArray = coefficients[-1]
    for one in coefficients[-2::-1]:
        value = value * at + one
    return np.asarray(value)

"""Works of dampers, laws of motion and torques from outside along a motion, by Gauss quadrature of its exact course."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.model.elements import MotionLaw
from torsionnet.motion.contact_form import ContactForm
from torsionnet.motion.contact_states import Contact, ContactStates
from torsionnet.motion.march_tables import StepMatrices, in_steps, step_matrices
from torsionnet.motion.marching import DEGREE
from torsionnet.motion.motion_plant import LawPhases, PlacedLaw
from torsionnet.motion.motion_record import MOST_KEPT, Stretches
from torsionnet.motion.smooth_laws import ChainPhase

# Energy stored in a plant at a state of motion, as squares of rows over the state z and energies of laws of motion.


@dataclass(frozen=True, eq=False)
class EnergyRows:
    """Rows over z whose squares times weights are energies in J, and laws of motion with rows of their twists."""

    squares: FloatArray
    weights: FloatArray
    laws: tuple[MotionLaw | ChainPhase, ...]
    twists: FloatArray

    def at(self, Z: FloatArray) -> FloatArray:
        """Kinetic energy and energy stored in springs in J, shape (n,), at states Z (N, n)."""
        energies = self.weights @ (self.squares @ Z) ** 2
        for law, twists in zip(self.laws, self.twists @ Z, strict=True):
            energies += [float(law.energy(twist)) for twist in twists.tolist()]
        return np.asarray(energies)


def energy_rows(states: ContactStates, contact: Contact) -> EnergyRows:
    """Energy rows of a contact state over a state z that counts time in steps."""
    plant, at = states.plant, states.at
    form, system = states.form(contact), plant.assembly.system
    refresh = form.refresh * in_steps(at, states.h)
    position, speed = (rows @ refresh for rows in form.motion[:2])
    linear = np.array([not isinstance(law, PlacedLaw) for law in plant.assembly.laws], dtype=bool)
    # sum of J gamma'^2 / 2 and k gamma^2 / 2 of linear laws; laws over the twist add energies of their own.
    squares = np.vstack([system.rows @ speed, system.rows @ position])
    weights = np.concatenate([system.inertia, system.stiffness * linear]) / 2
    storing = [number for number, law in enumerate(plant.laws) if law.law.curve.over == "twist"]
    laws = tuple(storing_law(states, contact, number) for number in storing)
    return EnergyRows(squares[weights != 0], weights[weights != 0], laws, form.twists[storing] @ refresh)


def storing_law(states: ContactStates, contact: Contact, number: int) -> MotionLaw | ChainPhase:
    """Law over the twist of a number, or the phase in which it remembers, which says what it has stored."""
    phase = states.laws[number].phases[contact[number]]
    return phase if isinstance(phase, ChainPhase) else states.plant.laws[number].law


def remembered_energies(states: ContactStates, contact: Contact, z: FloatArray) -> dict[str, float]:
    """Energy in J stored in laws that remember, by element, at a state z in SI units; their works do not tell it."""
    form = states.form(contact)
    energies: dict[str, float] = {}
    for law, place, twists in zip(states.laws, contact, form.twists, strict=True):
        phase = law.phases[place]
        if isinstance(phase, ChainPhase):
            energies[law.owner] = energies.get(law.owner, 0.0) + phase.energy(float(twists @ form.refresh @ z))
    return energies


def stored_energy(states: ContactStates, contact: Contact, z: FloatArray) -> float:
    """Kinetic energy and energy stored in springs in J at a state z, which counts time in steps."""
    return float(energy_rows(states, contact).at(z[:, None])[0])


# Energy that laws of motion turn into heat at once where they change their piece.


def losing_law(laws: Sequence[LawPhases], before: Sequence[int], after: Sequence[int]) -> str:
    """Element that may turn energy into heat at the change from one contact state to another; empty if none does.

    A preload that catches a row takes the energy of its motion. Friction that begins to slip at less than it stuck with
    lets what has no inertia beyond it, as the spring of a friction with stiffness, go back at once.
    """
    for law, first, second in zip(laws, before, after, strict=True):
        if first == second:
            continue
        catches = law.phases[second].kind == "hold" and not law.over_rate
        lets_go = law.over_rate and law.phases[second].kind != "hold"
        if catches or lets_go:
            return law.owner
    return ""


def holding_law(laws: Sequence[LawPhases], contact: Sequence[int]) -> str:
    """Element whose law holds a row in a contact state, and may have let it go and caught it again at one time."""
    return next((law.owner for law, place in zip(laws, contact, strict=True) if law.phases[place].kind == "hold"), "")


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
        owners = [self._owner(before.contacts[first], after.contacts[second]) for first, second in pairs]
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
        energies = np.zeros(len(stretches.numbers))
        for number in np.unique(stretches.numbers[:, 0]).tolist():
            own = np.flatnonzero(stretches.numbers[:, 0] == number)
            few, contact = stretches.chosen(own), stretches.contacts[number]
            Z = self._end_states(contact, few) if at_end else few.whole_states(self.drive)
            energies[own] = energy_rows(self.states, contact).at(Z)
        return energies

    def _end_states(self, contact: Contact, few: Stretches) -> FloatArray:
        """States z (N, n) at the ends of stretches in one contact state."""
        at, n_sub = self.states.at, self.states.n_sub
        units = in_steps(at, self.states.h)
        # z' = h A z, with time in steps
        A = self.states.h * self.states.form(contact).A * units / units[:, None]
        Z = few.whole_states(self.drive)
        steps = few.numbers[:, 2]
        # Whole steps first, then points of the finer grid, then a Taylor series over the rest.
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
    system, speed, constant = plant.assembly.system, form.motion[1], np.eye(at.size)[at.constant]
    # Dampers lose c gamma'^2.
    for number, law in enumerate(plant.assembly.laws):
        if system.damping[number] and not isinstance(law, PlacedLaw):
            squares.append((system.rows[number] @ speed, float(system.damping[number]), plant.assembly.owners[number]))
    for number, (law_of, place) in enumerate(zip(states.laws, contact, strict=True)):
        phase, rate = law_of.phases[place], form.rates[number]
        # A law over the rate loses T gamma', nothing where it holds a row at rest.
        if law_of.over_rate:
            if phase.kind != "hold" or phase.lower:
                products.append((form.torques[number], rate, 1.0, law_of.owner))
        elif phase.kind == "free":
            # Free contact: no torque acts while its energy k d^2 / 2 goes down, which is lost.
            line = phase.torque * constant + phase.stiffness * form.twists[number]
            products.append((line, rate, -1.0, law_of.owner))
        elif phase.sense:  # all that it takes up; what is stored of it stands in the balance
            products.append((form.torques[number], rate, 1.0, law_of.owner))
        elif phase.kind == "slope" and phase.damping:
            squares.append((rate, phase.damping, law_of.owner))
    # Torques from outside and of controllers supply T times the rate of their row.
    for number, column in enumerate(states.drive.columns.T):
        products.append((form.inputs[number], column @ speed, 1.0, ""))
    for action, torque in zip(plant.actions, form.act, strict=True):
        products.append((torque, action.row @ speed, 1.0, ""))
    rows = [row for row, _, _ in squares] + [first for first, _, _, _ in products] + [row for _, row, _, _ in products]
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
            # Error with n points, (n!)^4 / ((2n + 1) (2n)!^3) (2 turn)^2n, as powers turn twice as fast.
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
        self.by_element: dict[str, float] = {}
        self.losses = EventLosses(states, drive)
        self._tables: dict[Contact, _Tables] = {}

    def add(self, stretches: Stretches) -> None:
        """Add the works along stretches of motion, and what is lost at events between them."""
        for contact, whole, few in stretches.alike():
            tables = self._tables_of(contact)
            sums = self._over_steps(tables, few) if whole else self._over_parts(tables, few)
            for owner, value in zip(tables.work.owners, (self.h * tables.work.factors * sums).tolist(), strict=True):
                self.by_element[owner] = self.by_element.get(owner, 0.0) + value
        for owner, value in self.losses.between(stretches):
            self.by_element[owner] = self.by_element.get(owner, 0.0) + value

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
        # Rows of the powers at the Gauss points of a step, rows exp(place A).
        inside = np.vstack([work.rows @ scipy.linalg.expm(place * A) for place in places])
        # In parts of a step: terms rows A^k / k! of the Taylor series.
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
            # Only stretches that last beyond this step count in it.
            inside = (step < few.numbers[:, 2]).astype(float)
            total += np.tensordot(weights, tables.work.powers(values), axes=1) @ inside
            p = steps.powers[0] @ p + steps.first @ now + steps.last @ then
        return total

    def _over_parts(self, tables: _Tables, few: Stretches) -> FloatArray:
        z, lengths = few.whole_states(self.drive), few.times[:, 1]
        # Work is the integral of power: Gauss points in each part of a step, motion from its Taylor polynomial there.
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
    for coefficient in coefficients[-2::-1]:
        value = value * at + coefficient
    return np.asarray(value)

"""Record of a motion: readings at samples, and works of torques, from stretches of motion in one contact state."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.functionals import Functional
from torsionnet.assembly.rows import FloatArray
from torsionnet.model.channels import Input
from torsionnet.solve.motion.contact_form import ContactForm
from torsionnet.solve.motion.contact_states import Contact, ContactStates, rates_of
from torsionnet.solve.motion.march_tables import BLOCK, in_steps, rows_along
from torsionnet.solve.motion.marching import DEGREE
from torsionnet.solve.motion.motion_plant import PlacedLaw
from torsionnet.solve.motion.read_rows import reading_rows

WORK_TOLERANCE = 1e-12
"""Share by which quadrature may miss the work of the fastest vibration within a step."""
MOST_NODES, NODES_IN_PART = 10, 4
"""Most Gauss points in a step, and Gauss points in a part of a step, in which nothing turns by more than 0.25 rad: four
points miss 5.6e-10 (2 0.25)^8 = 2e-12 of what a vibration loses."""
COLUMNS = 256
"""Number of stretches worked on at once, enough for products of matrices at full speed."""


@dataclass(frozen=True, eq=False)
class WorkRows:
    """Powers in W as products of two rows over z, with a factor and the element to which each belongs.

    ``first`` and ``second`` are (n_powers, N); an owner of "" is a torque from outside.
    """

    first: FloatArray
    second: FloatArray
    factors: FloatArray
    owners: tuple[str, ...]


def work_rows(states: ContactStates, contact: Contact, form: ContactForm) -> WorkRows:
    """Powers of dampers, of laws of motion, of controllers and of torques from outside in a contact state.

    A law over the twist stores what its torque at rest would take up; the rest is lost.
    """
    plant, at, drive = states.plant, states.at, states.drive
    found: list[tuple[FloatArray, FloatArray, float, str]] = []
    system, speed, one = plant.assembly.system, form.refresh[at.v], np.eye(at.size)[at.one]
    for number, law in enumerate(plant.assembly.laws):
        if system.damping[number] and not isinstance(law, PlacedLaw):
            rate = system.rows[number] @ speed
            found.append((rate, rate, float(system.damping[number]), plant.assembly.owners[number]))
    for number, (law_of, place) in enumerate(zip(states.laws, contact, strict=True)):
        phase, rate = law_of.phases[place], form.rates[number]
        if phase.kind == "hold" and not (law_of.over_rate and phase.lower):
            continue
        if law_of.over_rate:
            found.append((form.torques[number], rate, 1.0, law_of.owner))
        elif phase.kind == "free":
            found.append((phase.torque * one + phase.stiffness * form.twists[number], rate, -1.0, law_of.owner))
        elif phase.damping:
            found.append((rate, rate, phase.damping, law_of.owner))
    for number, column in enumerate(drive.columns.T):
        found.append((form.inputs[number], column @ speed, 1.0, ""))
    for action, torque in zip(plant.actions, form.act, strict=True):
        found.append((torque, action.row @ speed, 1.0, ""))
    units = in_steps(at, states.h)
    return WorkRows(
        np.array([first for first, _, _, _ in found]) * units,
        np.array([second for _, second, _, _ in found]) * units,
        np.array([factor for _, _, factor, _ in found]),
        tuple(owner for _, _, _, owner in found),
    )


def stored_energy(states: ContactStates, contact: Contact, z: FloatArray) -> float:
    """Kinetic energy and energy stored in springs in J at a state z, which counts time in steps."""
    plant, at = states.plant, states.at
    form = states.form(contact)
    whole = form.refresh @ (z * in_steps(at, states.h))
    system = plant.assembly.system
    twists, rates = system.rows @ whole[at.q], system.rows @ whole[at.v]
    linear = np.array([not isinstance(law, PlacedLaw) for law in plant.assembly.laws], dtype=bool)
    found = 0.5 * float(system.inertia @ rates**2 + system.stiffness[linear] @ twists[linear] ** 2)
    own = form.twists @ whole
    return found + sum(float(one.law.energy(float(twist))) for one, twist in zip(plant.laws, own, strict=True))


def gauss_points(count: int) -> tuple[FloatArray, FloatArray]:
    """Places and weights of Gauss points from 0 to 1."""
    places, weights = np.polynomial.legendre.leggauss(count)
    return (places + 1) / 2, weights / 2


def node_count(turn: float) -> int:
    """Number of Gauss points in a step in which the fastest vibration turns by an angle in rad."""
    for count in range(2, MOST_NODES):
        size = math.factorial(count) ** 4 / ((2 * count + 1) * math.factorial(2 * count) ** 3)
        if size * (2 * turn) ** (2 * count) < WORK_TOLERANCE:
            return count
    return MOST_NODES


@dataclass(frozen=True, eq=False)
class _Rows:
    """Rows of a contact state along a block of steps: of readings, and of powers at Gauss points."""

    read: tuple[FloatArray, FloatArray]
    at_once: FloatArray
    work: WorkRows
    powers: tuple[tuple[FloatArray, FloatArray], ...]
    nodes: int
    taylor: tuple[FloatArray, FloatArray]
    finest: FloatArray


class MotionRecord:
    """Record of readings (n_out, n) at samples and of works in J by element, filled with stretches of motion.

    ``refinement`` is the number of steps between samples, ``drive`` (n_points, n_u) the torques at the grid points.
    """

    def __init__(
        self, states: ContactStates, readings: Sequence[Functional], inputs: Sequence[Input], n: int, refinement: int,
        drive: FloatArray,
    ) -> None:  # fmt: skip
        self.states, self.readings, self.inputs = states, readings, inputs
        self.refinement, self.drive = refinement, drive
        self.values = np.zeros((len(readings), n))
        self.works: dict[str, float] = {}
        self._rows: dict[Contact, _Rows] = {}

    def add(self, numbers: NDArray[np.int64], times: FloatArray, starts: FloatArray) -> None:
        """Read stretches of motion at samples and count their works.

        They are given by contact state, grid point and steps (n, 3), parts of a step at the beginning and passed
        (n, 2), and states p at the beginning (n, n_p).
        """
        for number in np.unique(numbers[:, 0]).tolist():
            contact = self.states.contacts[number]
            rows = self._rows_of(contact)
            own = numbers[:, 0] == number
            whole = np.flatnonzero(own & (numbers[:, 2] > 0))
            parts = np.flatnonzero(own & (numbers[:, 2] == 0))
            for first in range(0, len(whole), COLUMNS):
                chosen = whole[first : first + COLUMNS]
                self._add_steps(rows, numbers[chosen, 1], numbers[chosen, 2], starts[chosen])
            for first in range(0, len(parts), COLUMNS):
                chosen = parts[first : first + COLUMNS]
                self._add_parts(rows, numbers[chosen, 1], times[chosen], starts[chosen])

    def add_last(self, contact: Contact, i: int, p: FloatArray) -> None:
        """Read the state p at the last grid point."""
        z = self._whole(np.array([i]), np.zeros(1), p[None])
        self.values[:, i // self.refinement] = (self._rows_of(contact).at_once @ z)[:, 0]

    def _whole(self, i: NDArray[np.int64], f: FloatArray, p: FloatArray) -> FloatArray:
        before, after = self.drive[i], self.drive[i + 1]
        return np.vstack([p.T, (before + f[:, None] * (after - before)).T, (after - before).T])

    def _rows_of(self, contact: Contact) -> _Rows:
        if contact not in self._rows:
            if len(self._rows) >= 64:  # their rows take up to some MB each
                self._rows.clear()
            self._rows[contact] = self._made(contact)
        return self._rows[contact]

    def _made(self, contact: Contact) -> _Rows:
        from scipy import linalg

        states, at = self.states, self.states.at
        form, units = states.form(contact), in_steps(states.at, states.h)
        A = states.h * form.A * units / units[:, None]
        whole = np.asarray(linalg.expm(A))
        read = reading_rows(states.plant, self.readings, self.inputs, form, at) * units
        work = work_rows(states, contact, form)
        nodes = node_count(rates_of(form)[0] * states.h)
        inside = [np.asarray(linalg.expm(place * A)) for place in gauss_points(nodes)[0]]
        powers = tuple(
            rows_along(np.vstack([rows @ one for one in inside]), whole, at, BLOCK)
            for rows in (work.first, work.second)
        )
        taylor = []
        for rows in (work.first, work.second):
            made = [rows]
            for k in range(1, DEGREE + 1):
                made.append(made[-1] @ A / k)
            taylor.append(np.array(made))
        finest = np.asarray(linalg.expm(A / states.n_sub))
        return _Rows(rows_along(read, whole, at, BLOCK), read, work, powers, nodes, (taylor[0], taylor[1]), finest)

    def _add_steps(self, rows: _Rows, i: NDArray[np.int64], steps: NDArray[np.int64], starts: FloatArray) -> None:
        places = i[:, None] + np.arange(BLOCK + 1)
        driven = self.drive[places].reshape(len(i), -1).T
        inside = np.arange(BLOCK)[:, None] < steps
        sampled = inside & (places[:, :BLOCK].T % self.refinement == 0)
        if sampled.any():
            read = _along(rows.read, starts, driven)
            which, column = np.nonzero(sampled)
            self.values[:, places[column, which] // self.refinement] = read[which, :, column].T
        first, second = (_along(one, starts, driven) for one in rows.powers)
        weights = gauss_points(rows.nodes)[1]
        products = (first * second).reshape(BLOCK, rows.nodes, -1, len(i))
        self._count(rows.work, np.einsum("snpc,n,sc->p", products, weights, inside.astype(float), optimize=True))

    def _add_parts(self, rows: _Rows, i: NDArray[np.int64], times: FloatArray, starts: FloatArray) -> None:
        begins, lengths = times[:, 0], times[:, 1]
        z = self._whole(i, begins, starts)
        sampled = (begins == 0) & (i % self.refinement == 0)
        self.values[:, i[sampled] // self.refinement] = rows.at_once @ z[:, sampled]
        places, weights = gauss_points(NODES_IN_PART)
        total = np.zeros(len(rows.work.owners))
        for part in range(self.states.n_sub):
            sizes = np.clip(lengths - part / self.states.n_sub, 0.0, 1 / self.states.n_sub)
            if not sizes.any():
                break
            first, second = (one @ z for one in rows.taylor)
            for place, weight in zip(places, weights, strict=True):
                at = place * sizes
                total += weight * (_horner(first, at) * _horner(second, at)) @ sizes
            z = rows.finest @ z
        self._count(rows.work, total)

    def _count(self, work: WorkRows, sums: FloatArray) -> None:
        for owner, value in zip(work.owners, (self.states.h * work.factors * sums).tolist(), strict=True):
            self.works[owner] = self.works.get(owner, 0.0) + value


def _along(rows: tuple[FloatArray, FloatArray], starts: FloatArray, driven: FloatArray) -> FloatArray:
    """Values (BLOCK, n_rows, n_columns) of rows along blocks of steps that begin at states (n_columns, n_p)."""
    ahead, pushed = rows
    shape = ahead.shape[:2]
    found = ahead.reshape(-1, ahead.shape[2]) @ starts.T + pushed.reshape(-1, pushed.shape[2]) @ driven
    return np.asarray(found.reshape(*shape, len(starts)))


def _horner(coefficients: FloatArray, at: FloatArray) -> FloatArray:
    value: FloatArray = coefficients[-1]
    for one in coefficients[-2::-1]:
        value = value * at + one
    return np.asarray(value)

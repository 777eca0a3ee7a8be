"""Equations of motion in one contact state, z' = A z, with everything that moves by itself in z.

    z = (q, q', controllers, generators of torques, 1, u, u')

q are the coordinates of the plant in every contact state, so that z passes from one to the next. What a contact state
holds still is eliminated, q = Z y + Y c with the held angles c, and what has no inertia or no inertia and no damper in
it follows from the rest: the refresh takes z to the nearest one that meets these conditions. Torques u run straight
between grid points; generators w' = F w add S w to them.

Motions without inertia that nothing but friction fixes, as those of a node between two frictions. Such a node takes at
once the rate at which its torques are in balance. Where all friction beside it slips, its torques are constant, so that
it runs on until as many of the frictions stick as it has motions; those that stick carry no more than they hold. This
is the minimum over the rates w of sum_i T_i |r_i + n_i w| - f w.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray, Rows, RowSystem
from torsionnet.linear.dynamic_stiffness.action_states import LawStates
from torsionnet.linear.dynamic_stiffness.row_algebra import unresisted_motions
from torsionnet.linear.dynamic_stiffness.state_space import (
    StateSpaceForm,
    close_loops_in_states,
    condensed,
    motion_kinds,
    reduced_matrices,
)
from torsionnet.motion.motion_plant import Drive, LawPhases, Layout, MotionPlant, Phase

# Motions of coordinates in which rows are held still, as by friction that sticks.

DEPENDENT = 1e-9
"""Size of a pivot, over the entries of its row, below which held rows depend on each other: ratios of real machinery
meet to 1e-11 or differ by more than 1e-6."""


@dataclass(frozen=True, eq=False)
class Held:
    """Motions q = Z y + Y c of coordinates in which rows are held at c, with y = q[free]."""

    Z: FloatArray
    Y: FloatArray
    free: tuple[int, ...]


def held_motions(rows: FloatArray, owners: Sequence[str]) -> Held:
    """Motions of coordinates in which rows (n_rows, n_q) are held, by elimination of one coordinate for each row.

    Raises
    ------
    UsageError
        Rows depend on each other: the parts stick in a loop.
    """
    # Gauss-Jordan: rows so far are combinations of the given ones, ``left`` = ``made`` @ rows.
    left, made = rows.copy(), np.eye(len(rows))
    pivots: list[int] = []
    for number in range(len(rows)):
        for other, pivot in enumerate(pivots):
            factor = left[number, pivot]
            left[number] -= factor * left[other]
            made[number] -= factor * made[other]
        left[number, pivots] = 0.0
        pivot = int(np.abs(left[number]).argmax())
        # Without a pivot the row is a combination of those in ``made``.
        if np.abs(left[number, pivot]) <= DEPENDENT * np.abs(rows[number]).max():
            names = [owners[row] for row in np.flatnonzero(np.abs(made[number]) > DEPENDENT).tolist()]
            text = "stick in a loop, so that their torques do not follow from equilibrium"
            raise UsageError(
                f"{' and '.join(dict.fromkeys(names))} {text}; give one of them a stiffness",
                kind="indeterminate-torque",
            )
        made[number] /= left[number, pivot]
        left[number] /= left[number, pivot]
        for other in range(number):
            factor = left[other, pivot]
            left[other] -= factor * left[number]
            made[other] -= factor * made[number]
        pivots.append(pivot)
    n = rows.shape[1]
    free = tuple(column for column in range(n) if column not in pivots)
    # left = [I R] over pivots and free columns: q_pivot = -R y + made c
    Z, Y = np.zeros((n, len(free))), np.zeros((n, len(rows)))
    Z[list(free), range(len(free))] = 1.0
    Z[pivots], Y[pivots] = -left[:, list(free)], made
    return Held(Z, Y, free)


# Motions without inertia that nothing but friction fixes, as those of a node between two frictions.

AT_REST = 1e-12
"""Share of the largest rate up to which a slip counts as just begun."""
BEGUN = 1e-9
"""Rate of a slip that has just begun, over the largest rate, of the first one: no two are equal and end at once."""
HOLDING = 1e-9
"""Share of what friction holds by which it may seem to carry more by rounding."""
PARALLEL = 1e-9
"""Determinant of the ways of frictions, over their sizes, from which they fix a motion."""


class LooseMotionError(UsageError):
    """Error of motions (n_q, n) without inertia that nothing fixes in a contact state."""

    def __init__(self, text: str, motions: FloatArray, *, kind: str = "") -> None:
        super().__init__(text, kind=kind)
        self.motions = motions


@dataclass(frozen=True)
class Slip:
    """Friction that slips beside a loose motion.

    Attributes
    ----------
    way : (n,) array
        Rate of the slip per rate of each loose motion.
    rate : float
        Rate of the slip in rad/s.
    sign : int
        Direction of its torque.
    torque : float
        Size of its torque in N m while it slips.
    holds : float
        Torque in N m that it holds.
    """

    way: FloatArray
    rate: float
    sign: int
    torque: float
    holds: float


def balanced_slips(slips: Sequence[Slip], outside: FloatArray) -> FloatArray | None:
    """Rates (n_slips,) in rad/s at which loose motions are in balance, those that stick exactly 0; None without any.

    ``outside`` (n,) are the torques in N m on the loose motions from outside.
    """
    ways, rates = np.array([slip.way for slip in slips]), np.array([slip.rate for slip in slips])
    torques, holds = (np.array([getattr(slip, name) for slip in slips]) for name in ("torque", "holds"))
    size = np.abs(rates).max(initial=0.0) or 1.0
    # A slip that has just begun goes the way of its torque, each at a rate of its own.
    begun = np.array([slip.sign for slip in slips]) * BEGUN * size * (1 + np.arange(len(slips)) / len(slips))
    rates = np.where(np.abs(rates) <= AT_REST * size, begun, rates)
    # At the minimum as many frictions stick as there are loose motions: all such choices are tried.
    for chosen in combinations(range(len(slips)), ways.shape[1]):
        stick = list(chosen)
        own = ways[stick]
        if abs(np.linalg.det(own)) <= PARALLEL * np.prod(np.abs(own).max(axis=1)):
            continue
        # The rates w that stop the chosen ones, and what they leave of r_i + n_i w.
        left = rates - ways @ np.linalg.solve(own, rates[stick])
        left[stick] = 0.0
        # n^T carried = f - sum_i n_i T_i sign(r_i), which the chosen ones must be able to hold.
        carried = np.linalg.solve(own.T, outside - ways.T @ (torques * np.sign(left)))
        if (np.abs(carried) <= holds[stick] * (1 + HOLDING)).all():
            return np.asarray(left)
    return None


NEGLIGIBLE_ENTRY = 1e-12
"""Size of a row's entry, over its largest, that is rounding of entries which cancel."""


@dataclass(frozen=True, eq=False)
class ContactForm:
    """Equations of motion in one contact state in SI units, and rows over z of what is read.

    Attributes
    ----------
    A, refresh : (N, N) arrays
        z' = A z for a refreshed z.
    motion : three (n_q, N) arrays
        q in rad, q' in rad/s and q'' in rad/s^2 of the coordinates.
    twists, rates, torques : (n_laws, N) arrays
        gamma in rad, gamma' in rad/s and T in N m of each law of motion.
    act : (n_actions, N) array
        Torques of controllers in N m.
    inputs : (n_u, N) array
        Torques and scales from outside.
    """

    A: FloatArray
    refresh: FloatArray
    motion: tuple[FloatArray, FloatArray, FloatArray]
    twists: FloatArray
    rates: FloatArray
    torques: FloatArray
    act: FloatArray
    inputs: FloatArray

    @cached_property
    def largest_rates(self) -> tuple[float, float]:
        """Largest circular frequency of a vibration, and largest pole, in rad/s."""
        poles = np.linalg.eigvals(self.A)
        return float(np.abs(poles.imag).max(initial=0.0)), float(np.abs(poles).max(initial=0.0))

    @property
    def accelerations(self) -> FloatArray:
        """Rows of gamma'' in rad/s^2 of each law of motion, shape (n_laws, N)."""
        return np.asarray(self.rates @ self.A)


def contact_form(plant: MotionPlant, laws: Sequence[LawPhases], contact: Sequence[int], drive: Drive) -> ContactForm:
    """Equations of motion of a plant in one contact state, the number of the phase of each of its laws.

    Raises
    ------
    UsageError
        Rows held in a loop.
    LooseMotionError
        No unique motion of what has no inertia.
    """
    phases = [law.phases[number] for law, number in zip(laws, contact, strict=True)]
    system = plant.linear
    rows = np.array([law.row for law in plant.laws]).reshape(len(phases), system.n_coordinates)
    holds = [number for number, phase in enumerate(phases) if phase.kind == "hold"]
    held = held_motions(rows[holds], [laws[number].owner for number in holds])
    C, K = (_with_laws(matrix, rows, phases, what) for matrix, what in ((system.C, "damping"), (system.K, "stiffness")))
    M = system.M
    # What actions answer at once to angle, rate and acceleration stands in K, C and M.
    for action in plant.actions:
        M, C, K = (
            matrix - value * np.outer(action.row, action.sensed)
            for matrix, value in zip((M, C, K), action.at_once[::-1], strict=True)
        )
    loads = _loads(plant, rows, phases, laws, drive, K, C, held)
    form, heavy, basis = _form(plant, holds, _coefficients(plant, phases), held, loads)
    return _form_over_state(plant, _Parts(phases, laws, holds, held, form, heavy, basis, (M, C, K), rows, drive))


@dataclass(frozen=True, eq=False)
class _Parts:
    phases: Sequence[Phase]
    laws: Sequence[LawPhases]
    holds: Sequence[int]
    held: Held
    form: StateSpaceForm
    heavy: FloatArray
    basis: tuple[FloatArray, int, int]
    matrices: tuple[FloatArray, FloatArray, FloatArray]
    rows: FloatArray
    drive: Drive


def _coefficients(plant: MotionPlant, phases: Sequence[Phase]) -> FloatArray:
    """Damping and stiffness (2, n_laws) of all laws, with the slopes of the phases."""
    coefficients = np.array([plant.linear.damping, plant.linear.stiffness])
    for law, phase in zip(plant.laws, phases, strict=True):
        if phase.kind == "slope":
            coefficients[:, law.number] = phase.damping, phase.stiffness
    return coefficients


def _with_laws(matrix: FloatArray, rows: FloatArray, phases: Sequence[Phase], what: str) -> FloatArray:
    matrix_of_all = matrix.copy()
    for row, phase in zip(rows, phases, strict=True):
        value = getattr(phase, what)
        if phase.kind == "slope" and value:
            matrix_of_all += value * np.outer(row, row)
    return matrix_of_all


def _loads(
    plant: MotionPlant, rows: FloatArray, phases: Sequence[Phase], laws: Sequence[LawPhases], drive: Drive,
    K: FloatArray, C: FloatArray, held: Held,
) -> FloatArray:  # fmt: skip
    """Columns (n_q, n) of torques over u, 1, held angles c and controllers."""
    n_q, n_torques = drive.columns.shape
    columns = np.zeros((n_q, drive.n_u + 1))
    columns[:, :n_torques] = drive.columns
    # The constant torque of a piece acts with the 1, or with the entry of u that scales it.
    for row, phase, scale in zip(rows, phases, drive.scale_of, strict=True):
        if phase.kind == "slope":
            columns[:, drive.n_u if scale < 0 else scale] -= phase.torque * row
    # q = Z y + Y c: held angles load y by -K Y c, those that turn at the speed of a hold by -C Y c' as well.
    turning = [
        phase.lower if law.over_rate else 0.0 for law, phase in zip(laws, phases, strict=True) if phase.kind == "hold"
    ]
    columns[:, drive.n_u] -= C @ held.Y @ np.array(turning)
    driven = np.array([action.row for action in plant.actions]).reshape(len(plant.actions), n_q).T
    return np.hstack([columns, -K @ held.Y, driven])


def _form(
    plant: MotionPlant, holds: Sequence[int], coefficients: FloatArray, held: Held, loads: FloatArray
) -> tuple[StateSpaceForm, FloatArray, tuple[FloatArray, int, int]]:
    """State equations with q over the states, the heavy motions, and the basis of y with its counts of a and b."""
    linear = plant.linear
    law_rows = plant.remembered(("rows", tuple(holds)), lambda: _rows_free(linear, held))
    system = RowSystem(law_rows, linear.inertia, coefficients[0].copy(), coefficients[1].copy())
    key = "kinds", tuple(holds), (coefficients != 0).tobytes()  # whatever their sizes
    kinds, basis, loose = plant.remembered(key, lambda: _kinds(system))
    actions: list[LawStates] = [replace(law, row=law.row @ held.Z, sensed=law.sensed @ held.Z) for law in plant.actions]
    heavy, damped, static = kinds
    names = tuple("" for _ in range(2 * heavy.shape[1] + damped.shape[1]))
    try:
        if loose.shape[1] and not plant.actions:  # which rounding might hide
            raise np.linalg.LinAlgError
        reduced = condensed(reduced_matrices(system, actions, kinds), heavy, damped, static, held.Z.T @ loads, names)
    except np.linalg.LinAlgError:
        nodes = plant.assembly.kinematics.coordinates
        motions = held.Z @ loose
        moving = np.abs(motions if loose.shape[1] else held.Z @ np.hstack([damped, static])).max(axis=1) > DEPENDENT
        names = tuple(name for name, moves in zip(nodes, moving, strict=True) if moves)
        text = "have neither inertia nor anything that fixes their motion while parts beside them slip or are open"
        advice = "give them an inertia, or the parts a damping"
        raise LooseMotionError(f"{', '.join(names)} {text}; {advice}", motions, kind="indeterminate-motion") from None
    n_act = len(plant.actions)
    # q = Z y + Y c, in which c are the inputs before those of the actions.
    U = held.Z @ reduced.U
    n_held = held.Y.shape[1]
    U[:, U.shape[1] - n_act - n_held : U.shape[1] - n_act] += held.Y
    form = replace(reduced, X=held.Z @ reduced.X, U=U)
    if plant.actions:
        form = close_loops_in_states(form, plant.actions)
    return form, heavy, (basis, heavy.shape[1], damped.shape[1])


def _rows_free(linear: RowSystem, held: Held) -> Rows:
    """Rows of all laws over the coordinates y that are left where rows are held."""
    if not held.Y.shape[1]:
        return linear.law_rows
    dense = linear.rows @ held.Z
    # Entries that only rounding left would tie a law to motions that it does not feel.
    dense[np.abs(dense) <= NEGLIGIBLE_ENTRY * np.abs(linear.rows).max(axis=1, keepdims=True)] = 0.0
    return Rows.of(dense)


def _kinds(system: RowSystem) -> tuple[tuple[FloatArray, FloatArray, FloatArray], FloatArray, FloatArray]:
    """Bases of the motions with inertia, damping and neither, the inverse of all together, and what nothing resists."""
    kinds = motion_kinds(system)
    resisted = (system.inertia != 0) | (system.damping != 0) | (system.stiffness != 0)
    return kinds, np.linalg.inv(np.hstack(kinds)), unresisted_motions(system, resisted).basis()


def _form_over_state(plant: MotionPlant, parts: _Parts) -> ContactForm:
    form, drive, held, rows = parts.form, parts.drive, parts.held, parts.rows
    n_q = form.X.shape[0]
    inverse, n_a, n_b = parts.basis
    n_x, n_h = len(form.A), len(parts.holds)
    n_own = 2 * n_a + n_b
    at = Layout(n_q, n_x - n_own, len(drive.F), drive.n_u)
    # x_e = (x, c, w, 1, u, u'), over which the inputs are u + S w, 1 and c
    c, w = slice(n_x, n_x + n_h), slice(n_x + n_h, n_x + n_h + at.n_w)
    unit = w.stop
    u, slope = slice(unit + 1, unit + 1 + at.n_u), slice(unit + 1 + at.n_u, unit + 1 + 2 * at.n_u)
    inputs = np.zeros((at.n_u + 1 + n_h, slope.stop))
    inputs[: at.n_u, u], inputs[: at.n_u, w] = np.eye(at.n_u), drive.S
    inputs[at.n_u, unit] = 1.0
    inputs[at.n_u + 1 :, c] = np.eye(n_h)
    # x_e' = A x_e with x' = A x + B inputs, w' = F w, and u' constant within a step.
    A = np.zeros((slope.stop, slope.stop))
    A[:n_x, :n_x] = form.A
    A[:n_x] += form.B @ inputs
    A[w, w], A[u, slope] = drive.F, np.eye(at.n_u)
    R = np.zeros((slope.stop, at.size))
    # A row held over the rate turns on at that rate, c' = lower; over the twist c is the place.
    for place, number in enumerate(parts.holds):
        phase, over_rate = parts.phases[number], parts.laws[number].over_rate
        if over_rate:
            A[n_x + place, unit] = phase.lower
            R[n_x + place, at.q] = rows[number]
        else:
            R[n_x + place, at.constant] = phase.lower
    # q = X x + U inputs, and q' is its derivative along x_e' = A x_e.
    q = np.hstack([form.X, np.zeros((n_q, slope.stop - n_x))]) + form.U @ inputs
    E = np.zeros((at.size, slope.stop))
    E[at.q], E[at.v] = q, q @ A
    E[at.controllers, n_own:n_x] = np.eye(at.n_c)
    E[at.w, w], E[at.constant, unit] = np.eye(at.n_w), 1.0
    E[at.u, u], E[at.slope, slope] = np.eye(at.n_u), np.eye(at.n_u)
    # R takes x_e back from z, by the inverse of the bases of q and the momentum of q'.
    free = list(held.free)
    R[:n_a, free] = inverse[:n_a]
    R[n_a : 2 * n_a, at.v] = _velocities(plant, parts, inverse[:n_a])
    R[2 * n_a : n_own, free] = inverse[n_a : n_a + n_b]
    R[n_own:n_x, at.controllers] = np.eye(at.n_c)
    R[w, at.w], R[unit, at.constant] = np.eye(at.n_w), 1.0
    R[u, at.u], R[slope, at.slope] = np.eye(at.n_u), np.eye(at.n_u)
    # z' = E A R z; the refresh E R puts z on what the contact state allows.
    whole, refresh, outside = E @ A @ R, E @ R, np.zeros((at.n_u, at.size))
    outside[:, at.u], outside[:, at.w] = np.eye(at.n_u), drive.S
    motion = refresh[at.q], refresh[at.v], whole[at.v]
    act = _action_torques(plant, at, *motion)
    bare = ContactForm(
        whole, refresh, motion, rows @ motion[0], rows @ motion[1], np.zeros((len(rows), at.size)), act, outside
    )
    return replace(bare, torques=_law_torques(plant, parts, at, bare, motion))


def _velocities(plant: MotionPlant, parts: _Parts, plain: FloatArray) -> FloatArray:
    """Rows (n_a, n_q) of the rates of the heavy motions from q', which keep the momentum where rows are caught.

    What has no inertia has none: its rate, which jumps as friction beside it begins to stick, moves no inertia.
    """
    held, M = parts.held, plant.assembly.system.M
    turning = any(parts.laws[number].over_rate and parts.phases[number].lower for number in parts.holds)
    if parts.holds and parts.heavy.shape[1] and not turning:
        # Momentum over the heavy motions P = Z a is kept as rows are caught: (P^T M P) a' = P^T M q'.
        moved = held.Z @ parts.heavy
        return np.asarray(np.linalg.solve(moved.T @ M @ moved, moved.T @ M))
    velocities = np.zeros((len(plain), len(held.Z)))
    velocities[:, list(held.free)] = plain
    return velocities


def _action_torques(
    plant: MotionPlant, at: Layout, position: FloatArray, speed: FloatArray, acceleration: FloatArray
) -> FloatArray:
    torques = np.zeros((len(plant.actions), at.size))
    place = at.controllers.start
    # What follows the sensed motion at once, and H x of the states of the action.
    for number, action in enumerate(plant.actions):
        for value, motion in zip(action.at_once, (position, speed, acceleration), strict=True):
            torques[number] += value * (action.sensed @ motion)
        torques[number, place : place + len(action.H)] += action.H
        place += len(action.H)
    return torques


def _law_torques(
    plant: MotionPlant, parts: _Parts, at: Layout, form: ContactForm, motion: tuple[FloatArray, FloatArray, FloatArray]
) -> FloatArray:
    """Rows (n_laws, N) of the torques of the laws of motion, of held rows the multipliers of their constraints."""
    torques = form.torques.copy()
    for number, (phase, scale) in enumerate(zip(parts.phases, parts.drive.scale_of, strict=True)):
        if phase.kind == "slope":
            torques[number] = phase.stiffness * form.twists[number] + phase.damping * form.rates[number]
            if scale < 0:
                torques[number, at.constant] += phase.torque
            else:
                torques[number] += phase.torque * form.inputs[scale]
    M, C, K = parts.matrices
    position, speed, acceleration = motion
    n_torques = parts.drive.columns.shape[1]
    # The multipliers are what the equations of all coordinates leave over, along Y.
    left = parts.drive.columns @ form.inputs[:n_torques] - M @ acceleration - C @ speed - K @ position
    for number, (phase, scale) in enumerate(zip(parts.phases, parts.drive.scale_of, strict=True)):
        if phase.kind == "slope" and phase.torque:
            constant = form.inputs[scale] if scale >= 0 else np.eye(at.size)[at.constant]
            left -= phase.torque * np.outer(parts.rows[number], constant)
    for action, torque in zip(plant.actions, form.act, strict=True):
        at_once = sum(
            value * (action.sensed @ part) for value, part in zip(action.at_once, motion, strict=True)
        )  # stands in M, C and K
        left += np.outer(action.row, torque - at_once)
    torques[list(parts.holds)] = parts.held.Y.T @ left
    return torques


def relative_form(plant: MotionPlant, at: Layout, form: ContactForm) -> ContactForm:
    """Form over coordinates relative to the rotation of the whole, which grows without bounds and moves nothing."""
    # S gives the angle of the whole to all that turn with it, ``back`` takes it away.
    S, back = np.eye(at.size), np.eye(at.size)
    for pivot, column in plant.turning:
        for place in (at.q, at.v):
            S[place, place.start + pivot] = column
            back[place, place.start + pivot] = np.where(np.arange(at.n_q) == pivot, 1.0, -column)
    turned = [at.q.start + pivot for pivot, _ in plant.turning]
    A, refresh = back @ form.A @ S, back @ form.refresh @ S
    twists, rates, torques, act = (rows @ S for rows in (form.twists, form.rates, form.torques, form.act))
    position, speed, acceleration = (rows @ S for rows in form.motion)
    # Exact ones and zeros, as rounding would grow with the angle of the whole.
    refresh[:, turned] = np.eye(at.size)[:, turned]
    for rows in (A, speed, acceleration, rates, torques, act):
        rows[:, turned] = 0.0
    for place, pivot in zip(turned, (pivot for pivot, _ in plant.turning), strict=True):
        position[:, place] = S[at.q, at.q.start + pivot]
    bound = np.abs(twists[:, turned]) <= NEGLIGIBLE_ENTRY * np.abs(form.twists).max(axis=1, initial=1.0, keepdims=True)
    twists[:, turned] = np.where(bound, 0.0, twists[:, turned])
    return ContactForm(A, refresh, (position, speed, acceleration), twists, rates, torques, act, form.inputs)

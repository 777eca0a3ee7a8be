"""Start of a motion in balance: angles, speeds and contact state at the operating point under the first torques."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsionnet.base.errors import ModelError, UsageError
from torsionnet.base.expressions import Number
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.dynamic_stiffness.action_states import LawStates
from torsionnet.model.arc_spring.arc_curve import ArcCurve
from torsionnet.model.balanced_state import BalancedState
from torsionnet.model.element_base.laws import MotionState
from torsionnet.model.motion_laws.piece_curve import PieceCurve
from torsionnet.model.operating_point import torque_place
from torsionnet.motion.balance.operating_balance import asked_point
from torsionnet.motion.contact_states import Contact
from torsionnet.motion.driving import acting_means, given_speeds
from torsionnet.motion.motion_plant import LawOverCoordinates, Layout, MotionPlant, PlacedLaw
from torsionnet.motion.smooth_laws import SplitPlant

SAME = 1e-9
"""Share by which torques of an operating point and those at the start may differ and count as the same."""
FREE = 1e-9
"""Singular value, over the largest, below which rows do not resist a motion of the coordinates."""

MOST_STEPS = 60
"""Most steps of Newton's method for the twist of arc springs."""
ROUNDING = 1e-13
"""Share of the angles by which its last step may still move them."""


@dataclass(frozen=True, eq=False)
class SteadyStart:
    """State z (2 n_q + n_c + 1,) in SI units in which a motion starts, and the contact state where it is known.

    ``accelerations`` (n_q,) in rad/s^2 are those of torques that are not in balance. ``integrating`` are controllers
    with an integrator, whose torque a balance leaves open: they start from zero.
    """

    z: FloatArray
    contact: Contact | None
    accelerations: FloatArray
    integrating: tuple[str, ...] = ()


def steady_start(drivetrain: AssembledModel, split: SplitPlant, torques: Mapping[str, float]) -> SteadyStart:
    """Start of a drivetrain at its operating point, in balance with torques in N m by input, node or two nodes.

    Torques that are not in balance accelerate it evenly: without vibration.

    Raises
    ------
    ModelError
        There is no balance, as beyond the breakdown torque.
    """
    plant = split.plant
    at = Layout(len(plant.assembly.system.M), sum(len(action.F) for action in plant.actions), 0, 0)
    forces = np.zeros(at.n_q)
    places: dict[str, float] = {}
    for place, torque in torques.items():
        nodes = nodes_of(drivetrain, place)
        key = "-".join(nodes)
        places[key] = places.get(key, 0.0) + torque
        row = dict(zip(nodes, (1, -1), strict=False))
        forces += torque * plant.assembly.rows_of(row)[0]
    rows = {law.number: law for law in _all_rows(split)}
    state = _balanced(drivetrain, plant, places, list(rows.values()), forces)
    known = dict(_states(plant, state)) if state is not None else {}
    speeds = dict(state.speeds) if state is not None else given_speeds(drivetrain)
    v = _speeds(plant, speeds, rows, known)
    known |= _turning(rows, known, v)
    tangents: dict[int, tuple[float, float]] = {}
    q, accelerations, controllers = _angles(plant, rows, known, forces, v, tangents)
    # Arc springs loaded from nothing, which a balance leaves linear: Newton's method on their torques.
    remembering = {number: law for number, law in rows.items() if isinstance(law.law.curve, ArcCurve)}
    for _ in range(MOST_STEPS if remembering else 0):
        before = q
        for number, law in remembering.items():
            there = MotionState(float(law.row @ q))
            stiffness = float(law.law.curve.slopes(there)[0])
            tangents[number] = stiffness, law.law.torque(there.twist, 0.0) - stiffness * there.twist
        q, accelerations, controllers = _angles(plant, rows, known, forces, v, tangents)
        if np.abs(q - before).max() <= ROUNDING * np.abs(q).max():
            break
    z = np.zeros(at.n_p)
    z[at.q], z[at.v], z[at.controllers], z[at.constant] = q, v, controllers, 1.0
    integrating = tuple(action.action.owner for action in plant.actions if _integrates(action))
    return SteadyStart(z, _contact(split, known), accelerations, integrating)


def nodes_of(drivetrain: AssembledModel, place: str) -> tuple[str, ...]:
    """Nodes on which a torque acts, given by input, node or two nodes as ``pulley-block``."""
    return (drivetrain.inputs[place] if place in drivetrain.inputs else torque_place(place)).nodes


def _all_rows(split: SplitPlant) -> Iterator[LawOverCoordinates]:
    yield from split.plant.laws
    for law in split.smooth:
        if law.held < 0:
            yield LawOverCoordinates(law.owner, law.law, law.number, law.row)


def _balanced(
    drivetrain: AssembledModel,
    plant: MotionPlant,
    places: Mapping[str, float],
    rows: list[LawOverCoordinates],
    forces: FloatArray,
) -> BalancedState | None:
    """State of the laws of motion under torques in N m by place; None without such laws."""
    tangents = drivetrain.definition.tangents
    if tangents is None:
        return None
    asked = {place: torque for place, torque in places.items() if torque}
    if asked and _same(acting_means(drivetrain), asked):
        return tangents.state
    try:
        return _state_under(drivetrain, asked)
    except ModelError:
        # No balance: torques that accelerate what turns freely are left out, f - M a.
        relief = _accelerations(plant, [row.row for row in rows], forces)
        if relief is None:
            raise
        taken = plant.assembly.system.M @ relief
        names = plant.assembly.kinematics.coordinates
        left = dict(asked)
        for name, torque in zip(names, taken.tolist(), strict=True):
            if torque:
                left[name] = left.get(name, 0.0) - torque
        return _state_under(drivetrain, left)


def _same(means: Mapping[str, float], asked: Mapping[str, float]) -> bool:
    size = max(map(abs, asked.values()), default=0.0)
    names = {*asked, *(node for node, torque in means.items() if torque)}
    return all(abs(means.get(name, 0.0) - asked.get(name, 0.0)) <= SAME * size for name in names)


def _state_under(drivetrain: AssembledModel, torques: Mapping[str, float]) -> BalancedState:
    speeds = dict(drivetrain.definition.operating_point.speed)
    point = asked_point(drivetrain.definition, {key: Number(value) for key, value in torques.items()}, speeds)
    tangents = drivetrain.at_point(point).definition.tangents
    if tangents is None:
        raise UsageError("an operating point leaves laws of motion out", kind="unsupported-law")
    return tangents.state


def _states(plant: MotionPlant, state: BalancedState) -> Iterator[tuple[int, tuple[MotionState, float]]]:
    """Number of the placed law, state and torque in N m of each law of motion that a balance knows."""
    counts: dict[str, int] = {}
    for number, (owner, law) in enumerate(zip(plant.assembly.owners, plant.assembly.laws, strict=True)):
        if isinstance(law, PlacedLaw):
            place = counts[owner] = counts.get(owner, -1) + 1
            if owner in state.states and place < len(state.states[owner]):
                yield number, (state.states[owner][place], float(state.torques[owner][place]))


def _speeds(
    plant: MotionPlant, speeds: Mapping[str, float], rows: Mapping[int, LawOverCoordinates],
    known: Mapping[int, tuple[MotionState, float]],
) -> FloatArray:  # fmt: skip
    """Speeds (n_q,) in rad/s of the coordinates from those of nodes and the rates of laws."""
    assembly = plant.assembly
    named = [name for name in speeds if name in assembly.node_index]
    wanted = [float(speeds[name]) for name in named]
    matrix = [assembly.T[assembly.node_index[name]] for name in named]
    for number, row in rows.items():
        if row.law.curve.over == "rate" and number in known:
            matrix.append(row.row)
            wanted.append(float(known[number][0].rate))
    if not any(wanted):
        return np.zeros(len(assembly.system.M))
    return np.asarray(np.linalg.lstsq(np.array(matrix), np.array(wanted), rcond=None)[0])


def _turning(
    rows: Mapping[int, LawOverCoordinates], known: Mapping[int, tuple[MotionState, float]], v: FloatArray
) -> dict[int, tuple[MotionState, float]]:
    """States and torques in N m of laws over the rate that the balance does not know, at the speeds v.

    Such are those of elements that keep a working point of their own in linear results, as a propeller.
    """
    turning = {}
    for number, row in rows.items():
        rate = float(row.row @ v)
        if number not in known and row.law.curve.over == "rate" and not row.law.sensed and rate:
            turning[number] = MotionState(rate=rate), float(row.law.torque(0.0, rate))
    return turning


def _accelerations(plant: MotionPlant, rows: list[FloatArray], forces: FloatArray) -> FloatArray | None:
    """Even accelerations (n_q,) in rad/s^2 under torques on the coordinates; None where nothing turns freely."""
    free = _free_motions(plant, rows)
    if not free.shape[1]:
        return None
    # (Phi^T M Phi) a = Phi^T f, over the motions that nothing resists.
    inertia = free.T @ plant.assembly.system.M @ free
    shares = np.linalg.lstsq(inertia, free.T @ forces, rcond=None)[0]
    return np.asarray(free @ shares)


def _free_motions(plant: MotionPlant, rows: list[FloatArray]) -> FloatArray:
    """Motions (n_q, n) of the coordinates that leave springs and rows at rest."""
    system = plant.assembly.system
    placed = [isinstance(law, PlacedLaw) for law in plant.assembly.laws]
    resisting = [row for row, k, away in zip(system.rows, system.stiffness, placed, strict=True) if k and not away]
    matrix = np.array([row / np.abs(row).max() for row in (*resisting, *rows) if np.abs(row).max()])
    if not len(matrix):
        return np.eye(len(system.M))
    _, sizes, right = np.linalg.svd(matrix)
    rank = int((sizes > FREE * sizes.max()).sum())
    return np.asarray(right[rank:].T)


def _angles(
    plant: MotionPlant, rows: Mapping[int, LawOverCoordinates], known: Mapping[int, tuple[MotionState, float]],
    forces: FloatArray, v: FloatArray, tangents: Mapping[int, tuple[float, float]],
) -> tuple[FloatArray, FloatArray, FloatArray]:  # fmt: skip
    """Angles (n_q,) in rad, even accelerations (n_q,) in rad/s^2, and states (n_c,) of controllers.

    ``tangents`` are stiffness in N m/rad and torque in N m at zero twist of laws that stand for springs.
    """
    system, laws = plant.assembly.system, plant.assembly.laws
    linear = np.array([not isinstance(law, PlacedLaw) for law in laws], dtype=bool)
    K = (system.rows.T * (system.stiffness * linear)) @ system.rows
    C = (system.rows.T * (system.damping * linear)) @ system.rows
    load = forces - C @ v
    twisted, wanted, held = [], [], []
    for number, row in rows.items():
        state, torque = known.get(number, (MotionState(), 0.0))
        stiffness, offset = tangents.get(number, (0.0, 0.0))
        K = K + stiffness * np.outer(row.row, row.row)
        load -= (torque + offset) * row.row
        if row.law.curve.over == "twist":
            held.append(row.row)
            if number in known:
                twisted.append(row.row)
                wanted.append(float(state.twist))
        elif row.law.curve.holds(state):
            held.append(row.row)
    finish = []
    for action in plant.actions:
        gain, offset, settle = _steady_controller(action, float(action.sensed @ v))
        K = K - gain * np.outer(action.row, action.sensed)
        load += offset * action.row
        finish.append((action, settle))
    # K q + M Phi a = load, and the twists that the balance knows; all rows of one size for least squares.
    free = _free_motions(plant, held)
    size = max(float(np.abs(K).max(initial=0.0)), 1.0)
    pushed = system.M @ free
    scale = float(np.abs(pushed).max(initial=0.0)) or 1.0
    above = np.hstack([K, pushed * (size / scale)])
    below = np.hstack([size * np.array(twisted).reshape(-1, len(v)), np.zeros((len(twisted), free.shape[1]))])
    solved = np.linalg.lstsq(
        np.vstack([above, below]), np.array([*load, *(size * twist for twist in wanted)]), rcond=None
    )[0]
    q = solved[: len(v)]
    controllers = [settle(float(action.sensed @ q)) for action, settle in finish]
    return q, free @ solved[len(v) :] * (size / scale), np.concatenate([np.zeros(0), *controllers])


def _integrates(action: LawStates) -> bool:
    return bool(len(action.F)) and bool(np.linalg.cond(action.F) > 1 / FREE)


def _steady_controller(action: LawStates, rate: float) -> tuple[float, float, Any]:
    """Torque gain y + offset of a controller in steady motion at a rate in rad/s, and its states over the angle y.

    One with an integrator has no such states; it starts from zero.
    """
    P, F, G, H = action.at_once, action.F, action.G, action.H
    n = len(F)
    if not n or _integrates(action):
        return float(P[0]), float(P[1]) * rate, lambda y: np.zeros(n)  # noqa: ARG005
    # Steady x = along y + moved in x' = F x + G_0 y + G_1 y': F along = -G_0, F moved = (along - G_1) rate.
    along = -np.linalg.solve(F, G[:, 0])
    moved = np.linalg.solve(F, along * rate - G[:, 1] * rate)
    return float(P[0] + H @ along), float(P[1] * rate + H @ moved), lambda y: along * y + moved


def _contact(split: SplitPlant, known: Mapping[int, tuple[MotionState, float]]) -> Contact | None:
    """Contact state of laws in balance; None where one is not known."""
    numbers = []
    for row, phases in zip(split.plant.laws, split.phases, strict=True):
        if row.number not in known or not isinstance(row.law.curve, PieceCurve):
            return None
        state = known[row.number][0]
        piece = row.law.curve.number_at(state.twist, state.rate) if state.piece is None else state.piece
        numbers.append(phases.of_piece(piece))
    return tuple(numbers)

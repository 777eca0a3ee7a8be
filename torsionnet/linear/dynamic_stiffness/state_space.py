"""Linear state space of a drivetrain, x' = A x + B u, y = C x + D u, for python-control.

Coordinates fall into three kinds: with inertia (a), massless but damped (b), and purely static (d):

    M a'' + C (a', b') + K q = ..,    C_b (a', b') + K_b q = ..,    K_d q = ..

The states are a, a' and b; d follows statically. A reading that contains the rate of an input has no state space.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import Functional, functional, powers_of_s
from torsionnet.linear.assembly.rows import Assembly, FloatArray, RowSystem
from torsionnet.linear.dynamic_stiffness.action_states import HIGHEST_POWER, LawStates, law_states
from torsionnet.linear.dynamic_stiffness.reduction import complement_within
from torsionnet.linear.dynamic_stiffness.row_algebra import unresisted_motions
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, resolve_request, usable_channels
from torsionnet.model.channels import Channels, Input, Sensor

if TYPE_CHECKING:
    import control

NEGLIGIBLE_COEFFICIENT = 1e-9
"""Size, over its terms, below which a coefficient that should vanish counts as zero, since smaller limits refuse valid
models."""


@dataclass(frozen=True)
class StateSpaceForm:
    """State equations x' = A x + B u in SI units, with coordinates q = X x + U u and the names of the states x.

    The torque of each of ``actions`` is P(s) (its motion sensed) + (its row of ``torques``) x.
    """

    A: FloatArray
    B: FloatArray
    X: FloatArray
    U: FloatArray
    states: tuple[str, ...]
    actions: tuple[LawStates, ...] = ()
    torques: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))


@dataclass(frozen=True)
class StateSpace:
    """State space x' = A x + B u, y = C x + D u of a drivetrain, with torques u in N m and outputs y in SI units.

    The ``states`` are the names of x.
    """

    A: FloatArray
    B: FloatArray
    C: FloatArray
    D: FloatArray
    states: tuple[str, ...]


def to_control(
    drivetrain: AssembledModel,
    output: Channels | None = None,
    input: Channels | None = None,
    *,
    driven_by: str | Sequence[str] | None = None,
) -> control.StateSpace:
    """State space in SI units for python-control, with named inputs and outputs; also against measured inputs.

    Parameters
    ----------
    output, input : str, Sensor or sequence of these, optional
        As in :meth:`frequency_response`; default: all sensors and inputs of the model. A sensor as input is a
        *measured* one: for outputs beyond a torque meter the state space is that of the drivetrain cut there, else
        that of Y_out Y_in^-1, with a warning that names poles which no output shows.
    driven_by : str or sequence of str, optional
        What drives the drivetrain when the input is measured; default: the model's only input.

    Raises
    ------
    UsageError
        No inputs or sensors, frequency-dependent laws, an imposed angle, or a reading with the rate of an input in it.

    Examples
    --------
    >>> import torsionnet as tn
    >>> space = tn.load("dmf_rig").to_control("theta_1", "T_T")
    >>> sorted(round(float(abs(pole)) / 6.283185307, 3) for pole in space.poles())  # modes(measured_input="T_T")
    [8.755, 8.755, 21167.607]
    """
    import control

    if (output is None) != (input is None) or (output is None and driven_by is not None):
        raise UsageError(
            "name output and input, or neither for all sensors and inputs of the model", kind="missing-entry"
        )
    present = active_channels(drivetrain)
    if output is None and not (present.inputs and present.sensors):
        raise UsageError("a state space needs at least one input and one sensor in the model", kind="missing-entry")
    outputs = list(present.sensors) if output is None else output
    inputs = list(present.inputs) if input is None else input
    system, request = requested_state_space(drivetrain, outputs, inputs, driven_by)
    return control.StateSpace(
        system.A,
        system.B,
        system.C,
        system.D,
        inputs=[reading.name for reading in request.inputs],
        outputs=[reading.name for reading in request.outputs],
        states=[name.replace(".", "_") for name in system.states],
        name=drivetrain.title.replace(".", "_"),  # python-control keeps dots for the signals of a system
        remove_useless_states=False,
    )


def requested_state_space(
    drivetrain: AssembledModel,
    output: Channels,
    input: Channels,
    excitation: str | Sequence[str] | None = None,
) -> tuple[StateSpace, TransferRequest]:
    """State space in SI units between outputs and inputs, which may be measured, and the request resolved.

    Raises
    ------
    UsageError
        Frequency-dependent laws, an imposed angle, or a reading with the rate of an input in it.
    """
    from torsionnet.linear.dynamic_stiffness.measured_state_space import (
        LinearSystem,
        against_measured,
        far_side,
        warn_of_hidden_poles,
        warn_of_lost_digits,
    )

    request = resolve_request(drivetrain, output, input, excitation).with_reached_inputs()
    names = [reading.name for reading in request.outputs]
    far = far_side(drivetrain, request)
    if request.is_measured and far is None:
        # H = Y_out Y_in^-1, equation (5.1): both readings of the same states, divided.
        form = first_order(drivetrain.assembly, request.excitations)
        read, measured = (
            LinearSystem(form.A, form.B, *output_matrices(drivetrain.assembly, readings, request.excitations, form))
            for readings in (request.outputs, request.inputs)
        )
        whole, system = read, against_measured(read, measured, request.names, names)
        warn_of_hidden_poles(system, f"{' and '.join(names)} against {request.names}")
        states = tuple(f"state {number}" for number in range(1, len(system.A) + 1))
    else:
        model, outputs, torques, sense = drivetrain, request.outputs, request.excitations, 1
        if far is not None:
            # What is beyond the meter knows of the rest the measured torque alone.
            model, outputs, torques, sense = far.drivetrain, far.outputs, (far.torque,), far.sense
        form = first_order(model.assembly, torques)
        C, D = output_matrices(model.assembly, outputs, torques, form)
        # Velocities first: elimination of s - A then begins with s itself, where K/M above s^2 would take its digits.
        order = sorted(range(len(form.A)), key=lambda state: not form.states[state].startswith("velocity"))
        states = tuple(form.states[state] for state in order)
        whole = system = LinearSystem(form.A[np.ix_(order, order)], sense * form.B[order], C[:, order], sense * D)
    warn_of_lost_digits(system, request, whole)
    return StateSpace(system.A, system.B, system.C, system.D, states), request


def state_space(drivetrain: AssembledModel) -> StateSpace:
    """State space of a drivetrain in SI units as plain arrays, also where it has no inputs or no sensors.

    Raises
    ------
    UsageError
        Frequency-dependent laws, an imposed angle, or a reading with the rate of an input in it.
    """
    present = active_channels(drivetrain)
    inputs = list(present.inputs.values())
    form = first_order(drivetrain.assembly, inputs)
    C, D = output_matrices(drivetrain.assembly, present.readings(drivetrain), inputs, form)
    return StateSpace(form.A, form.B, C, D, form.states)


@dataclass(frozen=True)
class ActiveChannels:
    """Inputs and sensors by name that act in the present configuration of a drivetrain."""

    inputs: dict[str, Input]
    sensors: dict[str, Sensor]

    def readings(self, drivetrain: AssembledModel) -> tuple[Functional, ...]:
        """Readings of the active sensors in their order, as linear expressions of motion and applied torques."""
        return tuple(functional(drivetrain, sensor, name) for name, sensor in self.sensors.items())


def active_channels(drivetrain: AssembledModel) -> ActiveChannels:
    """Inputs and sensors of a drivetrain by name, without those on parts that are switched off or locked."""
    inputs, sensors = usable_channels(drivetrain)
    return ActiveChannels(
        {name: drivetrain.inputs[name] for name in inputs}, {name: drivetrain.sensors[name] for name in sensors}
    )


def _way_out(system: RowSystem) -> str:
    continuous = any(law.is_continuous for _, law in system.dynamic)
    return "; a shaft with segments has one" if continuous else ""


def first_order(
    assembly: Assembly,
    inputs: Sequence[Input],
    points: int = 0,
    *,
    closing: Sequence[LawStates] | None = None,
    opened: Sequence[LawStates] = (),
) -> StateSpaceForm:
    """State equations of an assembly in SI units under torques on nodes, with each delay as a line of ``points``.

    See :mod:`.action_states` for the line.

    With ``closing``, only these actions act, and the torques of those ``opened`` are inputs after the others.

    Raises
    ------
    UsageError
        Frequency-dependent laws, an imposed angle or a delay without points.
    """
    system = assembly.system
    if system.dynamic:
        names = ", ".join(sorted({assembly.owners[index] for index, _ in system.dynamic}))
        raise UsageError(
            f"{names}: a stiffness that depends on frequency has no state space{_way_out(system)}",
            kind="unsupported-law",
        )
    if any(channel.quantity != "torque" for channel in inputs):
        raise UsageError(
            "an imposed angle has no state space with torque inputs; make it a torque, or use frequency_response",
            kind="unsupported-law",
        )
    # Columns of B: torques on rows of nodes, and after them those of actions, whose loops are closed last.
    loads = [assembly.rows_of(channel.row)[0] for channel in inputs]
    actions = law_states(assembly, points) if closing is None else closing
    loads += [action.row for action in (*opened, *actions)]
    # Motions with inertia have two states, those with dampers alone one, the others follow at once.
    kinds = motion_kinds(system)
    columns = np.array(loads).reshape(len(loads), system.n_coordinates).T
    states = _state_names(assembly.kinematics.coordinates, kinds[0], kinds[1])
    try:
        form = condensed(reduced_matrices(system, actions, kinds), *kinds, columns, states)
    except np.linalg.LinAlgError:
        raise UsageError(
            "the torques that follow the motion leave no unique motion of what has no inertia; "
            "give its nodes inertia or dampers",
            kind="unsupported-law",
        ) from None
    return close_loops_in_states(form, actions) if actions else form


def reduced_matrices(
    system: RowSystem, actions: Sequence[LawStates], kinds: tuple[FloatArray, FloatArray, FloatArray]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Matrices M, C and K (n_q, n_q) in kg m^2, N m s/rad and N m/rad, less what actions feed through at once.

    Raises
    ------
    UsageError
        An action follows, or drives, rates of a coordinate that has none in the laws.
    """
    matrices = [system.K, system.C, system.M]
    _, damped, static = kinds
    # A torque that follows a rate at once needs a damper there, one that follows an acceleration an inertia.
    for power, without in ((1, static), (2, np.hstack([damped, static]))):
        for action in actions:
            touched = max(float(np.abs(row @ without).max(initial=0.0)) for row in (action.row, action.sensed))
            if action.at_once[power] and touched > NEGLIGIBLE_COEFFICIENT:
                what = "inertia" if power == HIGHEST_POWER else "inertia or damper"
                raise UsageError(
                    f"{action.action.owner} acts at once on a rate where there is no {what}; give it a filter",
                    kind="unsupported-law",
                )
    # An action drives by the factor at_once[p] times s^p y, which leaves the matrix of that power: K, C or M.
    for action in actions:
        dyad = np.outer(action.row, action.sensed)
        matrices = [matrix - value * dyad for matrix, value in zip(matrices, action.at_once, strict=True)]
    return matrices[2], matrices[1], matrices[0]


def close_loops_in_states(form: StateSpaceForm, actions: Sequence[LawStates]) -> StateSpaceForm:
    """State equations with controllers at work, from those in which their torques are the last inputs."""
    n_act, n_x = len(actions), len(form.A)
    n_u = form.B.shape[1] - n_act
    sizes = np.cumsum([0, *(len(action.F) for action in actions)])
    n_z = int(sizes[-1])
    F, G, H = np.zeros((n_z, n_z)), np.zeros((2, n_z, n_act)), np.zeros((n_act, n_z))
    for number, action in enumerate(actions):
        own = slice(sizes[number], sizes[number + 1])
        F[own, own], H[number, own] = action.F, action.H
        G[0, own, number], G[1, own, number] = action.G.T
    sensed = np.array([action.sensed for action in actions])
    Y, Y_in = sensed @ form.X, sensed @ form.U
    if np.abs(np.abs(G[1]) @ np.abs(Y_in)).any():
        names = ", ".join(dict.fromkeys(action.action.owner for action in actions))
        raise UsageError(
            f"{names}: the rate of what has neither inertia nor damper follows the rate of a torque",
            kind="unsupported-law",
        )
    (B, B_act), (Y_u, Y_act) = (np.split(part, [n_u], axis=1) for part in (form.B, Y_in))
    # z' = F z + G_0 y + G_1 y' with y = Y x + Y_u u + Y_act H z, and y' = Y x' where G_1 asks for it.
    A = np.block([
        [form.A, B_act @ H],
        [G[0] @ Y + G[1] @ Y @ form.A, F + G[0] @ Y_act @ H + G[1] @ Y @ B_act @ H],
    ])  # fmt: skip
    inputs = np.vstack([B, G[0] @ Y_u + G[1] @ Y @ B])
    X = np.hstack([form.X, form.U[:, n_u:] @ H])
    names_of = [f"state {place + 1} of {action.action.owner}" for action in actions for place in range(len(action.F))]
    torques = np.hstack([np.zeros((n_act, n_x)), H])
    closed = replace(form, A=A, B=inputs, X=X, U=form.U[:, :n_u], states=(*form.states, *names_of))
    return replace(closed, actions=tuple(actions), torques=torques)


def _state_names(coordinates: Sequence[str], heavy: FloatArray, damped: FloatArray) -> tuple[str, ...]:
    """Names of the states, as angle or velocity of a coordinate, or with a number for a combined motion."""

    def named(basis: FloatArray, what: str) -> list[str]:
        columns = [np.flatnonzero(column) for column in basis.T]
        return [
            f"{what}({coordinates[held[0]]})" if len(held) == 1 else f"{what} of motion {number}"
            for number, held in enumerate(columns, 1)
        ]

    return (*named(heavy, "angle"), *named(heavy, "velocity"), *named(damped, "angle"))


def motion_kinds(system: RowSystem) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Bases (n_q, n) of the motions with inertia, of the massless damped ones and of the static ones."""
    heavy = system.inertia != 0
    massless, static = (unresisted_motions(system, laws).basis() for laws in (heavy, heavy | (system.damping != 0)))
    return (
        _upright(complement_within(massless, np.eye(system.n_coordinates))),
        _upright(complement_within(static, massless)),
        static,
    )


def _upright(basis: FloatArray) -> FloatArray:
    """Basis (n_q, n) of motions in which the largest entry of each column is made positive."""
    largest = np.abs(basis).argmax(axis=0) if basis.size else np.zeros(0, dtype=int)
    return np.asarray(basis * np.where(basis[largest, np.arange(len(largest))] < 0, -1.0, 1.0))


def condensed(
    matrices: tuple[FloatArray, FloatArray, FloatArray], heavy: FloatArray, damped: FloatArray, static: FloatArray,
    loads: FloatArray, names: tuple[str, ...],
) -> StateSpaceForm:  # fmt: skip
    M, C, K = matrices
    # Static motions S d follow at once: S^T K (q + S d) = S^T f.
    hold = np.linalg.solve(static.T @ K @ static, static.T) if static.shape[1] else np.zeros((0, len(K)))
    n_a, n_b = heavy.shape[1], damped.shape[1]
    X = np.hstack([heavy, np.zeros((len(K), n_a)), damped])
    U = static @ hold @ loads
    X = X - static @ hold @ K @ X
    a, v, b = slice(0, n_a), slice(n_a, 2 * n_a), slice(2 * n_a, None)
    A, B = np.zeros((2 * n_a + n_b, 2 * n_a + n_b)), np.zeros((2 * n_a + n_b, loads.shape[1]))
    A[a, v] = np.eye(n_a)
    if n_b:
        # D^T C (D b' + H v) + D^T K q = D^T f over the massless damped motions D.
        slip = np.linalg.inv(damped.T @ C @ damped)
        A[b] = -slip @ damped.T @ K @ X
        A[b, v] -= slip @ damped.T @ C @ heavy
        B[b] = slip @ damped.T @ (loads - K @ U)
    # H^T M H v' = H^T (f - K q - C (H v + D b')) over the motions H with inertia.
    weight = np.linalg.inv(heavy.T @ M @ heavy)
    drag = heavy.T @ C
    A[v] = -weight @ (heavy.T @ K @ X + drag @ damped @ A[b])
    A[v, v] -= weight @ drag @ heavy
    B[v] = weight @ (heavy.T @ (loads - K @ U) - drag @ damped @ B[b])
    return StateSpaceForm(A, B, X, U, names)


def output_matrices(
    assembly: Assembly,
    readings: Sequence[Functional],
    inputs: Sequence[Input],
    system: StateSpaceForm,
    opened: Sequence[LawStates] = (),
) -> tuple[FloatArray, FloatArray]:
    """Matrices C (n_out, n_x) and D (n_out, n_in) from states and torques in N m to readings in SI units.

    The coefficients of u' and u'' have to vanish.

    The torques of the actions ``opened`` are inputs after the others.

    Raises
    ------
    UsageError
        They do not.
    """
    C, D = np.zeros((len(readings), len(system.A))), np.zeros((len(readings), len(inputs) + len(opened)))
    for number, reading in enumerate(readings):
        direct = [float(reading.direct(channel.row)) for channel in inputs]
        direct += [action_share(assembly, reading, action) for action in opened]
        C[number], D[number] = _output_rows(assembly, reading, np.array(direct), system)
    return C, D


def _output_rows(
    assembly: Assembly, reading: Functional, direct: FloatArray, system: StateSpaceForm
) -> tuple[FloatArray, FloatArray]:
    C = np.zeros(len(system.A))
    D = direct.astype(float)
    rates = np.zeros((2, len(direct)))
    sizes = np.zeros(2)
    motions: list[tuple[float, FloatArray, Any]] = [
        (float(term.factor), term.row, powers_of_s(assembly, term)) for term in reading.terms
    ]
    for number, action in enumerate(system.actions):
        weight = action_share(assembly, reading, action)
        motions.append((weight, action.sensed, action.at_once))
        C += weight * system.torques[number]
    for gain, row, powers in motions:
        # p_0 + p_1 s + p_2 s^2 of the motion X x + U u, with s x = A x + B u.
        x, u = row @ system.X, row @ system.U
        factors = [float(factor) for factor in powers]
        states, loads = (x, x @ system.A, x @ system.A @ system.A), (u, x @ system.B, x @ system.A @ system.B)
        for factor, state, load in zip(factors, states, loads, strict=True):
            C += gain * factor * state
            D = D + gain * factor * load
        # What is left of u' and u''.
        improper = (factors[1] * u + factors[2] * (x @ system.B), factors[2] * u)
        for order, part in enumerate(improper):
            rates[order] += gain * part
            sizes[order] += float(np.abs(gain * part).max(initial=0.0))
    if np.any(np.abs(rates) > NEGLIGIBLE_COEFFICIENT * np.maximum(sizes, 1e-300)[:, None]):
        raise UsageError(
            f"{reading.name} contains the rate of change of an input; it has a frequency response but no state space",
            kind="unsupported-law",
        )
    return C, D


def action_share(assembly: Assembly, reading: Functional, action: LawStates) -> float:
    """Factor of an action's torque in a reading, as it is read itself or applied to nodes that are read."""
    nodes = action.action.nodes.items()
    applied = sum((share * reading.applied.get(node, 0) for node, share in nodes), start=Fraction(0))
    number = next(place for place, law in enumerate(assembly.system.actions) if law is action.action)
    return float(reading.actions.get(number, 0) + applied)

"""Mean torques and twists of a drivetrain, from its stiffness and the torques from outside.

Only stiffness counts, its real part at 0 Hz where it depends on frequency: at steady speed inertias and dampers take no
mean torque, and controllers act by angles, not by rates. Motions that no spring resists are held at one node each. The
torque on that node is what the outside torques leave over, which is zero where they are in balance.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.packages import SavedResult
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import Functional, LawStiffness, functional, law_stiffness
from torsionnet.linear.assembly.rows import refuse_actions
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.linear.dynamic_stiffness.quotient import transfer_functions
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, resolve_request
from torsionnet.linear.frequency_response import Channel, FloatArray
from torsionnet.linear.responses.shared_response import shared_by_conditions
from torsionnet.machinery.mean.secants import SlippingLaw, slipping_torques, with_secants
from torsionnet.machinery.orders.operating_groups import (
    SpeedIndices,
    batch_over_speeds,
    blocks_of_speeds,
    drivetrains_at_speeds,
)
from torsionnet.model.channels import Channels, Input, Sensor
from torsionnet.model.checks.structure import rigid_motions
from torsionnet.model.definition import with_tangents
from torsionnet.model.elements import Constraint, Element, Part, Values
from torsionnet.model.kinematics import free_motions
from torsionnet.model.load.external_torques import UNBALANCED_SHARE, stated_torques
from torsionnet.model.load.lost_torques import with_all_working
from torsionnet.model.readings import port_of, referring_factor
from torsionnet.model.speeds import mean_speeds

# Mean response of a drivetrain to the mean torques of running machinery, over speed.


@dataclass(frozen=True, eq=False, repr=False)
class MeanResponse(SavedResult):
    """Mean values of outputs (torques, twists, stresses) in SI units over speed, shape (n_speeds, n_out).

    Attributes
    ----------
    speeds : (n_speeds,) array
        Speeds of the reference shaft, rad/s.
    reference : str
        Node of the reference shaft.
    values : (n_speeds, n_out) array
        Mean values, SI.
    outputs : tuple of Channel
    title : str
        Name of the model with its configuration.
    notes : tuple of str
        Remarks on what the values are based on.
    """

    speeds: FloatArray
    reference: str
    values: FloatArray
    outputs: tuple[Channel, ...]
    title: str = ""
    notes: tuple[str, ...] = ()

    @property
    def rpm(self) -> FloatArray:
        """Speeds of the reference shaft in r/min, shape (n_speeds,)."""
        return np.asarray(self.speeds * RPM)

    def of(self, output: str) -> FloatArray:
        """Mean values of an output in SI units over speed, shape (n_speeds,).

        Raises
        ------
        UsageError
            There is no such output.
        """
        names = [channel.name for channel in self.outputs]
        if output not in names:
            raise UsageError(
                f'no output is named "{output}"{did_you_mean(output, names)}; there are {", ".join(names)}',
                kind="unknown-channel",
            )
        return np.asarray(self.values[:, names.index(output)])

    def table(self, conventions: Conventions = SI) -> Table:
        """Table of mean values with a row for each speed in rpm and a column for each output."""
        columns = [Column("speed", "rpm")]
        columns += [Column(channel.name, conventions.unit(channel.unit)) for channel in self.outputs]
        scales = np.array([conventions.scale(channel.unit) for channel in self.outputs])
        rows = zip(self.rpm.tolist(), (self.values * scales).tolist(), strict=True)
        notes = (f"mean values; speeds of {self.reference}", *self.notes)
        return Table(f"{self.title}: mean values", tuple(columns), tuple((rpm, *row) for rpm, row in rows), notes)


SUM_ROUNDING = 1e-13
"""Size of a sum of mean torques, over the sizes of its terms, below which the sum is rounding and counts as 0."""
LOST_POWER = "cylinders that work keep their pressures, what is lost is not made up for"
"""Rule, in words, by which the mean torque of a condition with a cylinder lost follows from that with all working."""
SHARE_SHOWN = 5e-4
"""Smallest difference of a share of power from 1 that three digits in per cent show."""
HELD_BYTES = 1_000_000
"""Size in bytes at which a kept drivetrain with its assembly is counted against the memory limit, with a margin."""


def mean_response(
    drivetrain: AssembledModel,
    output: Channels,
    speeds: ArrayLike | None = None,
) -> MeanResponse:
    """Mean torques and twists of running machinery under its load, over speed.

    Springs hand mean torques on; dampers stand for vibration and take none. Drivers act in the direction of
    rotation, absorbers against it, and the reference node of the speeds turns in the positive sense.

    Parameters
    ----------
    output : str, Sensor or sequence of these
        As for :meth:`frequency_response`, but nothing that turns freely: a torque or a twist.
    speeds : (n_speeds,) array, optional
        rad/s, of the node of the model's ``speeds:``; default: those of the model.

    Returns
    -------
    MeanResponse
        ``values`` of shape (n_speeds, n_out).

    Raises
    ------
    UsageError
        Unknown names, no load and no torques at the operating point, torques that are not in balance, a speed
        outside a table, or an output that mean torques do not determine.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("engine", node="e", inertia=2), tn.Inertia("screw", node="p", inertia=1),
    ...     tn.Spring("shaft", nodes=("e", "p"), stiffness=1e6)]
    >>> boat = tn.Drivetrain("boat", elements, speeds={"of": "e", "list": [50, 100], "rated": 100},
    ...     load={"absorbed_at": "p", "power": "100 kW", "torque_exponent": 2, "driven_by": {"e": 1}})
    >>> boat.mean_response("torque(shaft)").values.round(6).tolist()
    [[250.0], [1000.0]]
    """
    return means_of(drivetrain, output, speeds)


def means_of(
    drivetrain: AssembledModel, outputs: Channels, speeds: ArrayLike | None, *, all_working: bool = False
) -> MeanResponse:
    """Mean response of a drivetrain in its condition, or with ``all_working`` as if no cylinder were lost."""
    reference, at, torques = external_torques(drivetrain, speeds, all_working=all_working)
    tangents = drivetrain.definition.tangents
    if tangents is not None and tangents.is_loaded:
        if all_working:
            # The laws carry the torques of their own operating point, so that this has to have all cylinders, too.
            drivetrain = drivetrain.with_definition(with_tangents(with_all_working(drivetrain.definition)))
        return mean_response_of_laws(drivetrain, outputs, reference, at)
    return _mean_response(drivetrain, outputs, (reference, at, torques), all_working=all_working)


def mean_response_of_laws(
    drivetrain: AssembledModel, outputs: Channels, reference: str, speeds: FloatArray
) -> MeanResponse:
    """Mean torques, twists or stresses of a drivetrain with laws of motion in SI units, at speeds (n_speeds,) in rad/s.

    At every speed laws of motion are springs that carry their mean torques at their mean twists.
    """
    means: list[MeanResponse] = []
    groups = drivetrains_at_speeds(drivetrain, reference, speeds, apart=True)
    for rig, places in groups:
        tangents = rig.definition.tangents
        assert tangents is not None
        state, values = tangents.state, Values(rig.exact_values)
        plain = rig.with_definition(with_secants(rig.definition, state))
        slipping = list(slipping_torques(rig.definition.switched_on, values, state))
        torques = {node: np.full(len(places), torque) for node, torque in state.acting.items()}
        mean = _mean_response(plain, outputs, (reference, speeds[places], torques), all_working=True)
        own = [
            sum(_slip_reading(rig, output.sensor, slip) for slip in slipping)
            for output in resolve_request(rig, outputs, list(torques)[:1], None).outputs
        ]
        notes = tuple(dict.fromkeys((*mean.notes, *state.notes)))
        means.append(replace(mean, values=mean.values + np.array(own), title=drivetrain.title, notes=notes))
    of_all = np.concatenate([part.values for part in means])
    notes = (*lost_power_notes(drivetrain, float(speeds[-1])), *(note for part in means for note in part.notes))
    notes = tuple(dict.fromkeys(notes))
    return replace(means[0], speeds=speeds, values=of_all, notes=notes)


def _slip_reading(rig: AssembledModel, sensor: Sensor | None, slipping: SlippingLaw) -> float:
    """Share of the torque of a law that slips in the reading of a sensor, in N m."""
    if sensor is None or sensor.quantity != "torque" or sensor.of != slipping.owner:
        return 0.0
    # The slipping law acts on the port by its coefficient there; the sensor may refer that to another shaft.
    node, sign = port_of(rig.elements[sensor.of], sensor.at)
    factor = referring_factor(sensor, rig.elements, Values(rig.exact_values)) if sensor.referred_to else 1
    return float(sign * factor * slipping.law.row.get(node, 0)) * slipping.torque


def _mean_response(
    drivetrain: AssembledModel,
    outputs: Channels,
    operation: tuple[str, FloatArray, Mapping[str, FloatArray]],
    *,
    all_working: bool,
) -> MeanResponse:
    """Mean response of a linear drivetrain from the reference node, its speeds (n_speeds,) and torques by node."""
    reference, at, torques = operation
    nodes = [node for node in torques if node in drivetrain.nodes]
    if not nodes:
        raise UsageError(
            f"mean torques act on {', '.join(torques)}, to which nothing is attached in this configuration; "
            "choose a configuration in which they are attached",
            kind="no-ratio",
        )
    wanted = resolve_request(drivetrain, outputs, nodes, None).outputs
    _require_determined(drivetrain, wanted)
    acting = np.array([torques[node] for node in nodes]).T
    # A clamp for each free motion makes K regular at rest; torques in balance leave nothing in the clamps.
    held = shared_by_conditions(drivetrain, AssembledModel, "held", lambda: _held(drivetrain), lambda _: HELD_BYTES)
    values, left_over = np.zeros((len(at), len(wanted))), np.zeros((len(at), len(_held_in(held))))
    solved = shared_by_conditions(
        drivetrain,
        tuple,
        (reference, at.tobytes(), tuple(output.sensor for output in wanted), tuple(nodes)),
        lambda: tuple(_static_readings(held, reference, at, wanted, nodes)),
        lambda blocks: sum(per_torque.nbytes for per_torque, _ in blocks),
    )
    for per_torque, places in solved:
        torques_there = acting[places, None, :]
        # Superposition: reading = sum_n (reading per N m on node n) T_n, and the sum of magnitudes to judge what
        # cancels.
        readings = (torques_there * per_torque).sum(axis=2)
        sizes = (np.abs(torques_there) * np.abs(per_torque)).sum(axis=2)
        readings = np.where(np.abs(readings) > SUM_ROUNDING * sizes, readings, 0.0)
        values[places], left_over[places] = readings[:, : len(wanted)], readings[:, len(wanted) :]
        _require_balance(readings[:, len(wanted) :], sizes[:, len(wanted) :])
    channels = tuple(output.channel for output in wanted)
    lost = () if all_working else lost_power_notes(drivetrain, float(at[-1]))
    notes = (*_rest(drivetrain, left_over), *lost, *range_notes(drivetrain.assembly, [0.0]))
    return MeanResponse(at, reference, values, channels, drivetrain.title, notes)


def lost_power_notes(drivetrain: AssembledModel, speed: float) -> tuple[str, ...]:
    """Note on the share of the load that is left at a speed in rad/s with cylinders lost, or nothing."""
    kept = drivetrain.external_torques.kept_power(speed)
    if math.isclose(kept, 1.0, abs_tol=SHARE_SHOWN):
        return ()
    return (f"{LOST_POWER}: {100 * kept:.3g} % of the mean torque with all working",)


def _static_readings(
    held: AssembledModel, reference: str, at: FloatArray, wanted: Sequence[Functional], nodes: Sequence[str]
) -> Iterator[tuple[FloatArray, SpeedIndices]]:
    """Yield readings in SI units per N m on a node (n, n_readings, n_nodes), and indices of their speeds."""
    everywhere = np.arange(len(at))
    if held.definition.load is None:  # the one speed at which the parameters have their values already
        groups: Iterable[tuple[AssembledModel, SpeedIndices]] = [(held, everywhere)]
    else:
        batch = batch_over_speeds(held, reference, at)
        if batch is not None and not batch.moduli:
            _refuse_actions(held)
            yield _per_torque(batch.law_stiffness(np.zeros(1)), _static_request(held, wanted, nodes)), everywhere
            return
        groups = drivetrains_at_speeds(held, reference, at)
    for rigs, places in blocks_of_speeds(groups):
        for rig in rigs:
            _refuse_actions(rig)
        kappa = law_stiffness([rig.assembly.system for rig in rigs], np.zeros(1))
        yield _per_torque(kappa, _static_request(rigs[0], wanted, nodes)), places


def external_torques(
    drivetrain: AssembledModel, speeds: ArrayLike | None, *, all_working: bool = False
) -> tuple[str, FloatArray, Mapping[str, FloatArray]]:
    """Name of the reference node, its speeds (n_speeds,) in rad/s, and outside torques (n_speeds,) by node in N m.

    Those of the condition, or ``all_working`` as if no cylinder were lost.
    """
    definition = drivetrain.definition
    external = drivetrain.external_torques
    if definition.load is None:
        return _stated(drivetrain, speeds, external.reference)
    if speeds is None:
        at = np.array(definition.speeds.values if definition.speeds else (external.operating_speed,))
    else:
        at = np.atleast_1d(np.asarray(speeds, dtype=float))
    if at.ndim != 1 or not len(at) or not np.isfinite(at).all() or (at <= 0).any():
        raise UsageError("speeds are finite numbers above 0, in rad/s", kind="out-of-range")
    every: list[float] = at.tolist()
    by_speed = [external.at(speed) for speed in every] if all_working else external.in_condition(every)
    return external.reference, at, {node: np.array([torques[node] for torques in by_speed]) for node in by_speed[0]}


def _stated(
    drivetrain: AssembledModel, speeds: ArrayLike | None, reference: str
) -> tuple[str, FloatArray, Mapping[str, FloatArray]]:
    """Name of the reference node, its speed (1,) in rad/s and torques (1,) in N m by node, at the operating point.

    There is no other speed.
    """
    definition, values = drivetrain.definition, drivetrain.exact_values
    torques = {node: torque for node, torque in stated_torques(definition, values).items() if torque}
    if not torques:
        raise UsageError(
            "no mean torques are given; give load: {absorbed_at: node, power: 3000 kW, torque_exponent: 2}",
            kind="missing-entry",
        )
    if speeds is not None:
        raise UsageError(
            "without an entry load: mean torques are known at the operating point only; leave out speeds",
            kind="missing-entry",
        )
    turning = mean_speeds(definition, values)
    if not turning.get(reference):
        reference = next(iter(definition.operating_point.speed), next(iter(torques)))
    acting = {node: np.array([torque]) for node, torque in torques.items()}
    return reference, np.array([turning.get(reference, 0.0)]), acting


def _require_determined(drivetrain: AssembledModel, outputs: Sequence[Functional]) -> None:
    """Raise UsageError for readings that mean torques do not determine, such as angles of a free drivetrain."""
    for output in outputs:
        reason = reason_undetermined(drivetrain, output)
        if reason:
            raise UsageError(
                f"{output.name} has no mean value: {reason}; ask for a torque or a twist", kind="unfit-channel"
            )


def reason_undetermined(drivetrain: AssembledModel, output: Functional) -> str | None:
    """Reason in words why mean torques do not determine a reading, or None where they do."""
    motions = [term for term in output.terms if term.law is None]
    if any(term.power for term in motions):
        return "torques do not determine it"
    left = free_motions(drivetrain.assembly.kinematics, lambda law: law.holds_at_rest)
    return "the drivetrain turns freely there" if any(left.reduced(dict(term.exact)) for term in motions) else None


def _held(drivetrain: AssembledModel) -> AssembledModel:
    """Copy of a drivetrain in which one node is clamped for each motion that no spring resists."""
    definition = drivetrain.definition
    holders = _holders(definition.elements, rigid_motions(drivetrain.assembly.kinematics))
    elements = {**definition.elements, **{holder.name: holder for holder in holders}}
    return drivetrain.with_definition(replace(definition, elements=elements))


def _static_request(held: AssembledModel, outputs: Sequence[Functional], nodes: Sequence[str]) -> TransferRequest:
    """Request for responses per torque on each node, of the outputs and then of torques on clamped nodes.

    It is made once for all speeds asked for, as its plan of elimination takes longer than a solution at rest.
    """
    sensors = [output.sensor for output in outputs if output.sensor]
    sensors += [Sensor("torque", name) for name in _held_in(held)]

    def asked() -> TransferRequest:
        readings = tuple(functional(held, sensor) for sensor in sensors)
        excitations = tuple(Input("torque", node) for node in nodes)
        return TransferRequest(readings, (), excitations, is_measured=False, assembly=held.assembly)

    question = ("at rest", tuple(sensors), tuple(nodes))
    return shared_by_conditions(held, TransferRequest, question, asked, lambda _: HELD_BYTES)


def _held_in(held: AssembledModel) -> list[str]:
    return [name for name, element in held.elements.items() if isinstance(element, _Holder)]


def _refuse_actions(rig: AssembledModel) -> None:
    refuse_actions([action for action in rig.assembly.system.actions if action.acts_at_rest], "mean torques are")


def _per_torque(kappa: LawStiffness, request: TransferRequest) -> FloatArray:
    """Readings (n_variants, n_readings, n_nodes) in SI units at 0 Hz, per N m on a node.

    Variants of equal stiffness are solved once.
    """
    resting = _at_rest(kappa)
    # K q = f at 0 Hz depends on the stiffness alone.
    _, first, which = np.unique(resting.stiffness, axis=0, return_index=True, return_inverse=True)
    responses = transfer_functions(request, resting.variants(first), "graph")
    return np.asarray(responses.values.real[which.ravel()])


@dataclass(frozen=True, eq=False, repr=False)
class _Holder(Element):
    """Clamp on any node of a drivetrain, also on an inner node of an element."""

    held: str = field(kw_only=True)

    @property
    def ports(self) -> dict[str, str]:
        return {"node": self.held}

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        del value
        return (Constraint({self.held: 1}),)


def _holders(elements: Mapping[str, Element], nodes: Sequence[str]) -> list[_Holder]:
    """Clamps on the nodes, under names that no element has."""
    word = "held"
    while any(name.startswith(word) for name in elements):
        word += "_"
    return [_Holder(f"{word}{number}", held=node) for number, node in enumerate(nodes)]


def _at_rest(kappa: LawStiffness) -> LawStiffness:
    """Copy of the stiffnesses (n_variants, n_laws) at 0 Hz, real and in N m/rad, without inertias and dampers."""
    stiffness = kappa.stiffness.copy()
    for law, values in kappa.sampled:
        stiffness[:, law] += values[:, 0].real
    nothing = np.zeros_like(stiffness)
    resting = tuple(np.zeros_like(values) for values in kappa.actions)
    return LawStiffness(nothing, nothing, stiffness, kappa.omega, actions=resting)


def _require_balance(left_over: FloatArray, sizes: FloatArray) -> None:
    """Raise UsageError for mean torques (N m) out of balance by more than rounded figures explain.

    The ``sizes`` are sums of their magnitudes.
    """
    over = np.abs(left_over) > UNBALANCED_SHARE * sizes
    if over.any():
        text = f"the mean torques leave {np.abs(left_over[over]).max():.4g} N*m over"
        raise UsageError(f"{text}; a drivetrain that turns freely needs torques in balance", kind="unbalanced-torques")


def _rest(drivetrain: AssembledModel, left_over: FloatArray) -> tuple[str, ...]:
    """Note, if needed, on the mean torque in N m that rounded figures leave over, and at which nodes it is taken."""
    largest = np.abs(left_over).max(initial=0.0)
    if not largest:
        return ()
    nodes = ", ".join(rigid_motions(drivetrain.assembly.kinematics))
    return (f"the mean torques leave {largest:.4g} N*m over, taken at {nodes}",)

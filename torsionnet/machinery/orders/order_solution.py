"""Torsional vibration by orders, receptances at the frequencies of all order lines times their amplitudes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError, suggestion_or
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.linear.batch.batch import Batch
from torsionnet.linear.batch.batched_responses import responses_at_own_frequencies
from torsionnet.linear.dynamic_stiffness.response_problem import law_of_imposed_twist
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, cached_request, stress_section_moduli
from torsionnet.linear.frequency_response import Channel, FloatArray
from torsionnet.linear.responses.shared_response import named, shared_by_conditions, shared_response
from torsionnet.linear.responses.transfer import evaluate, warn_infinite
from torsionnet.machinery.excitations import OrderExcitation, OrderTorques
from torsionnet.machinery.excitations.reciprocating_engine import unlocked_engines
from torsionnet.machinery.orders.operating_groups import (
    SPEEDS_PER_BLOCK,
    IteratedValues,
    batch_over_speeds,
    blocks_of_speeds,
    cached_locking_clamp,
    cached_total_ratio,
    drivetrains_at_speeds,
    values_by_vibration,
)
from torsionnet.machinery.orders.order_line import OrderLine
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.worst_case import Contributions, contributions, worst_case
from torsionnet.machinery.orders.worst_response import join_responses
from torsionnet.model.channels import Channels, Input, Sensor, named_nodes
from torsionnet.model.operating_values import running_notes

ZERO_FREQUENCY = 1e-9
"""Frequency of an order line, over its part that follows the speed, below which the line stands at 0 Hz.

Slip at synchronous speed is the difference of two equal frequencies, of which rounding leaves some 1e-16.
"""


def orders_at_speeds(
    drivetrain: AssembledModel,
    outputs: Channels,
    *,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitations: Iterable[str] | None = None,
) -> OrderResponse:
    """Complex amplitudes of outputs over speed for every order line of the excitations of a drivetrain.

    At the given speeds alone; :meth:`torsionnet.Drivetrain.order_response` may add some.
    """
    request = OrderRequest.of(drivetrain, speeds, speed_of, excitations)
    response = _responses(request, outputs, settled_values(request))
    # Laws given by tables over frequency are read at every line frequency, which the tables may not cover.
    read = range_notes(drivetrain.assembly, np.abs(response.frequencies))
    notes = (*running_notes(drivetrain.definition), *read)
    return replace(response, notes=notes) if notes else response


def settled_values(request: OrderRequest) -> IteratedValues:
    """Values (n_speeds,) in SI units of the parameters that depend on vibration, at the speeds of an order request."""

    def vibration(elements: Sequence[str], settled: IteratedValues) -> FloatArray:
        # A law that follows the vibration means the half range of the sum of all orders, not that of one order.
        return _responses(request, [Sensor("torque", name) for name in elements], settled).half_range

    return values_by_vibration(request.drivetrain.definition, request.speeds, vibration)


def _responses(request: OrderRequest, wanted: Any, settled: IteratedValues) -> OrderResponse:
    """Order response at the speeds of a request, with the parameters that depend on vibration given."""
    at, title = request.speeds, request.drivetrain.title
    batch = batch_over_speeds(request.drivetrain, request.reference, at, settled)
    if batch is not None:
        parts = [
            np.arange(start, min(start + SPEEDS_PER_BLOCK, len(at))) for start in range(0, len(at), SPEEDS_PER_BLOCK)
        ]
        responses = [(_of_batch(batch.part(part), wanted, request.loads(at[part])), part) for part in parts]
        return join_responses(responses, at, title)
    responses = [
        (_block(rigs, wanted, request.loads(at[part])), part)
        for rigs, part in blocks_of_speeds(
            drivetrains_at_speeds(request.drivetrain, request.reference, at, settled),
            lambda rig: stress_section_moduli(rig, (wanted,)),
        )
    ]
    return join_responses(responses, at, title)


@dataclass(frozen=True, eq=False)
class OrderRequest:
    """Excitations that act on a drivetrain, with the speeds of the reference shaft at which they are examined.

    Attributes
    ----------
    drivetrain : AssembledModel
        The drivetrain with its imposed motions as inputs.
    reference : str
        Node to which the speeds belong.
    speeds : (n_speeds,) array
        rad/s.
    excitations : mapping
        Excitations by name.
    ratios : mapping
        Excitation -> revolutions of its shaft per revolution of the reference.
    senses : mapping
        Excitation -> signs with which it acts on nodes or elements, see :data:`Senses`.
    engines : mapping
        Engine -> first engine of the group with known angles, where angles between engines are not all known.
    """

    drivetrain: AssembledModel
    reference: str
    speeds: FloatArray
    excitations: Mapping[str, OrderExcitation]
    ratios: Mapping[str, Fraction]
    senses: Mapping[str, Senses]
    engines: Mapping[str, str]

    @classmethod
    def of(
        cls,
        drivetrain: AssembledModel,
        speeds: ArrayLike | None = None,
        speed_of: str | None = None,
        excitations: Iterable[str] | None = None,
    ) -> OrderRequest:
        """Order request made from the arguments of :func:`order_response`, or UsageError if it cannot be answered."""
        reference, at = _speeds(drivetrain, speeds, speed_of)
        acting = _acting(drivetrain.definition.excitations, excitations)
        for name, excitation in acting.items():
            _require_moving(drivetrain, name, excitation)
        held = with_motions_held(drivetrain, acting)
        ratios = {name: _turning(drivetrain, excitation.shaft, reference) for name, excitation in acting.items()}
        senses = {name: input_senses(held, excitation, reference) for name, excitation in acting.items()}
        engines = unlocked_engines(acting, drivetrain.definition.excitations)
        return cls(held, reference, at, acting, ratios, senses, engines)

    def loads(self, at: FloatArray) -> OrderLoads:
        """Complex amplitudes (N m or rad) and frequencies (Hz) of all order lines at speeds (n_speeds,) in rad/s."""
        acting = tuple(
            _acts(
                OrderLine(name, 0.0, abs(self.ratios[name]), engine=self.engines.get(name, "")),
                excitation,
                self.senses[name],
                # An excitation is given over the speed of its own shaft, |i| Omega.
                excitation.torques(at * abs(float(self.ratios[name]))),
            )
            for name, excitation in self.excitations.items()
        )
        lines = tuple(line for each in acting for line in each.lines)
        inputs = tuple(dict.fromkeys(channel for each in acting for channel in each.loads))
        loads = np.zeros((len(at), len(lines), len(inputs)), dtype=complex)
        first = 0
        for each in acting:
            for channel, amplitudes in each.loads.items():
                loads[:, first : first + len(each.lines), inputs.index(channel)] = amplitudes
            first += len(each.lines)
        # f = h |i| Omega/2pi + f_fixed for every line; a slip runs against the speed and may pass 0 Hz.
        turning = at[:, None] * np.array([float(line.relative) for line in lines]) / (2 * math.pi)
        hertz = turning + np.array([line.fixed for line in lines])
        hertz[np.abs(hertz) < ZERO_FREQUENCY * np.abs(turning)] = 0
        return OrderLoads(at, self.reference, acting, lines, inputs, loads, hertz)


def shaft_speeds(drivetrain: AssembledModel, excitation: str) -> tuple[float, float]:
    """Speed in rad/s of the reference shaft and that of an excitation's shaft, rated or else the highest examined."""
    given = drivetrain.definition.speeds
    reference, at = _speeds(drivetrain, None, None)
    speed = float(given.rated) if given and given.rated else float(at[-1])
    shaft = drivetrain.definition.excitations[excitation].shaft
    return speed, speed * abs(float(_turning(drivetrain, shaft, reference)))


def with_motions_held(drivetrain: AssembledModel, acting: Mapping[str, OrderExcitation]) -> AssembledModel:
    """Copy of a drivetrain in which the motions that excitations impose are inputs.

    Each response is to one motion with the others held at zero.
    """
    inputs = dict(drivetrain.inputs)
    known = {channel for channel in inputs.values() if channel.quantity == "angle"}
    for name, excitation in acting.items():
        for node in excitation.nodes if excitation.quantity == "angle" else ():
            if (channel := excitation.channel(node)) not in known:
                known.add(channel)
                inputs[_unused(f"{name} on {node}", inputs)] = channel
    if len(inputs) == len(drivetrain.inputs):
        return drivetrain
    held = drivetrain.with_definition(replace(drivetrain.definition, inputs=inputs))
    if held.assembly.kinematics.reduction.blocked:
        raise UsageError(
            "two imposed motions act on nodes that are rigidly connected; leave out one", kind="contradicting-angles"
        )
    return held


def _unused(name: str, known: Iterable[str]) -> str:
    return _unused(f"{name} too", known) if name in known else name


Senses = Mapping[str, float]
"""Factors from an excitation to its inputs, mostly +1 or -1, by the node or element on which it acts."""


def input_senses(drivetrain: AssembledModel, excitation: OrderExcitation, reference: str) -> Senses:
    """Factors from an excitation to its inputs by node or element, positive in the sense in which its shaft turns.

    Nodes that are held still are left out.
    """
    if excitation.element_entry is not None:
        name = excitation.element_entry[1]
        # The law has gamma = row @ theta: an angle e of the shaft at its end changes gamma by row[shaft] e.
        row = drivetrain.assembly.laws[law_of_imposed_twist(drivetrain.assembly, name)].row
        return {name: float(row[excitation.shaft]) * _sense(drivetrain, excitation.shaft, reference)}
    holds_row = drivetrain.assembly.kinematics.holds_row
    return {
        node: _sense(drivetrain, node, reference)
        for node in excitation.nodes
        if not holds_row(excitation.channel(node).row)
    }


def _sense(drivetrain: AssembledModel, node: str, reference: str) -> float:
    return -1.0 if cached_total_ratio(drivetrain, node, reference) < 0 else 1.0


@dataclass(frozen=True, eq=False)
class ExcitationLines:
    """Order lines of one excitation, and amplitudes (n_speeds, n_lines) by input, in N m or rad."""

    name: str
    lines: tuple[OrderLine, ...]
    loads: Mapping[Input, ComplexArray]
    torques: OrderTorques
    inputs: Mapping[str, tuple[Input, float]]
    """Input, and the sign with which a torque acts there, by node."""


def _acts(line: OrderLine, excitation: OrderExcitation, senses: Senses, torques: OrderTorques) -> ExcitationLines:
    """Order lines of an excitation and their complex amplitudes in N m or rad, made from a template ``line``.

    The template is without an order.
    """
    fixed = np.zeros(len(torques.orders)) if torques.fixed is None else torques.fixed
    pairs = zip(torques.orders.tolist(), fixed.tolist(), strict=True)
    lines = tuple(replace(line, order=order, fixed=frequency) for order, frequency in pairs)
    if not line.ratio and torques.orders.any():
        raise UsageError(
            f"{excitation.shaft} does not turn, so it has no orders; {line.excitation} can act at frequencies there",
            kind="no-effect",
        )
    columns = {place: column for column, place in enumerate(torques.nodes) if place in senses}
    inputs = {place: (excitation.channel(place), senses[place]) for place in columns}
    # Orders are positive in the sense in which their shaft turns; the sign takes them to the positive angle of the
    # node.
    loads = {channel: sense * torques.amplitudes[:, :, columns[place]] for place, (channel, sense) in inputs.items()}
    return ExcitationLines(line.excitation, lines, loads, torques, inputs)


@dataclass(frozen=True, eq=False)
class OrderLoads:
    """Complex amplitudes (N m or rad) and frequencies (Hz) of all order lines at some speeds, by input.

    Attributes
    ----------
    speeds : (n_speeds,) array
        rad/s.
    reference : str
        Node to which the speeds belong.
    by_excitation : tuple of ExcitationLines
    lines : tuple of OrderLine
    inputs : tuple of Input
    loads : (n_speeds, n_lines, n_inputs) complex array
        N m or rad.
    hertz : (n_speeds, n_lines) array
        Frequencies in Hz, negative where the vibration runs backwards in phase.
    """

    speeds: FloatArray
    reference: str
    by_excitation: tuple[ExcitationLines, ...]
    lines: tuple[OrderLine, ...]
    inputs: tuple[Input, ...]
    loads: ComplexArray
    hertz: FloatArray

    def response(self, gains: ComplexArray, channels: tuple[Channel, ...]) -> OrderResponse:
        """Order response, by superposition of unit-input responses ``gains`` (n_speeds, n_lines, n_out, n_inputs)."""
        # X = H(f) F, summed over the inputs of every line at its own frequency.
        values = np.einsum("slon,sln->slo", gains, self.loads)
        return _worst_response(
            OrderResponse(self.speeds, self.reference, self.lines, values, channels),
            self.by_excitation,
            gains,
            self.inputs,
        )

    @property
    def frequencies(self) -> FloatArray:
        """Magnitudes in Hz of the frequencies of all order lines, sorted, each once, shape (n_f,)."""
        return np.unique(np.abs(self.hertz))

    def at_lines(self, frequencies: FloatArray, values: ComplexArray) -> ComplexArray:
        """Responses (n_speeds, n_lines, ...) at each speed and order line, picked from ``values`` (n_f, ...)."""
        where = np.searchsorted(frequencies, np.abs(self.hertz))
        return _forward(values[where], self.hertz)


def _block(rigs: Sequence[AssembledModel], outputs: Channels, loads: OrderLoads) -> OrderResponse:
    """Order response at the speeds of ``loads``, from one drivetrain for all speeds or one for each speed."""
    inputs = list(loads.inputs)
    gains, channels = _gains(rigs[0], outputs, loads) if len(rigs) == 1 else _each(rigs, outputs, inputs, loads.hertz)
    return loads.response(gains, channels)


def _of_batch(batch: Batch, outputs: Channels, loads: OrderLoads) -> OrderResponse:
    """Order response at the speeds of ``loads``, from a batch that has one variant per speed."""

    def solved(request: TransferRequest, frequencies: FloatArray) -> ComplexArray:
        values = tuple((name, column.tobytes()) for name, column in batch.values.items())
        key = (named(outputs), loads.inputs, values, frequencies.shape, frequencies.tobytes())
        return shared_by_conditions(
            batch.drivetrain,
            np.ndarray,
            key,
            lambda: responses_at_own_frequencies(batch, request, frequencies),
            lambda responses: responses.nbytes,
        )

    request = cached_request(batch.drivetrain, outputs, list(loads.inputs), None)
    return loads.response(*_at_own(solved, request, loads.hertz))


def _worst_response(
    nominal: OrderResponse, acting: Sequence[ExcitationLines], gains: ComplexArray, inputs: Sequence[Input]
) -> OrderResponse:
    """Order response with the worst misfire and the worst spread between cylinders that excitations allow."""
    alternatives: list[Contributions] = []
    scatter: list[Contributions] = []
    first = 0
    for each in acting:
        lines = slice(first, first := first + len(each.lines))
        # Deviations act at the frequencies of the nominal torques, so that the same receptances serve for them.
        columns = {node: (inputs.index(channel), sense) for node, (channel, sense) in each.inputs.items()}
        for shares, those in ((each.torques.alternatives, alternatives), (each.torques.scatter, scatter)):
            if shares is not None:
                those.append(contributions(each.name, shares, gains, lines, columns))
    return worst_case(nominal, alternatives, scatter)


def _gains(
    drivetrain: AssembledModel, outputs: Channels, loads: OrderLoads
) -> tuple[ComplexArray, tuple[Channel, ...]]:
    """Responses per unit input (n_speeds, n_lines, n_out, n_inputs) at every order line, and output channels.

    A line at 0 Hz, as that of the slip at synchronous speed, has the response 0.
    """
    # D(s) is the same at all speeds: a frequency that several lines or speeds share is solved once.
    frequencies = loads.frequencies
    still = frequencies == 0
    response = shared_response(drivetrain, outputs, list(loads.inputs), frequencies[~still])
    values = np.zeros((len(frequencies), *response.values.shape[1:]), dtype=complex)
    values[~still] = response.values
    return loads.at_lines(frequencies, values), response.outputs


def _each(
    rigs: Sequence[AssembledModel],
    outputs: Channels,
    inputs: Sequence[Any],
    hertz: FloatArray,
) -> tuple[ComplexArray, tuple[Channel, ...]]:
    """Responses per unit input at every order line, as :func:`_gains` gives them, of one drivetrain per speed.

    All drivetrains have the same rows.
    """

    def solved(request: TransferRequest, frequencies: FloatArray) -> ComplexArray:
        return evaluate([rig.assembly for rig in rigs], request, frequencies).values

    return _at_own(solved, cached_request(rigs[0], outputs, inputs, None), hertz)


def _at_own(
    solved: Callable[[TransferRequest, FloatArray], ComplexArray], request: TransferRequest, hertz: FloatArray
) -> tuple[ComplexArray, tuple[Channel, ...]]:
    """Responses per unit input (n_speeds, n_lines, n_out, n_inputs) at lines whose frequencies differ by speed.

    The function ``solved`` takes Hz (n_speeds, n_f) and returns (n_speeds, n_f, n_out, n_inputs).
    """
    # Columns that are equal at every speed, as of two excitations of one order, are solved once.
    frequencies, where = np.unique(np.abs(hertz), axis=1, return_inverse=True)
    still = frequencies == 0
    frequencies[still] = 1.0  # any value: the response there is set to 0 below
    values = solved(request, frequencies)
    warn_infinite(values, np.ones(frequencies.shape), frequencies)
    values = np.where(still[:, :, None, None], 0.0, values)
    return _forward(values[:, where.ravel()], hertz), tuple(reading.channel for reading in request.outputs)


def _forward(gains: ComplexArray, hertz: FloatArray) -> ComplexArray:
    """Responses at line frequencies of either sign, conjugates of those at the magnitude where it is negative."""
    # x(t) is real: H(-omega) is the conjugate of H(omega).
    backward = hertz < 0
    if backward.any():
        gains[backward] = gains[backward].conj()
    return gains


def _require_moving(drivetrain: AssembledModel, name: str, excitation: OrderExcitation) -> None:
    """Raise UsageError for an excitation on a node or element that is locked or switched off in the drivetrain."""
    if excitation.element_entry is not None and excitation.element_entry[1] not in drivetrain.elements:
        off = f"{excitation.element_entry[1]}, which is switched off in this configuration"
        raise UsageError(f"{name} acts in {off}; leave this excitation out", kind="switched-off")
    for node in excitation.nodes:
        channel = excitation.channel(node)
        missing = next((end for end in channel.nodes if end not in drivetrain.nodes), None)
        if missing is not None:
            text = f'{name} acts on "{missing}", to which nothing is attached in this configuration'
            raise UsageError(f"{text}; leave this excitation out", kind="no-effect")
        if drivetrain.assembly.kinematics.holds_row(channel.row):
            held = f'"{node}", which is locked' if channel.against is None else f"{named_nodes(channel)}, held rigidly"
            raise UsageError(
                f"{name} acts on {held} in this configuration and causes no vibration; leave it out", kind="no-effect"
            )


def _speeds(drivetrain: AssembledModel, speeds: ArrayLike | None, speed_of: str | None) -> tuple[str, FloatArray]:
    """Name of the reference node, and its speeds (n_speeds,) in rad/s."""
    given = drivetrain.definition.speeds
    if given is None and (speeds is None or speed_of is None):
        raise UsageError(
            "the model has no entry speeds: {of: node, range: 300..800 rpm, step: 5 rpm}", kind="missing-entry"
        )
    reference = str(speed_of or (given and given.of))
    at = np.atleast_1d(np.asarray(speeds if speeds is not None else given and given.values, dtype=float))
    if at.ndim != 1 or not len(at) or not np.isfinite(at).all() or (at <= 0).any():
        raise UsageError("speeds are finite numbers above 0, in rad/s", kind="out-of-range")
    return reference, at


def _acting(known: Mapping[str, OrderExcitation], names: Iterable[str] | None) -> dict[str, OrderExcitation]:
    if not known:
        raise UsageError(
            "the model has no excitations; give its engines, propellers and meshes in its entry excitations:",
            kind="missing-entry",
        )
    enabled = [name for name, excitation in known.items() if excitation.enabled]
    chosen = enabled if names is None else [names] if isinstance(names, str) else list(names)
    if not chosen:
        raise UsageError(
            "every excitation is switched off in this configuration; name those that are to act", kind="switched-off"
        )
    for name in chosen:
        if name not in known:
            hint = suggestion_or(name, known, f"there are {', '.join(known)}")
            raise UsageError(f'no excitation is named "{name}"{hint}', kind="unknown-name")
    return {name: known[name] for name in chosen}


def _turning(drivetrain: AssembledModel, node: str, reference: str) -> Fraction:
    """Revolutions of a shaft per revolution of the reference shaft, negative if it turns the other way."""
    if node not in drivetrain.nodes:
        raise UsageError(
            f'"{node}" is not part of this configuration, so that its orders have no speed; name another shaft',
            kind="switched-off",
        )
    for shaft in dict.fromkeys((reference, node)):
        clamp = cached_locking_clamp(drivetrain, shaft)
        if clamp:
            raise UsageError(
                f"{shaft} is locked by {clamp} in this configuration: a shaft that does not turn has no orders",
                kind="no-effect",
            )
    return cached_total_ratio(drivetrain, node, reference)

"""Named outputs, inputs and excitations of a transfer function, resolved to readings or refused with the reason."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from torsionnet.base.errors import UsageError, did_you_mean, remedy
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.registers import Groups
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import Functional, functional
from torsionnet.linear.assembly.rows import Assembly
from torsionnet.linear.dynamic_stiffness.response_problem import ReadingProblem, make_reading_problem
from torsionnet.model.channels import UNITS, Input, Sensor, immobility_text, named_nodes, named_sensor, parse_pair
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.elements import GROUND, Element, Values
from torsionnet.model.kinematics import twist_fault

NO_CHANNELS_MESSAGE = "name at least one output and one input"
"""Message of the error for a request of transfer functions without outputs or without inputs."""


@dataclass(frozen=True)
class TransferRequest:
    """Outputs and inputs of transfer functions, where inputs are measured ones or the excitations themselves.

    Where none is measured, ``inputs`` are the excitations, with their names and units. ``assembly`` is one in
    which the names were looked up; others with the same rows may be asked the same.
    """

    outputs: tuple[Functional, ...]
    inputs: tuple[Functional, ...]
    excitations: tuple[Input, ...]
    is_measured: bool
    assembly: Assembly
    notes: tuple[str, ...] = ()

    @property
    def names(self) -> str:
        """Names of the measured inputs of the request, joined by "and"."""
        return " and ".join(reading.name for reading in self.inputs)

    @property
    def sensors(self) -> tuple[Sensor, ...]:
        """Sensors of the outputs, then of the measured inputs, without readings that have no sensor."""
        return tuple(reading.sensor for reading in (*self.outputs, *self.inputs) if reading.sensor is not None)

    @cached_property
    def reading_problem(self) -> ReadingProblem:
        """Equations of the request's outputs and measured inputs, with the map from their solution to each reading."""
        return make_reading_problem(
            self.assembly, self.outputs, self.inputs if self.is_measured else (), self.excitations
        )

    def with_reached_inputs(self) -> TransferRequest:
        """The request itself, if no measured input of it stays zero whatever the parameter values.

        Raises
        ------
        UsageError
            An excitation does not reach a measured input, or a measured input is reached by none.
        """
        if not self.is_measured:
            return self
        felt = [
            self.reading_problem.excitations_reaching(len(self.outputs) + number) for number in range(len(self.inputs))
        ]
        for reading, reached in zip(self.inputs, felt, strict=True):
            if not reached:
                driven = " and ".join(map(str, self.excitations))
                raise UsageError(
                    f"{reading.name} stays zero under a {driven} at every frequency; it cannot be a measured input",
                    kind="zero-reading",
                )
        for number, excitation in enumerate(self.excitations):
            if not any(number in reached for reached in felt):
                where = f"under a {excitation} at every frequency"
                raise UsageError(
                    f"{self.names} stay zero {where}; they cannot be its measured inputs", kind="zero-reading"
                )
        return self

    def dependent_inputs_error(self) -> UsageError:
        """Error to raise for measured inputs that depend on each other under the excitations at all frequencies."""
        names, driven = self.names, " and ".join(str(excitation) for excitation in self.excitations)
        if len(self.inputs) == 1:
            return UsageError(
                f"{names} stays zero under a {driven} at every frequency; it cannot be a measured input",
                kind="zero-reading",
            )
        return UsageError(
            f"{names} depend on each other under {driven}: they cannot be measured inputs together",
            kind="dependent-inputs",
        )


def cached_request(
    drivetrain: AssembledModel,
    output: str | Sensor | Sequence[str | Sensor],
    input: str | Sensor | Input | Sequence[str | Sensor | Input],
    excitation: str | Input | Sequence[str | Input] | None,
) -> TransferRequest:
    """Request of transfer functions, resolved once for all configurations with the same rows and shaft sections."""
    parts = tuple(tuple(entry) if isinstance(entry, list) else entry for entry in (output, input, excitation))
    try:
        hash(parts)
    except TypeError:  # something that is no name, to be refused in words
        return resolve_request(drivetrain, output, input, excitation).with_reached_inputs()
    key = parts, stress_section_moduli(drivetrain, (output, input))
    return drivetrain.assembly.system.memo.once(
        TransferRequest, key, lambda: resolve_request(drivetrain, output, input, excitation).with_reached_inputs()
    )


def request_for_model(drivetrain: AssembledModel, request: TransferRequest) -> TransferRequest:
    """Request of the same transfer functions for another model, such as a variant with rows of its own.

    Raises
    ------
    UsageError
        The model lacks a sensor or input of the request.
    """

    def read(known: Functional) -> Functional:
        return known if known.sensor is None else functional(drivetrain, known.sensor, known.name)

    sensors = [reading.sensor for reading in request.inputs if reading.sensor is not None]
    asked: list[Sensor | Input] = [*sensors] if request.is_measured else [*request.excitations]
    resolved = resolve_inputs(drivetrain, tuple(asked), list(request.excitations) if request.is_measured else None)
    outputs, inputs = tuple(map(read, request.outputs)), tuple(map(read, request.inputs))
    return replace(resolved, outputs=outputs, inputs=inputs, notes=request.notes).with_reached_inputs()


def stress_section_moduli(
    drivetrain: AssembledModel, entries: Iterable[str | Sensor | Input | Sequence[str | Sensor | Input]]
) -> tuple[Any, ...]:
    """Section moduli in m^3 of the shafts whose stress is requested, on which a reading depends besides the rows."""
    moduli = []
    for entry in entries:
        for channel in entry if isinstance(entry, list | tuple) else [entry]:
            sensor = named_sensor(channel, drivetrain.sensors) if isinstance(channel, str | Sensor) else None
            if sensor is not None and sensor.quantity == "stress" and sensor.of in drivetrain.elements:
                from torsionnet.model.element_base.round_section import section_modulus

                moduli.append(section_modulus(drivetrain.elements[sensor.of], Values(drivetrain.exact_values)))
    return tuple(moduli)


def resolve_request(
    drivetrain: AssembledModel,
    output: str | Sensor | Sequence[str | Sensor],
    input: str | Sensor | Input | Sequence[str | Sensor | Input],
    excitation: str | Input | Sequence[str | Input] | None,
) -> TransferRequest:
    """Request of transfer functions from the names or objects of outputs, inputs and excitation.

    Raises
    ------
    UsageError
        An unknown name, no or an ambiguous excitation, or not as many measured inputs as excitations.
    """
    outputs = named_outputs(drivetrain, output)
    return replace(resolve_inputs(drivetrain, input, excitation), outputs=outputs)


def resolve_inputs(
    drivetrain: AssembledModel,
    input: str | Sensor | Input | Sequence[str | Sensor | Input],
    excitation: str | Input | Sequence[str | Input] | None,
) -> TransferRequest:
    """Request of transfer functions with inputs and excitations resolved, and with no outputs yet.

    See :func:`resolve_request`.
    """
    entries = _listed(input, "an input", (str, Sensor, Input))
    if not entries:
        raise UsageError(NO_CHANNELS_MESSAGE, kind="missing-entry")
    resolved = [
        named_output(drivetrain, entry)
        if not isinstance(entry, Input)
        and entry not in drivetrain.inputs
        and named_sensor(entry, drivetrain.sensors) is not None
        else _named_input(drivetrain, entry, drivetrain.sensors)
        for entry in entries
    ]
    excitations = tuple(entry for entry in resolved if isinstance(entry, Input))
    measured = tuple(entry for entry in resolved if isinstance(entry, Functional))
    if not measured:
        if excitation is not None and _chosen(drivetrain, excitation) != excitations:
            raise UsageError(
                f"{remedy('driven_by=')} goes with measured inputs; here the input itself is the excitation",
                kind="wrong-count",
            )
        pairs = zip(entries, excitations, strict=True)
        inputs = tuple(Functional(str(entry), UNITS[channel.quantity], ()) for entry, channel in pairs)
        return TransferRequest((), inputs, excitations, is_measured=False, assembly=drivetrain.assembly)
    if excitations:
        unmeasured = [str(entry) for entry, at in zip(entries, resolved, strict=True) if isinstance(at, Input)]
        raise UsageError(
            f"{', '.join(unmeasured)} is an excitation and the other inputs are measured; "
            "put a sensor where the excitation acts, or name measured inputs only",
            kind="wrong-count",
        )
    # Y_out Y_in^-1 needs as many independent excitations as there are measured inputs.
    if excitation is not None:
        excitations = _chosen(drivetrain, excitation)
    elif len(drivetrain.inputs) == 1:
        excitations = (_checked_input(drivetrain, *drivetrain.inputs),)
    elif drivetrain.inputs:
        several = f"the model has several inputs; say with {remedy('driven_by=')} which one drives"
        raise UsageError(f"{several}{_known_inputs(drivetrain)}", kind="wrong-count")
    else:
        missing = "a measured input needs an excitation; declare an input in the model"
        raise UsageError(f"{missing} or name a node with {remedy('driven_by=')}", kind="wrong-count")
    if len(excitations) != len(measured):
        raise UsageError(
            f"{len(measured)} measured input(s) but {len(excitations)} excitation(s); "
            f"there must be as many of one as of the other{_known_inputs(drivetrain)}",
            kind="wrong-count",
        )
    names = joined(", ", map(str, excitations))
    notes = (phrase("measured input; excitation: {names}", names=names),)
    return TransferRequest((), measured, excitations, is_measured=True, assembly=drivetrain.assembly, notes=notes)


def _torque_on(drivetrain: AssembledModel, channel: Input) -> Input:
    """The given torque input if it acts on nodes that can move, else UsageError, as every response would be zero."""
    kinematics, where = drivetrain.assembly.kinematics, named_nodes(channel)
    same = (name for name, own in drivetrain.inputs.items() if own.quantity == "angle" and own.nodes == channel.nodes)
    if (driven := next(same, None)) is not None:
        raise UsageError(
            f"the angle of {where} is imposed by {driven}; name that input, or another node", kind="no-effect"
        )
    moved = kinematics.reduction.reduced(channel.row)
    if moved.keys().isdisjoint(kinematics.coordinates):
        held = "its motion is imposed" if moved else immobility_text(channel)
        raise UsageError(f"a torque on {where} moves nothing: {held}; put it on a node that can turn", kind="no-effect")
    return channel


def _torque_on_nodes(drivetrain: AssembledModel, name: Any) -> Input | None:
    """Torque input on the named node, or between two nodes as ``pulley-block``, or None where no node is meant."""
    if name in drivetrain.nodes:
        return _torque_on(drivetrain, Input("torque", str(name)))
    pair = parse_pair(str(name))
    if pair is None:
        return None
    for node in pair:
        if node not in (*drivetrain.nodes, GROUND):
            raise UsageError(
                f'{name}: no node is named "{node}"{did_you_mean(node, drivetrain.nodes)}', kind="unknown-node"
            )
    return _torque_on(drivetrain, Input("torque", *pair))


def _checked_input(drivetrain: AssembledModel, name: str) -> Input:
    channel = drivetrain.inputs[name]
    missing = next((node for node in channel.nodes if node not in drivetrain.nodes), None)
    if missing is not None:
        text = f'input {name} acts on node "{missing}", to which nothing is attached in this configuration'
        raise UsageError(f"{text}; choose another input, or a configuration in which it is attached", kind="no-effect")
    if drivetrain.assembly.kinematics.holds_row(channel.row):
        which = f'"{channel.of}" is locked' if channel.against is None else immobility_text(channel)
        raise UsageError(
            f"input {name} does nothing: {which} in this configuration; choose another input or configuration",
            kind="no-effect",
        )
    return channel


def _known_inputs(drivetrain: AssembledModel) -> str:
    return f": {', '.join(drivetrain.inputs)}" if drivetrain.inputs else ""


def _chosen(drivetrain: AssembledModel, excitation: str | Input | Sequence[str | Input]) -> tuple[Input, ...]:
    return tuple(_named_input(drivetrain, name) for name in _listed(excitation, "an excitation", (str, Input)))


def _named_input(drivetrain: AssembledModel, name: Any, sensors: Collection[str] = ()) -> Input:
    """Excitation of that name, on a node, or given as an object; where ``sensors`` may stand, an error names them."""
    if isinstance(name, Input):
        return _checked_excitation(drivetrain, name)
    if name in drivetrain.inputs:
        return _checked_input(drivetrain, name)
    torque = _torque_on_nodes(drivetrain, name)
    if torque is not None:
        return torque
    what, rest = "input or node", f"; inputs: {', '.join(drivetrain.inputs) or 'none'}"
    if sensors:
        what, rest = "input, sensor or node", ""
    meant = did_you_mean(str(name), [*drivetrain.inputs, *sensors, *drivetrain.nodes])
    raise UsageError(f'no {what} is named "{name}"{meant}{rest}', kind="unknown-channel")


def _checked_excitation(drivetrain: AssembledModel, channel: Input) -> Input:
    """Excitation given as an object, returned if it can act in this drivetrain, else UsageError.

    It is a torque or twist anywhere, or an imposed angle where the model declares one.
    """
    if channel.is_on_element:
        return _twist_in(drivetrain, channel)
    if channel.quantity == "torque" and set(channel.nodes) <= set(drivetrain.nodes):
        return _torque_on(drivetrain, channel)
    for name, declared in drivetrain.inputs.items():
        if channel == declared:
            return _checked_input(drivetrain, name)
    raise UsageError(
        f"the model has no {channel}; an imposed angle must stand in its entry inputs:, a torque must act on its nodes",
        kind="unknown-channel",
    )


def _twist_in(drivetrain: AssembledModel, channel: Input) -> Input:
    """The twist input itself if its element can be twisted (a compliant one), else UsageError."""
    if channel.of not in drivetrain.elements:
        raise UsageError(
            f'no element is named "{channel.of}"{did_you_mean(channel.of, drivetrain.elements)}', kind="unknown-element"
        )
    element = drivetrain.elements[channel.of]
    text = twist_fault(element, element.parts(Values(drivetrain.exact_values)))
    if text:
        raise UsageError(text, kind="not-applicable")
    return channel


def _listed(names: Any, what: str, kinds: tuple[type, ...]) -> list[Any]:
    """List of names or channels that were given singly or as a list, where other types are refused."""
    entries = [names] if isinstance(names, kinds) else list(names) if isinstance(names, list | tuple) else [None]
    for entry in entries:
        if not isinstance(entry, kinds):
            raise UsageError(f"{what} is a name or a list of names, got {names!r}", kind="wrong-form")
    return entries


def named_outputs(drivetrain: AssembledModel, output: str | Sensor | Sequence[str | Sensor]) -> tuple[Functional, ...]:
    """Readings of outputs given singly or as a list, of which there is one at least."""
    outputs = tuple(named_output(drivetrain, entry) for entry in _listed(output, "an output", (str, Sensor)))
    if not outputs:
        raise UsageError(NO_CHANNELS_MESSAGE, kind="missing-entry")
    return outputs


def named_output(drivetrain: AssembledModel, entry: str | Sensor) -> Functional:
    """Reading of an output given as sensor, sensor name or node name, as a linear expression of the motion."""
    sensor, name = named_sensor(entry, drivetrain.sensors), str(entry)
    if sensor is None and entry in drivetrain.nodes:
        sensor = Sensor("angle", name)
    if sensor is not None:
        # A node that is locked reads zero where its own name is given; a declared sensor on it is a mistake.
        on_nodes = name in drivetrain.sensors and not sensor.is_on_element
        kinematics = drivetrain.assembly.kinematics
        if on_nodes and set(sensor.nodes) <= set(drivetrain.nodes) and kinematics.holds_row(sensor.row):
            which = f'"{sensor.of}" is locked' if sensor.against is None else immobility_text(sensor)
            raise UsageError(f"{name} reads zero: {which} in this configuration", kind="zero-reading")
        return functional(drivetrain, sensor, name)
    known = [*drivetrain.sensors, *drivetrain.nodes]
    hint = did_you_mean(name, known)
    declared = ", ".join(drivetrain.sensors) or "none"
    others = "or write torque(element), twist(element), velocity(node)"
    raise UsageError(
        f'no sensor or node is named "{entry}"{hint}; sensors: {declared}; {others}', kind="unknown-channel"
    )


def usable_channels(drivetrain: AssembledModel) -> tuple[list[str], list[str]]:
    """Names of the inputs, and of the sensors, on parts that are present and not locked.

    >>> import torsionnet as tn
    >>> usable_channels(tn.load("dmf_rig"))
    (['T_M'], ['theta_1', 'T_T'])
    """
    nodes, holds_row = set(drivetrain.nodes), drivetrain.assembly.kinematics.holds_row

    def acts(channel: Input | Sensor) -> bool:
        if channel.is_on_element:
            return channel.of in drivetrain.elements
        return nodes.issuperset(channel.nodes) and not holds_row(channel.row)

    tables: tuple[Any, Any] = (drivetrain.inputs, drivetrain.sensors)
    inputs, sensors = ([name for name, channel in table.items() if acts(channel)] for table in tables)
    return inputs, sensors


def elements_beyond_cut(drivetrain: AssembledModel, request: TransferRequest) -> tuple[str, ...] | None:
    """Names of the elements left without the excited side when the drivetrain is cut at the measured torque.

    None if more than one torque is measured, the cut does not separate the drivetrain, or excitations act on both
    sides. The torque at a port flows between the element and its node there; elements join their other nodes, as does
    an imposed relative motion; ground does not.
    """
    sensor = request.inputs[0].sensor
    if sensor is None or sensor.quantity != "torque" or len(request.inputs) > 1:
        return None
    from torsionnet.model.readings import port_of

    node, _ = port_of(drivetrain.elements[sensor.of], sensor.at)
    ends = {name: {*part.ports.values(), *part.internal_nodes} - {GROUND} for name, part in drivetrain.elements.items()}
    # The cut lies between the element and its node at the port.
    ends[sensor.of].discard(node)
    parts = Groups(drivetrain.nodes)
    tied = [set(channel.nodes) for channel in drivetrain.inputs.values() if channel.quantity == "angle"]
    for tied_nodes in (*ends.values(), *(nodes for nodes in tied if nodes.issubset(drivetrain.nodes))):
        if tied_nodes:
            parts.join(*tied_nodes)
    sides = [set(parts.of(node)), {other for end in ends[sensor.of] for other in parts.of(end)}]
    is_driven = [any(not side.isdisjoint(channel.nodes) for channel in request.excitations) for side in sides]
    if sum(is_driven) != 1:
        return None
    at_node, with_element = sides
    if is_driven[1]:
        return tuple(name for name, own in ends.items() if not own.isdisjoint(at_node))
    return tuple(name for name, own in ends.items() if name == sensor.of or not own.isdisjoint(with_element))


def cut_definition(definition: Definition, kept: Sequence[str]) -> Definition:
    """Definition with only the elements ``kept``, and the inputs and sensors whose nodes and elements are left.

    Values that are quoted at another shaft are converted to their own before the way there is cut.
    """
    own = {element.name: element for element in definition.switched_on}
    elements: dict[str, Element] = {name: own.get(name, definition.elements[name]) for name in kept}
    nodes = set(all_nodes(elements.values()))
    inputs = {
        name: channel
        for name, channel in definition.inputs.items()
        if channel.quantity == "angle" and nodes.issuperset(channel.nodes)
    }
    sensors = {
        name: sensor
        for name, sensor in definition.sensors.items()
        if (sensor.of in elements if sensor.is_on_element else nodes.issuperset(sensor.nodes))
    }
    return replace(definition, elements=elements, inputs=inputs, sensors=sensors)

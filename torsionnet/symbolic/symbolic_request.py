"""From names to numerator and denominator: sensors, excitations, and the cut at a measured torque."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.assembly.functionals import Functional, port_of
from torsionnet.core.errors import UsageError
from torsionnet.core.memo import Memo
from torsionnet.model.channels import ELEMENT_QUANTITIES, Input, Sensor
from torsionnet.response import Channel
from torsionnet.solve.cut import Cut, cut_definition, find_cut
from torsionnet.solve.transfer_request import TransferRequest, as_sensor, ask
from torsionnet.symbolic.symbolic_sensors import Mechanism, SymbolicPart, loose_constraints, parts_of


@dataclass(frozen=True)
class SymbolicRequest:
    """A transfer function in terms of one mechanism.

    Attributes
    ----------
    mechanism : Mechanism
        The drivetrain, or what is left of it downstream of a cut.
    output, measured : list of SymbolicPart
        What is read; ``measured`` is None where the input is a torque on ``node``.
    node : str
        Where the torque acts.
    sign : int
        Of that torque, for a cut on whose far side a positive reading drives backwards.
    channels : tuple of Channel
        Output and input.
    notes : tuple of str
    change : callable
        What values do to expressions of parameters.
    """

    mechanism: Mechanism
    output: list[SymbolicPart]
    measured: list[SymbolicPart] | None
    node: str
    sign: int
    channels: tuple[Channel, Channel]
    notes: tuple[str, ...]
    change: Callable[[Any], Any] = lambda expression: expression

    def changed(self, change: Callable[[Any], Any]) -> SymbolicRequest:
        """With another change of all expressions on top."""
        before = self.change
        return replace(self, change=lambda expression: change(before(expression)))


def resolve(
    drivetrain: AssembledModel,
    output: str | Sensor,
    input: str | Sensor,
    excitation: str | None,
    referred_to: Sequence[str] = (),
    memo: Memo | None = None,
) -> SymbolicRequest:
    """Resolve the names; see :meth:`torsionnet.symbolic.symbolic_system.SymbolicSystem.transfer_function`.

    Raises
    ------
    UsageError
        As for a frequency response; also where the excitation does not reach the measured input.
    """
    request = ask(drivetrain, output, input, excitation)
    reading = as_sensor(drivetrain, output) or Sensor("angle", str(output))
    channels = (channel(request.outputs[0]), channel(request.measured[0]))
    if not request.is_measured:
        mechanism = _mechanism(drivetrain, [reading], referred_to, memo)
        node = request.excitations[0].of
        return SymbolicRequest(mechanism, parts_of(mechanism, reading), None, node, 1, channels, request.notes)
    sensor = as_sensor(drivetrain, input)
    if sensor is None:  # a measured input is a sensor
        raise TypeError
    mechanism = _mechanism(drivetrain, [reading, sensor], referred_to, memo)
    whole = _measured(reading, sensor, request, mechanism)
    _require_reached(whole, str(input), request.excitations[0])
    cut = find_cut(drivetrain, sensor, request.excitations)
    if cut is None or not _is_kept(drivetrain, cut, reading):
        return whole
    return _of_cut(drivetrain, cut, reading, sensor, whole, referred_to)


def channel(reading: Functional) -> Channel:
    """Name and unit of a reading."""
    return Channel(reading.name, reading.unit)


def _mechanism(
    drivetrain: AssembledModel,
    sensors: Sequence[Sensor],
    referred_to: Sequence[str],
    memo: Memo | None = None,
) -> Mechanism:
    """The mechanism in which the sensors can be read, from ``memo`` where it has been made before."""
    loose = loose_constraints(drivetrain, sensors)
    kept = tuple(node for node in referred_to if node in drivetrain.nodes)
    return (memo or Memo()).once(Mechanism, loose, lambda: Mechanism(drivetrain, kept, loose))


def _measured(output: Sensor, sensor: Sensor, request: TransferRequest, mechanism: Mechanism) -> SymbolicRequest:
    channels = (channel(request.outputs[0]), channel(request.measured[0]))
    parts, measured = parts_of(mechanism, output), parts_of(mechanism, sensor)
    return SymbolicRequest(mechanism, parts, measured, request.excitations[0].of, 1, channels, request.notes)


def _require_reached(asked: SymbolicRequest, name: str, excitation: Input) -> None:
    if asked.measured is not None and asked.mechanism.numerator(asked.measured, asked.node).is_zero:
        raise UsageError(f"{name} does not feel the {excitation}: the transfer function against it does not exist")


def _is_kept(drivetrain: AssembledModel, cut: Cut, reading: Sensor) -> bool:
    if reading.quantity in ELEMENT_QUANTITIES:
        return reading.of in cut.kept
    elements = [drivetrain.elements[name] for name in cut.kept]
    return any(reading.of in {*element.ports.values(), *element.internal_nodes} for element in elements)


def _of_cut(
    drivetrain: AssembledModel,
    cut: Cut,
    output: Sensor,
    sensor: Sensor,
    whole: SymbolicRequest,
    referred_to: Sequence[str],
) -> SymbolicRequest:
    """What is left downstream of the cut; the measured torque is an excitation there."""
    node, sign = port_of(drivetrain.elements[sensor.of], sensor.at)
    rest = drivetrain.with_definition(cut_definition(drivetrain.definition, cut.kept))
    mechanism = _mechanism(rest, [output], referred_to)
    removed = ", ".join(name for name in drivetrain.elements if name not in cut.kept)
    notes = (*whole.notes, f"cut at {whole.channels[1].name}: independent of {removed}") if removed else whole.notes
    into = sign if sensor.of in cut.kept else -sign
    return SymbolicRequest(mechanism, parts_of(mechanism, output), None, node, into, whole.channels, notes)

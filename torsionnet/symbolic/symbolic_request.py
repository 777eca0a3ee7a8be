"""Request for a symbolic transfer function, names resolved to sensors, excitations and a cut at a torque meter."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import UsageError
from torsionnet.core.memo import Memo
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.motion_balance.operating_notes import symbol_notes
from torsionnet.model.readings import port_of
from torsionnet.response import Channel
from torsionnet.solve.dynamic_stiffness.transfer_request import TransferRequest, resolve_request
from torsionnet.solve.modes.cut_drivetrain import cut_definition, elements_beyond_cut
from torsionnet.symbolic.algebra.program import Program
from torsionnet.symbolic.algebra.zero_tests import vanishes
from torsionnet.symbolic.symbolic_sensors import Mechanism, SymbolicPart, loose_constraints, parts_of


@dataclass(frozen=True)
class SymbolicRequest:
    """Request for a transfer function in terms of one symbolic drivetrain, with its readings and load.

    Attributes
    ----------
    mechanism : Mechanism
        The drivetrain, or what is left of it downstream of a cut.
    output, measured : list of SymbolicPart
        What is read; ``measured`` is None where the input is a torque.
    load : mapping
        Torques on nodes per unit of the excitation.
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
    load: Mapping[str, int]
    sign: int
    channels: tuple[Channel, Channel]
    notes: tuple[str, ...]
    change: Callable[[Any], Any] = lambda expression: expression

    def changed(self, change: Callable[[Any], Any]) -> SymbolicRequest:
        """Copy of the request with one more substitution applied to all expressions of parameters in it."""
        before = self.change
        return replace(self, change=lambda expression: change(before(expression)))


def resolve(
    drivetrain: AssembledModel,
    output: str | Sensor,
    input: str | Sensor | Input,
    excitation: str | Input | None,
    referred_to: Sequence[str] = (),
    memo: Memo | None = None,
) -> SymbolicRequest:
    """Request for a symbolic transfer function from the names of output, input and excitation.

    See :meth:`torsionnet.symbolic.symbolic_system.SymbolicSystem.transfer_function`.

    Raises
    ------
    UsageError
        As for a frequency response; also where the excitation does not reach the measured input.
    """
    request = resolve_request(drivetrain, output, input, excitation)
    sensors, load = request.sensors, request.excitations[0].row
    seen = _mechanism(drivetrain, sensors, referred_to, memo)
    reading, *measured = (parts_of(seen, sensor) for sensor in sensors)
    channels = (request.outputs[0].channel, request.measured[0].channel)
    notes = (*request.notes, *symbol_notes(drivetrain.definition))
    whole = SymbolicRequest(seen, reading, None, load, 1, channels, notes)
    if not measured:
        return whole
    if vanishes(seen.numerator(measured[0], load)):
        felt = f"{request.names} does not feel the {request.excitations[0]}"
        raise UsageError(f"{felt}: the transfer function against it does not exist; choose another excitation")
    whole = replace(whole, measured=measured[0])
    kept = elements_beyond_cut(drivetrain, request)
    return whole if kept is None else _of_cut(drivetrain, kept, request, whole, referred_to)


def _mechanism(
    drivetrain: AssembledModel,
    sensors: Sequence[Sensor],
    referred_to: Sequence[str],
    memo: Memo | None = None,
) -> Mechanism:
    """Symbolic drivetrain in which the sensors can be read, from ``memo`` where it was made before."""
    loose = loose_constraints(drivetrain, sensors)
    kept = tuple(node for node in referred_to if node in drivetrain.nodes)
    return (memo or Memo()).once(Mechanism, loose, lambda: mechanism(drivetrain, kept, loose))


def _of_cut(
    drivetrain: AssembledModel,
    kept: Sequence[str],
    request: TransferRequest,
    whole: SymbolicRequest,
    referred_to: Sequence[str],
) -> SymbolicRequest:
    """Request on the drivetrain downstream of a cut, where the measured torque is the excitation."""
    output, sensor = request.sensors
    if sensor.referred_to is not None:  # the torque at the cut is another one
        return whole
    node, sign = port_of(drivetrain.elements[sensor.of], sensor.at)
    rest = drivetrain.with_definition(cut_definition(drivetrain.definition, kept))
    if not (output.of in rest.elements if output.is_on_element else set(rest.nodes).issuperset(output.nodes)):
        return whole
    rested = _mechanism(rest, [output], referred_to)
    removed = ", ".join(name for name in drivetrain.elements if name not in kept)
    notes = (*whole.notes, f"cut at {whole.channels[1].name}: independent of {removed}") if removed else whole.notes
    into = sign if sensor.of in kept else -sign
    return SymbolicRequest(rested, parts_of(rested, output), None, {node: 1}, into, whole.channels, notes)


def mechanism(
    drivetrain: AssembledModel,
    referred_to: tuple[str, ...] = (),
    loose: tuple[int, ...] = (),
    program: Program | None = None,
) -> Mechanism:
    """Symbolic drivetrain from which transfer functions are made, an :class:`ActiveMechanism` if it has actions."""
    kind = Mechanism
    if drivetrain.assembly.system.actions:
        from torsionnet.symbolic.active_mechanism import ActiveMechanism

        kind = ActiveMechanism
    return kind(drivetrain, referred_to, loose, program or Program())

"""Symbolic transfer functions of drivetrains with imposed angles, by way of drivetrains without these.

What an imposed angle does to a reading is what any torque there does to it, over the angle that torque makes: y/phi is
a transfer function against a measured angle. Whatever hangs on the driven node alone drops out of the ratio. Imposed
angles that are not the excitation stand still.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import UsageError
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.elements import Element, Lock, RigidCoupling
from torsionnet.response import Channel
from torsionnet.solve.dynamic_stiffness.transfer_request import resolve_request


@dataclass(frozen=True)
class ImposedRequest:
    """Request for a transfer function restated without imposed angles, with drivetrain, input and excitation.

    ``channel`` is the input as the user knows it, where that is an imposed angle.
    """

    drivetrain: AssembledModel
    input: str | Sensor | Input
    excitation: str | Input | None
    channel: Channel | None = None


def is_imposed(drivetrain: AssembledModel) -> bool:
    """Whether any input of the drivetrain imposes an angle."""
    return any(channel.quantity == "angle" for channel in drivetrain.inputs.values())


def hold_imposed_angles(drivetrain: AssembledModel, driven: Input | None = None) -> AssembledModel:
    """Drivetrain with its imposed angles held at zero, except that of ``driven``, where the node turns freely."""
    definition, nodes = drivetrain.definition, set(drivetrain.nodes)
    imposed = [one for one in definition.inputs.values() if one.quantity == "angle" and nodes.issuperset(one.nodes)]
    held = [_holder(one, definition.elements) for one in imposed if one != driven]
    elements = {**definition.elements, **{holder.name: holder for holder in held}}
    inputs = {name: channel for name, channel in definition.inputs.items() if channel.quantity != "angle"}
    return drivetrain.with_definition(replace(definition, elements=elements, inputs=inputs))


def _holder(channel: Input, known: Mapping[str, Element]) -> Element:
    """Element that holds an imposed angle at zero, a clamp, or between two nodes a rigid coupling."""
    name = _unused(f"rest_{'_'.join(channel.nodes)}", known)
    if channel.against is None:
        return Lock(name, node=channel.of)
    return RigidCoupling(name, nodes=(channel.of, channel.against))


def _unused(name: str, elements: Mapping[str, Element]) -> str:
    while name in elements:
        name += "_"
    return name


def without_imposed_angles(
    drivetrain: AssembledModel, output: str | Sensor, input: str | Sensor | Input, excitation: str | Input | None
) -> ImposedRequest:
    """Request for a transfer function restated without imposed angles, as a measured angle under a torque.

    Raises
    ------
    UsageError
        As for a frequency response.
    """
    if not is_imposed(drivetrain):
        return ImposedRequest(drivetrain, input, excitation)
    request = resolve_request(drivetrain, output, input, excitation)
    source: Input = request.excitations[0]
    if source.quantity == "torque":
        return ImposedRequest(hold_imposed_angles(drivetrain), input, source if request.is_measured else None)
    free, torque = hold_imposed_angles(drivetrain, source), replace(source, quantity="torque")
    if request.is_measured:
        return ImposedRequest(free, input, torque)
    measured = Sensor("angle", source.of, against=source.against)
    return ImposedRequest(free, measured, torque, request.measured[0].channel)


def require_one_channel_each(output: object, input: object) -> None:
    """Raise an error if several outputs or inputs are given for a symbolic transfer function, which has one of each."""
    if not isinstance(output, str | Sensor) or not isinstance(input, str | Sensor | Input):
        raise UsageError("a transfer function in symbols has one output and one input; transfer_matrix takes several")

"""Imposed angles in symbols.

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
from torsionnet.model.elements import Element, Lock
from torsionnet.response import Channel
from torsionnet.solve.transfer_request import ask


@dataclass(frozen=True)
class ImposedRequest:
    """A request that imposes no angles: the drivetrain, input and excitation it is asked with.

    ``channel`` is the input as the user knows it, where that is an imposed angle.
    """

    drivetrain: AssembledModel
    input: str | Sensor
    excitation: str | None
    channel: Channel | None = None


def is_imposed(drivetrain: AssembledModel) -> bool:
    """Whether any input imposes an angle."""
    return any(channel.quantity == "angle" for channel in drivetrain.inputs.values())


def at_rest(drivetrain: AssembledModel, driven: str = "") -> AssembledModel:
    """The drivetrain with its imposed angles held at zero, but for the node ``driven``, which turns freely."""
    definition = drivetrain.definition
    imposed = [channel.of for channel in definition.inputs.values() if channel.quantity == "angle"]
    locks = [Lock(_unused(f"rest_{node}", definition.elements), node=node) for node in imposed if node != driven]
    nodes = set(drivetrain.nodes)
    elements = {**definition.elements, **{lock.name: lock for lock in locks if lock.node in nodes}}
    inputs = {name: channel for name, channel in definition.inputs.items() if channel.quantity != "angle"}
    return drivetrain.with_definition(replace(definition, elements=elements, inputs=inputs))


def _unused(name: str, elements: Mapping[str, Element]) -> str:
    while name in elements:
        name += "_"
    return name


def posed(
    drivetrain: AssembledModel, output: str | Sensor, input: str | Sensor, excitation: str | None
) -> ImposedRequest:
    """The request without imposed angles.

    Raises
    ------
    UsageError
        As for a frequency response.
    """
    if not is_imposed(drivetrain):
        return ImposedRequest(drivetrain, input, excitation)
    request = ask(drivetrain, output, input, excitation)
    source: Input = request.excitations[0]
    if source.quantity == "torque":
        return ImposedRequest(at_rest(drivetrain), input, source.of if request.is_measured else None)
    free = at_rest(drivetrain, source.of)
    if request.is_measured:
        return ImposedRequest(free, input, source.of)
    return ImposedRequest(free, Sensor("angle", source.of), source.of, request.measured[0].channel)


def single(output: object, input: object) -> None:
    """Refuse several outputs or inputs."""
    if not isinstance(output, str | Sensor) or not isinstance(input, str | Sensor):
        raise UsageError("a transfer function in symbols has one output and one input; transfer_matrix takes several")

"""Operating point of a call, from torques by place and a speed or speeds by node."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.model.definition import Definition
from torsionnet.model.load.external_torques import reference_node
from torsionnet.model.operating_point import OperatingPoint


def asked_point(
    definition: Definition, torque: Mapping[str, Any] | None, speed: Mapping[str, Any] | float | str | None
) -> OperatingPoint:
    """Operating point with torques by place and a speed of the reference node, or speeds by node.

    Raises
    ------
    UsageError
        Neither torques nor speeds, or a speed without a reference node.
    ModelError
        A value that is no torque or speed.
    """
    if not torque and speed is None:
        raise UsageError('give torques or speeds of the operating point, as at(torque={"crank": "200 N*m"})')
    if speed is not None and not isinstance(speed, Mapping):
        reference = reference_node(definition) or next(iter(definition.operating_point.speed), "")
        if not reference:
            raise UsageError(
                f"{speed} is the speed of no node in particular, as the model has neither speeds: nor load:; "
                "give it by node, as speed={node: value}"
            )
        speed = {reference: speed}
    found, faults = OperatingPoint.read({"torque": dict(torque or {}), "speed": dict(speed or {})})
    if faults or found is None:
        raise ModelError(faults or [Fault("no operating point")], "the operating point")
    return found
